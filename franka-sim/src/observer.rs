//! External joint torques from momentum.

use franka_model::{CYCLE, Dynamics, JointVector, MassMatrix};

/// A momentum observer (De Luca, Albu-Schäffer, Haddadin and Hirzinger, "Collision detection and
/// safe reaction with the DLR-III lightweight manipulator arm", IROS 2006, section III).
///
/// The generalised momentum `p = M dq` of the links obeys `dp/dt = τ + (dM/dt − C) dq − g + τ_ext`,
/// with `τ` the torques between gears and links, which the joint sensors read. The residual `r` is
/// computed without `τ_ext`. It follows `τ_ext` like a first-order low-pass: `dr/dt = gain (τ_ext −
/// r)`. No acceleration is measured or computed.
///
/// `M`, `C` and `g` include the *declared* load. Any other load on the flange, and the force to
/// accelerate it, count as external.
#[derive(Debug, Clone)]
pub(crate) struct MomentumObserver {
    residual: JointVector,
}

/// Motion and dynamics of the arm at one instant, the observer's input.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instant {
    /// Measured joint velocities, `[rad/s]`.
    pub(crate) dq: JointVector,
    /// Mass matrix with the declared load, `[kg·m²]`.
    pub(crate) mass: MassMatrix,
    /// Torques `C dq + g`, `[N·m]`.
    pub(crate) bias: JointVector,
}

impl Instant {
    pub(crate) fn new(dq: &JointVector, dynamics: &Dynamics) -> Self {
        Self {
            dq: *dq,
            mass: dynamics.mass,
            bias: dynamics.coriolis + dynamics.gravity,
        }
    }
}

impl MomentumObserver {
    /// Returns the observer of an arm that nothing touches.
    pub(crate) fn new() -> Self {
        Self {
            residual: JointVector::zeros(),
        }
    }

    /// Processes one millisecond: `before` and `after` are the arm at its beginning and at its end,
    /// `sensed` is the mean sensor torque, `[N·m]`. `gain` is in `[1/s]`.
    ///
    /// Backward Euler for the residual makes every gain stable; all other terms use the trapezoidal
    /// rule.
    pub(crate) fn update(
        &mut self,
        before: &Instant,
        after: &Instant,
        sensed: &JointVector,
        gain: f64,
    ) {
        let momentum = after.mass * after.dq - before.mass * before.dq;
        let turning = (after.mass - before.mass) * ((before.dq + after.dq) / 2.0);
        let explained = turning + (sensed - (before.bias + after.bias) / 2.0) * CYCLE;
        self.residual = (self.residual + (momentum - explained) * gain) / (1.0 + gain * CYCLE);
    }

    /// Torques of the environment on the joints, `[N·m]`.
    pub(crate) fn external_torque(&self) -> &JointVector {
        &self.residual
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::{EndEffector, GRAVITY_EARTH, Load, Model, READY};

    fn instant(q: &JointVector, dq: &JointVector) -> Instant {
        let frames = EndEffector::default();
        let dynamics = Model::fr3().dynamics(q, dq, &frames, &Load::NONE, &GRAVITY_EARTH);
        Instant::new(dq, &dynamics)
    }

    /// Observes an arm that is pushed while motors with rotors support and damp it.
    fn observe(push: &JointVector, gain: f64, milliseconds: usize) -> JointVector {
        let model = Model::fr3();
        let rotors = JointVector::repeat(0.1);
        let mut observer = MomentumObserver::new();
        let (mut q, mut dq) = (READY, JointVector::zeros());
        let mut before = instant(&q, &dq);
        for _ in 0..milliseconds {
            let motor = model.gravity(&q, &Load::NONE, &GRAVITY_EARTH) - dq * 5.0;
            let (load, earth) = (Load::NONE, GRAVITY_EARTH);
            let ddq = model
                .forward_dynamics(&q, &dq, &(motor + push), &load, &earth, &rotors)
                .expect("positive definite");
            // This is exact, because the acceleration is constant within the millisecond.
            q += (dq + ddq * (CYCLE / 2.0)) * CYCLE;
            dq += ddq * CYCLE;
            let after = instant(&q, &dq);
            let sensed = motor - rotors.component_mul(&ddq);
            observer.update(&before, &after, &sensed, gain);
            before = after;
        }
        *observer.external_torque()
    }

    #[test]
    fn the_residual_follows_like_a_low_pass_while_the_arm_gives_way() {
        let push = JointVector::from([2.0, -3.0, 1.0, 2.0, 0.4, 0.3, 0.01]);
        for gain in [30.0, 100.0] {
            let milliseconds = 20;
            let seen = observe(&push, gain, milliseconds);
            let share = 1.0 - (-gain * milliseconds as f64 * CYCLE).exp();
            assert!((seen - push * share).amax() < 0.06, "{gain}: {seen}");
        }
    }

    #[test]
    fn no_gain_is_too_high() {
        let push = JointVector::from([1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0]);
        let seen = observe(&push, 1e6, 50);
        assert!((seen - push).amax() < 0.1, "{seen}");
    }
}

//! The rigid-body arm.

use franka_model::{JointVector, Load, Model};

use super::{ArmParameters, Plant};

/// Rigid links of a [`Model`], with rotor inertia, friction and end stops.
///
/// Each step solves, for the acceleration `a`,
///
/// ```text
/// (M + armature + h·D + h²·K) a = motor + external − C dq − g − friction(dq) − stops(q + h·dq, dq)
/// ```
///
/// with `D` the slope of friction and stop damping and `K` the stops' stiffness, then advances
/// velocity before position. That is the implicit Euler rule for what is stiff (friction at rest,
/// end stops) and the symplectic one for the rest, so the step stays stable however stiff those
/// are, and a free arm keeps its energy (see the tests in `plant::energy`).
#[derive(Debug)]
pub struct RigidArm {
    model: &'static Model,
    parameters: ArmParameters,
    load: Load,
    q: JointVector,
    dq: JointVector,
    sensed: JointVector,
}

impl RigidArm {
    /// An arm at rest at `q`, `[rad]`, carrying `load`.
    pub fn new(
        model: &'static Model,
        parameters: ArmParameters,
        q: JointVector,
        load: Load,
    ) -> Self {
        let sensed = model.gravity(&q, &load, &parameters.gravity_earth);
        Self {
            model,
            parameters,
            load,
            q,
            dq: JointVector::zeros(),
            sensed,
        }
    }
}

impl Plant for RigidArm {
    fn q(&self) -> &JointVector {
        &self.q
    }

    fn dq(&self) -> &JointVector {
        &self.dq
    }

    fn sensed_torque(&self) -> &JointVector {
        &self.sensed
    }

    fn armature(&self) -> &JointVector {
        &self.parameters.armature
    }

    fn step(&mut self, motor: &JointVector, external: &JointVector, dt: f64) {
        let ArmParameters {
            armature,
            gravity_earth,
            ..
        } = &self.parameters;
        let resistance = self.parameters.resistance(&self.q, &self.dq, dt);
        let torque = motor + external - resistance.friction - resistance.stop;
        let slope = resistance.friction_slope + resistance.stop_slope;
        let ddq = self
            .model
            .forward_dynamics(
                &self.q,
                &self.dq,
                &torque,
                &self.load,
                gravity_earth,
                &(armature + slope * dt),
            )
            // No acceleration solves the equation. The robot notices non-finite values and stops.
            .unwrap_or_else(|| JointVector::repeat(f64::NAN));
        self.sensed = resistance.sensed(motor, armature, &ddq, dt);
        self.dq += ddq * dt;
        self.q += self.dq * dt;
    }

    fn place(&mut self, q: &JointVector) {
        self.q = *q;
        self.dq = JointVector::zeros();
        self.sensed = self
            .model
            .gravity(q, &self.load, &self.parameters.gravity_earth);
    }

    fn attach(&mut self, load: Load) {
        self.load = load;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::{EndStops, Friction};
    use franka_model::{GRAVITY_EARTH, READY};

    const STEP: f64 = 0.000_25;

    fn ideal(q: JointVector) -> RigidArm {
        let parameters = ArmParameters {
            friction: Friction::NONE,
            stops: EndStops::NONE,
            ..ArmParameters::fr3()
        };
        RigidArm::new(Model::fr3(), parameters, q, Load::NONE)
    }

    #[test]
    fn gravity_torque_holds_the_arm_still() {
        let mut arm = RigidArm::new(Model::fr3(), ArmParameters::fr3(), READY, Load::NONE);
        let none = JointVector::zeros();
        for _ in 0..4000 {
            let hold = arm.model.gravity(&arm.q, &Load::NONE, &GRAVITY_EARTH);
            arm.step(&hold, &none, STEP);
        }
        assert!((arm.q - READY).amax() < 1e-9);
    }

    #[test]
    fn the_sensors_read_what_accelerates_the_links() {
        let mut arm = ideal(READY);
        let motor = JointVector::from([5.0, -3.0, 2.0, 25.0, 0.5, 1.0, 0.1]);
        let before = arm.dq;
        let q = arm.q;
        arm.step(&motor, &JointVector::zeros(), STEP);
        let ddq = (arm.dq - before) / STEP;
        let links = arm
            .model
            .inverse_dynamics(&q, &before, &ddq, &Load::NONE, &GRAVITY_EARTH);
        assert!((arm.sensed - links).amax() < 1e-9);
    }

    #[test]
    fn an_end_stop_holds_the_strongest_joint_without_ringing() {
        let limits = Model::fr3().joint_limits();
        let mut arm = RigidArm::new(Model::fr3(), ArmParameters::fr3(), READY, Load::NONE);
        let mut push = JointVector::zeros();
        push[0] = 87.0;
        for _ in 0..20_000 {
            let hold = arm.model.gravity(&arm.q, &Load::NONE, &GRAVITY_EARTH);
            arm.step(&(hold + push), &JointVector::zeros(), STEP);
        }
        assert!(arm.q[0] > limits.hard_upper[0] && arm.q[0] < limits.hard_upper[0] + 0.08);
        assert!(arm.dq[0].abs() < 1e-3, "{}", arm.dq[0]);
    }

    #[test]
    fn the_light_last_joint_is_stable_under_a_strong_damper_held_for_a_millisecond() {
        let mut arm = RigidArm::new(Model::fr3(), ArmParameters::fr3(), READY, Load::NONE);
        let kick = JointVector::from([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 5.0]);
        arm.step(&kick, &JointVector::zeros(), 0.01);
        for _ in 0..200 {
            let mut torque = arm.model.gravity(&arm.q, &Load::NONE, &GRAVITY_EARTH);
            torque[6] -= 15.0 * arm.dq[6];
            for _ in 0..4 {
                arm.step(&torque, &JointVector::zeros(), STEP);
            }
        }
        assert!(arm.dq[6].abs() < 1e-3, "{}", arm.dq[6]);
    }
}

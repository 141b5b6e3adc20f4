//! Joint friction, as much of it as the control box leaves over.

use franka_model::{JointVector, joint_vector};

/// Smooth Coulomb and viscous friction, compensated for the most part.
///
/// The torque of joint `i` at velocity `v` is
/// `(1 − compensated) · (coulomb_i · tanh(v / smoothing) + viscous_i · v)`.
///
/// The robot compensates friction inside its joint torque loops, which run faster than the 1 kHz
/// interface, so motor and compensation meet here as one remainder. The remainder matters: with
/// all of the Coulomb friction a client's impedance of 750 N/m would stop up to
/// 1.137 N·m / (0.3 m · 750 N/m) = 5 mm short. `tanh` has no stiction, so what is left acts like a
/// damper of `coulomb · (1 − compensated) / smoothing` at low speed: the arm still creeps to its
/// target, at that impedance within about half a second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Coulomb friction, `[N·m]`.
    pub coulomb: JointVector,
    /// Viscous friction, `[N·m·s/rad]`.
    pub viscous: JointVector,
    /// Velocity at which Coulomb friction has reached 76 % of its value, `[rad/s]`.
    pub smoothing: f64,
    /// Fraction that the control box compensates, 0 to 1.
    pub compensated: f64,
}

impl Friction {
    /// None at all.
    pub const NONE: Self = Self {
        coulomb: joint_vector([0.0; 7]),
        viscous: joint_vector([0.0; 7]),
        smoothing: 1.0,
        compensated: 0.0,
    };

    /// The arm of the Franka Research 3.
    ///
    /// Coulomb and viscous values: `mujoco_menagerie`, `franka_fr3`. Smoothing and compensation are
    /// choices of this simulator.
    pub const FR3: Self = Self {
        coulomb: joint_vector([1.137, 1.137, 1.137, 1.137, 0.763, 0.44, 0.248]),
        viscous: joint_vector([0.21; 7]),
        smoothing: 0.02,
        compensated: 0.95,
    };

    /// The arm of the Franka Emika Robot.
    ///
    /// Viscous values: `mujoco_menagerie`, `franka_emika_panda`, which has no Coulomb friction;
    /// those are taken to be the [`FR3`](Self::FR3)'s, an arm of the same build. Smoothing and
    /// compensation are choices of this simulator.
    pub const FER: Self = Self {
        viscous: joint_vector([1.0; 7]),
        ..Self::FR3
    };

    /// Torque at joint velocities `dq`, and its derivative by velocity; both oppose motion, so
    /// subtract them.
    pub(super) fn at(&self, dq: &JointVector) -> (JointVector, JointVector) {
        let rest = 1.0 - self.compensated;
        let mut torque = JointVector::zeros();
        let mut slope = JointVector::zeros();
        for i in 0..7 {
            let shape = (dq[i] / self.smoothing).tanh();
            torque[i] = rest * (self.coulomb[i] * shape + self.viscous[i] * dq[i]);
            slope[i] =
                rest * (self.coulomb[i] * (1.0 - shape * shape) / self.smoothing + self.viscous[i]);
        }
        (torque, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_opposes_motion_and_its_slope_is_the_derivative() {
        let step = 1e-6;
        for v in [-1.0, -0.03, 0.0, 0.01, 0.5] {
            let dq = JointVector::repeat(v);
            let (torque, slope) = Friction::FR3.at(&dq);
            assert!(torque[0] * v >= 0.0);
            let (above, _) = Friction::FR3.at(&dq.add_scalar(step));
            let (below, _) = Friction::FR3.at(&dq.add_scalar(-step));
            let numeric = (above - below) / (2.0 * step);
            assert!((numeric - slope).amax() < 1e-6, "{v}");
        }
    }

    #[test]
    fn most_of_the_friction_is_compensated() {
        let (torque, _) = Friction::FR3.at(&JointVector::repeat(1.0));
        assert!(torque[0] > 0.05 && torque[0] < 0.08, "{}", torque[0]);
    }
}

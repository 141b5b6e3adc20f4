//! The hybrid impedance law: springs and dampers at the end effector and at the joints, summed in joint space.
//!
//! ```text
//! tau = Kp (q_ref - q) + Kd (g dq_ref - dq) + coriolis
//! Kp  = J' Kx J + Kq        Kd = J' Kxd J + Kqd
//! ```
//!
//! With the reference in joint space the spring at the end effector needs no pose error of its own: `J (q_ref - q)` is
//! that error to first order, and the leash keeps it small. Gravity and friction are compensated by the robot.

use franka_model::{Dynamics, Jacobian, JointVector};

use crate::law::{Gains, shaping};

/// Weight of the reference velocity in the damper, `g` above. At 1 the damper opposes only the velocity error, so the
/// arm does not lag behind a moving reference by its damping.
pub const VELOCITY_FEEDFORWARD: f64 = 1.0;

/// Where the law wants the joints to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Positions, `[rad]`.
    pub q: JointVector,
    /// Velocities, `[rad/s]`.
    pub dq: JointVector,
    /// Accelerations, `[rad/s^2]`. The law does not use them; the next generator starts from them.
    pub ddq: JointVector,
}

impl Reference {
    /// At rest at `q`.
    pub fn at_rest(q: JointVector) -> Self {
        Self {
            q,
            dq: JointVector::zeros(),
            ddq: JointVector::zeros(),
        }
    }
}

/// Spring and damper torques of the law, `[N m]`; `dynamics` is taken at the measured `q` and `dq`.
pub fn spring_and_damper(
    gains: &Gains,
    reference: &Reference,
    q: &JointVector,
    dq: &JointVector,
    jacobian: &Jacobian,
) -> JointVector {
    let position_error = reference.q - q;
    let velocity_error = reference.dq * VELOCITY_FEEDFORWARD - dq;
    let mut wrench = jacobian * position_error;
    let damping = jacobian * velocity_error;
    for axis in 0..6 {
        wrench[axis] = gains.cartesian_stiffness[axis] * wrench[axis]
            + gains.cartesian_damping[axis] * damping[axis];
    }
    let mut tau = jacobian.tr_mul(&wrench);
    for joint in 0..7 {
        tau[joint] += gains.joint_stiffness[joint] * position_error[joint]
            + gains.joint_damping[joint] * velocity_error[joint];
    }
    tau
}

/// The whole law before shaping, `[N m]`: the clamped spring and damper plus the Coriolis torques of the model.
///
/// Returns whether the clamp bound. Coriolis torques stay outside the clamp: they belong to the motion, not to the
/// interaction.
pub fn torques(
    gains: &Gains,
    reference: &Reference,
    q: &JointVector,
    dq: &JointVector,
    dynamics: &Dynamics,
) -> (JointVector, bool) {
    let interaction = spring_and_damper(gains, reference, q, dq, &dynamics.jacobian);
    let (clamped, bound) = shaping::clamp(&interaction, &shaping::TORQUE_CLAMP.into());
    (clamped + dynamics.coriolis, bound)
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::{EndEffector, Frame, GRAVITY_EARTH, Load, Model, READY};

    /// The stated matrices, formed in full: the oracle for the two-sided product above.
    #[test]
    fn equals_the_stiffness_and_damping_matrices_of_the_definition() {
        let model = Model::fr3();
        let q = READY;
        let dq = JointVector::from_fn(|i, _| 0.1 * i as f64 - 0.3);
        let reference = Reference {
            q: q + JointVector::from_fn(|i, _| 0.01 * (i as f64 - 2.0)),
            dq: JointVector::from_fn(|i, _| 0.05 * i as f64),
            ddq: JointVector::zeros(),
        };
        let ee = EndEffector::default();
        let jacobian = model.zero_jacobian(Frame::EndEffector, &q, &ee);
        for gains in [Gains::cartesian(), Gains::joint()] {
            let kx = nalgebra::Matrix6::from_diagonal(&gains.cartesian_stiffness.into());
            let kxd = nalgebra::Matrix6::from_diagonal(&gains.cartesian_damping.into());
            let kq = nalgebra::SMatrix::<f64, 7, 7>::from_diagonal(&gains.joint_stiffness.into());
            let kqd = nalgebra::SMatrix::<f64, 7, 7>::from_diagonal(&gains.joint_damping.into());
            let kp = jacobian.transpose() * kx * jacobian + kq;
            let kd = jacobian.transpose() * kxd * jacobian + kqd;
            let expected = kp * (reference.q - q) + kd * (reference.dq - dq);
            let got = spring_and_damper(&gains, &reference, &q, &dq, &jacobian);
            assert!((got - expected).amax() < 1e-11, "{got} {expected}");
        }
    }

    #[test]
    fn is_silent_at_rest_on_the_reference() {
        let q = READY;
        let dynamics = Model::fr3().dynamics(
            &q,
            &JointVector::zeros(),
            &EndEffector::default(),
            &Load::NONE,
            &GRAVITY_EARTH,
        );
        let (tau, bound) = torques(
            &Gains::cartesian(),
            &Reference::at_rest(q),
            &q,
            &JointVector::zeros(),
            &dynamics,
        );
        assert_eq!(tau, JointVector::zeros());
        assert!(!bound);
    }
}

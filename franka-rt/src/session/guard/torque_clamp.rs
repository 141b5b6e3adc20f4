//! The torque clamp: no joint is driven with more torque than it may have.

use franka_model::JointVector;

/// Bounds each torque by `most`, `[N m]`, and returns whether that changed any.
pub(crate) fn clamp(tau: &JointVector, most: &JointVector) -> (JointVector, bool) {
    let clamped = tau.zip_map(most, |tau, most| tau.clamp(-most, most));
    (clamped, clamped != *tau)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Gains;
    use franka_model::Model;

    #[test]
    fn the_greatest_limits_are_within_what_the_joints_can_give() {
        for model in [Model::fr3(), Model::fer()] {
            let robot = model.joint_limits().torque;
            let most = JointVector::from(Gains::TORQUE_LIMITS);
            assert!((robot - most).min() > 0.0, "{robot}");
        }
    }

    #[test]
    fn clamps_each_joint_by_its_own_bound() {
        let (tau, bound) = clamp(&JointVector::repeat(50.0), &Gains::TORQUE_LIMITS.into());
        assert!(bound);
        assert_eq!(tau[0], 50.0);
        assert_eq!(tau[6], 11.5);
        assert!(!clamp(&JointVector::repeat(-11.5), &Gains::TORQUE_LIMITS.into()).1);
    }
}

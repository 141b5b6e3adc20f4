//! The torque clamp: no joint is driven with more torque than it can give.

use franka_model::JointVector;

/// Bound of the spring and damper torques per joint, `[N m]`: just inside the 87 and 12 N m that
/// the joints can give.
pub const TORQUE_CLAMP: [f64; 7] = [86.0, 86.0, 86.0, 86.0, 11.5, 11.5, 11.5];

/// Bounds each torque by `most`, `[N m]`, and returns whether that changed any.
pub(crate) fn clamp(tau: &JointVector, most: &JointVector) -> (JointVector, bool) {
    let clamped = tau.zip_map(most, |tau, most| tau.clamp(-most, most));
    (clamped, clamped != *tau)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clamps_each_joint_by_its_own_bound() {
        let (tau, bound) = clamp(&JointVector::repeat(50.0), &TORQUE_CLAMP.into());
        assert!(bound);
        assert_eq!(tau[0], 50.0);
        assert_eq!(tau[6], 11.5);
        assert!(!clamp(&JointVector::repeat(-11.5), &TORQUE_CLAMP.into()).1);
    }
}

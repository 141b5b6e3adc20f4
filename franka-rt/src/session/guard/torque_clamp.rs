//! The torque clamp: bounds the torque of each joint.

use franka_model::JointVector;

/// Bounds each torque by `most`, `[N m]`. Also returns true if any torque changed.
pub(crate) fn clamp(tau: &JointVector, most: &JointVector) -> (JointVector, bool) {
    let clamped = tau.zip_map(most, |tau, most| tau.clamp(-most, most));
    (clamped, clamped != *tau)
}

/// A joint at rest whose torque is at its limit, although its springs and its compensation demand
/// more.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LimitedTorque {
    /// Number of the joint, from 1.
    pub joint: usize,
    /// Limit of the joint in [`Gains::torque_limits`](crate::law::Gains::torque_limits), `[N m]`.
    pub limit: f64,
    /// Torque that the joint would have without the limit, `[N m]`.
    pub asked: f64,
}

impl LimitedTorque {
    /// Returns the joint whose limit in `most` is the smallest share of its torque in `asked`,
    /// `[N m]`. Returns `None` if no torque is limited.
    pub(crate) fn worst(asked: &JointVector, most: &JointVector) -> Option<Self> {
        let shares = asked.abs().component_div(most);
        let (joint, share) = shares.argmax();
        (share > 1.0).then(|| Self {
            joint: joint + 1,
            limit: most[joint],
            asked: asked[joint].abs(),
        })
    }
}

impl core::fmt::Display for LimitedTorque {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self {
            joint,
            limit,
            asked,
        } = self;
        write!(
            f,
            "the torque limit of joint {joint} is {limit:.1} N m, but its springs and \
             compensation need {asked:.1} N m: raise the limit"
        )
    }
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
    fn the_worst_limit_is_that_with_the_smallest_share() {
        let most = JointVector::from(Gains::TORQUE_LIMITS);
        let mut asked = most;
        assert_eq!(LimitedTorque::worst(&asked, &most), None);
        (asked[1], asked[5]) = (100.0, -23.0);
        let worst = LimitedTorque {
            joint: 6,
            limit: 11.5,
            asked: 23.0,
        };
        assert_eq!(LimitedTorque::worst(&asked, &most), Some(worst));
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

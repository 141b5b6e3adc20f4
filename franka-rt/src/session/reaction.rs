//! Reactions of a motion to a condition, and their reports.

use core::time::Duration;

use franka_model::Model;
use franka_proto::RobotState;
use nalgebra::Isometry3;

use crate::session::condition::{Condition, ConditionError};
use crate::session::{Budget, GoalError, Target, check};

/// A condition, and the target that the motion turns to when the condition becomes true. The target
/// is rest by default; [`Condition::then`] sets a different one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction {
    /// Condition. It is checked in every cycle until the goal has ended.
    pub condition: Condition,
    /// Target after the condition has become true: [`Target::Rest`], joint positions or a pose.
    pub then: Target,
}

/// Measurements of a motion when its condition became true.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Reacted {
    /// Time from the first state of the goal to the state in which the condition became true, by
    /// the robot's clock.
    pub after: Duration,
    /// `message_id` of the state in which the condition became true, `[ms]` of the robot's clock.
    pub time: u64,
    /// External wrench in that state, in base axes, with its torque about the origin of the
    /// stiffness frame, `[N, N m]`. A positive value means that the arm exerts the wrench on its
    /// surroundings.
    pub wrench: [f64; 6],
    /// Pose of the end effector in that state, in the base frame, computed from the measured
    /// joints.
    pub pose: Isometry3<f64>,
}

impl From<Condition> for Reaction {
    /// Creates a reaction that stops the arm.
    fn from(condition: Condition) -> Self {
        Self {
            condition,
            then: Target::Rest,
        }
    }
}

impl Condition {
    /// Makes the motion continue to `target`, a pose or joint positions, when the condition becomes
    /// true. The arm brakes as quickly as for a plain condition and then moves to the target. It
    /// does not wait for the program.
    ///
    /// The speed stays the speed of the motion. Acceleration and jerk are at least as high as in
    /// the default budget, so that the arm retreats quickly even after a slow approach.
    pub fn then(self, target: impl Into<Target>) -> Reaction {
        Reaction {
            condition: self,
            then: target.into(),
        }
    }
}

impl Reaction {
    pub(super) fn check(&self, model: &Model, state: &RobotState) -> Result<(), GoalError> {
        self.condition.check()?;
        if let Target::Guide(_) = self.then {
            return Err(ConditionError::Guided.into());
        }
        if self.then.moves() {
            return Err(GoalError::Moves);
        }
        check::target(&self.then, model, state)
    }
}

impl Budget {
    /// Returns the budget with accelerations and jerks at least as high as in `other`.
    pub(super) fn as_brisk_as(&self, other: &Self) -> Self {
        let brisk =
            |own: franka_otg::AxisLimits, other: &franka_otg::AxisLimits| franka_otg::AxisLimits {
                velocity: own.velocity,
                acceleration: own.acceleration.max(other.acceleration),
                jerk: own.jerk.max(other.jerk),
            };
        Self {
            joints: core::array::from_fn(|i| brisk(self.joints[i], &other.joints[i])),
            translation: brisk(self.translation, &other.translation),
            rotation: brisk(self.rotation, &other.rotation),
        }
    }
}

#[cfg(test)]
mod tests {
    use franka_model::Model;

    use super::*;

    #[test]
    fn a_slow_budget_is_as_brisk_as_another_one_and_no_faster() {
        let default = Budget::of(Model::fr3().joint_limits());
        let (slow, hasty) = (default.scaled(0.1), default.scaled(1.5));
        let axes = |budget: &Budget| {
            let Budget {
                joints,
                translation,
                rotation,
            } = budget;
            let mut axes = joints.to_vec();
            axes.extend([*translation, *rotation]);
            axes
        };
        let [slow_axes, default_axes] = [slow, default].map(|budget| axes(&budget));
        let brisk = axes(&slow.as_brisk_as(&default));
        for ((brisk, slow), default) in brisk.iter().zip(&slow_axes).zip(&default_axes) {
            assert_eq!(brisk.velocity, slow.velocity);
            assert_eq!(brisk.acceleration, default.acceleration);
            assert_eq!(brisk.jerk, default.jerk);
        }
        assert_eq!(hasty.as_brisk_as(&default), hasty);
    }
}

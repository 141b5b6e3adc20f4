//! Aim of a course: the present target and limits of the reference.

use franka_otg::AxisLimits;

use super::{Budget, GoalId, Leash, Target};

/// Present target and limits of the reference. A goal has more fields, but only the aim is copied
/// in each cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    pub(super) goal: GoalId,
    pub(super) target: Target,
    pub(super) budget: Budget,
    /// True if the reference must stop on the way.
    pub(super) paused: bool,
    /// The leash of hand guiding in this cycle: how far the reference may be from the arm.
    pub(super) leash: Leash,
}

impl Aim {
    /// Returns the aim with its velocity limits scaled by `share`. The joints' limits are scaled
    /// only for a joint target.
    pub(super) fn slowed(&self, share: f64) -> Self {
        let slow = |limits: AxisLimits| AxisLimits {
            velocity: limits.velocity * share,
            ..limits
        };
        let Budget {
            joints,
            translation,
            rotation,
        } = self.budget;
        let joints = match self.target {
            Target::Joints(_) | Target::MovingJoints { .. } => joints.map(slow),
            _ => joints,
        };
        Self {
            budget: Budget {
                joints,
                translation: slow(translation),
                rotation: slow(rotation),
            },
            ..*self
        }
    }
}

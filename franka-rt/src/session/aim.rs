//! What a course is planned to.

use franka_otg::AxisLimits;

use super::{Budget, GoalId, Leash, Target};

/// What the reference heads for now, and how. A goal has more; this is copied in each cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    /// The goal that it belongs to.
    pub(super) goal: GoalId,
    pub(super) target: Target,
    pub(super) budget: Budget,
    /// True to stop on the way.
    pub(super) paused: bool,
    /// The leash of hand guiding, in this cycle.
    pub(super) leash: Leash,
}

impl Aim {
    /// Returns the aim with its velocities scaled by `share`; those of the joints only for a joint
    /// target.
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

//! Aim of a course: the present target and limits of the reference.

use franka_otg::AxisLimits;

use super::{Budget, GoalId, Leash, Target};

/// Present aim of the reference: its target and limits. A goal has more fields; only the aim is
/// copied in each cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    /// Goal of the aim.
    pub(super) goal: GoalId,
    pub(super) target: Target,
    pub(super) budget: Budget,
    /// True to stop on the way.
    pub(super) paused: bool,
    /// The leash of hand guiding in this cycle: how far the reference may be from the arm.
    pub(super) leash: Leash,
}

impl Aim {
    /// Returns the aim with its velocities scaled by `share`; the joints' velocities only for a
    /// joint target.
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

//! What was done to a robot from outside, and which errors it owes to that.

use franka_proto::{Errors, RobotError};
use franka_rt::lifecycle::ControlError;

/// Cycles without a command in a row after which a robot gives up, less two that the ends of a gap
/// may add.
const GAP: u64 = 18;

/// Two gaps closer than this, `[ms]`, count as one.
const APART: u64 = 80;

/// Everything from outside since the motion began.
#[derive(Debug, Default)]
pub(super) struct Causes {
    owed: Errors,
    /// When datagrams were last lost, and how many since there was a pause.
    gap: Option<(u64, u64)>,
    /// Somebody has pushed the arm.
    pub(super) pushed: bool,
    /// Somebody has pressed the user stop.
    pub(super) stopped: bool,
}

impl Causes {
    /// So many datagrams in a row are lost from `now` on, one way or the other.
    pub(super) fn lose(&mut self, now: u64, count: u64) {
        let before = match self.gap {
            Some((then, lost)) if now < then + lost + APART => lost,
            _ => 0,
        };
        let lost = before + count;
        self.gap = Some((now, lost));
        if lost >= GAP {
            self.owed
                .insert(RobotError::CommunicationConstraintsViolation);
        }
    }

    /// Somebody pushes the arm.
    pub(super) fn push(&mut self) {
        self.pushed = true;
        for error in [
            RobotError::JointReflex,
            RobotError::CartesianReflex,
            // The arm is measured to go that fast, whatever is commanded.
            RobotError::JointVelocityViolation,
            RobotError::CartesianVelocityViolation,
            // It may be pushed into itself.
            RobotError::SelfCollisionAvoidanceViolation,
        ] {
            self.owed.insert(error);
        }
    }

    /// The robot is made to believe in an error.
    pub(super) fn trip(&mut self, error: RobotError) {
        self.owed.insert(error);
    }

    /// Whether anybody pushed the arm.
    pub(super) fn pushed(&self) -> bool {
        self.pushed
    }

    /// Whether anything was done that may end a motion.
    pub(super) fn any(&self) -> bool {
        self.stopped || !self.owed.is_empty()
    }

    /// Whether a robot that ended a motion with this error owes it to one of them.
    pub(super) fn excuse(&self, error: &ControlError) -> bool {
        if !error.is_reflex() {
            return self.any();
        }
        let reasons = error.failure.reflex_reason;
        !reasons.is_empty() && reasons.iter().all(|reason| self.owed.contains(reason))
    }
}

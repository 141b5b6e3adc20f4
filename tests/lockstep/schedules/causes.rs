//! Disturbances of a robot from outside, and the errors that they can cause.

use franka_proto::{Errors, RobotError};
use franka_rt::lifecycle::ControlError;

/// Consecutive cycles without a command after which a robot stops, less two that the ends of a gap
/// may add.
const GAP: u64 = 18;

/// Two gaps closer than this, `[ms]`, count as one.
const APART: u64 = 80;

/// All disturbances since the motion began.
#[derive(Debug, Default)]
pub(super) struct Causes {
    possible: Errors,
    /// Time of the last lost datagrams, and the number lost since the last pause.
    gap: Option<(u64, u64)>,
    /// The arm was pushed.
    pub(super) pushed: bool,
    /// The user stop was pressed.
    pub(super) stopped: bool,
}

impl Causes {
    /// Records that `count` consecutive datagrams are lost from `now` on, in either direction.
    pub(super) fn lose(&mut self, now: u64, count: u64) {
        let before = match self.gap {
            Some((then, lost)) if now < then + lost + APART => lost,
            _ => 0,
        };
        let lost = before + count;
        self.gap = Some((now, lost));
        if lost >= GAP {
            self.possible
                .insert(RobotError::CommunicationConstraintsViolation);
        }
    }

    /// Records a push.
    pub(super) fn push(&mut self) {
        self.pushed = true;
        for error in [
            RobotError::JointReflex,
            RobotError::CartesianReflex,
            // A push alone can move the arm that fast.
            RobotError::JointVelocityViolation,
            RobotError::CartesianVelocityViolation,
            // The arm may be pushed into itself.
            RobotError::SelfCollisionAvoidanceViolation,
        ] {
            self.possible.insert(error);
        }
    }

    /// Records that the test injected this error.
    pub(super) fn trip(&mut self, error: RobotError) {
        self.possible.insert(error);
    }

    /// True if the arm was pushed.
    pub(super) fn pushed(&self) -> bool {
        self.pushed
    }

    /// True if any disturbance may end a motion.
    pub(super) fn any(&self) -> bool {
        self.stopped || !self.possible.is_empty()
    }

    /// True if these disturbances explain the error with which the robot ended a motion.
    pub(super) fn explains(&self, error: &ControlError) -> bool {
        if !error.is_reflex() {
            return self.any();
        }
        let reasons = error.failure.reflex_reason;
        !reasons.is_empty() && reasons.iter().all(|reason| self.possible.contains(reason))
    }
}

//! Recovery from a reflex: the automatic one, and the manual one of Desk.

use franka_model::JointVector;
use franka_proto::{CommandId, Errors, RecoveryStatus, Reply, RobotMode};

use super::{Activity, Robot};
use crate::generator::PointToPoint;

/// A recovery under way.
#[derive(Debug, Clone)]
pub(super) struct Recovery {
    /// The request to answer, if its client is still connected.
    id: Option<CommandId>,
    since: u64,
    /// Back into the range, if a person asks for it.
    way: Option<PointToPoint>,
}

impl Recovery {
    /// Goes on although the client has gone.
    pub(super) fn forget_client(&mut self) {
        self.id = None;
    }

    /// The way back that it takes.
    pub(super) fn way(&mut self) -> Option<&mut PointToPoint> {
        self.way.as_mut()
    }
}

impl Robot {
    /// Answers an `AutomaticErrorRecovery`, now or when it is over.
    pub(super) fn request_recovery(&mut self, id: CommandId) {
        let status = match self.robot_mode() {
            _ if self.lock.safety_function => self.kind.safety.recovery,
            RobotMode::Idle => RecoveryStatus::Success,
            RobotMode::Reflex if self.is_outside() => {
                RecoveryStatus::ManualErrorRecoveryRequiredRejected
            }
            RobotMode::Reflex => {
                self.recovery = Some(Recovery {
                    id: Some(id),
                    since: self.clock,
                    way: None,
                });
                return;
            }
            _ => RecoveryStatus::CommandNotPossibleRejected,
        };
        self.reply(id, Reply::Recovery(status));
    }

    /// True if a joint is further out than the robot brings it back by itself.
    pub(super) fn is_outside(&self) -> bool {
        let limits = self.model.joint_limits();
        let q = self.measurement.q;
        (0..7).any(|i| {
            q[i] < limits.hard_lower[i] - POSITION_MARGIN
                || q[i] > limits.hard_upper[i] + POSITION_MARGIN
        })
    }

    /// Performs the recovery that needs a person, as Desk offers it: joints outside their range are
    /// brought back into it, slowly, then errors are cleared. With no joint outside it does what
    /// the automatic one does; without an error, before the arm has come to rest, and while the
    /// robot is locked, nothing.
    pub fn recover_manually(&mut self) {
        let at_rest = matches!(self.activity, Activity::Holding);
        if self.robot_mode() != RobotMode::Reflex || !at_rest {
            return;
        }
        let limits = self.model.joint_limits();
        let q = self.measurement.q;
        let mut inside = self.desired.joints.q;
        for i in 0..7 {
            if q[i] < limits.hard_lower[i] {
                inside[i] = limits.hard_lower[i] + INSIDE;
            } else if q[i] > limits.hard_upper[i] {
                inside[i] = limits.hard_upper[i] - INSIDE;
            }
        }
        let mut way = PointToPoint::new(&JointVector::repeat(RETURN_VELOCITY), limits);
        way.go_to(&inside, &self.desired.joints);
        self.recovery = Some(Recovery {
            id: None,
            since: self.clock,
            way: Some(way),
        });
    }

    /// Clears the errors when the arm is at rest and, if need be, back in its range.
    pub(super) fn end_recovery(&mut self) {
        let Some(recovery) = &self.recovery else {
            return;
        };
        let elapsed = self.clock - recovery.since;
        let still = self.measurement.dq.amax() < STILL || elapsed >= RECOVERY_MAX;
        let back = recovery.way.as_ref().is_none_or(PointToPoint::is_over);
        if elapsed < RECOVERY_MIN || !still || !back {
            return;
        }
        let id = recovery.id;
        self.recovery = None;
        self.errors = Errors::NONE;
        self.estimate.clear();
        if let Some(id) = id {
            self.reply(id, Reply::Recovery(RecoveryStatus::Success));
        }
    }

    /// Ends a recovery that cannot go on.
    pub(super) fn abort_recovery(&mut self, status: RecoveryStatus) {
        if let Some(Recovery { id: Some(id), .. }) = self.recovery.take() {
            self.reply(id, Reply::Recovery(status));
        }
    }
}

// Choices of this simulator.

/// How far measured positions may be outside the range, `[rad]`.
const POSITION_MARGIN: f64 = 0.01;

/// How far inside its range a joint is brought back, `[rad]`.
const INSIDE: f64 = 0.02;

/// How fast, `[rad/s]`.
const RETURN_VELOCITY: f64 = 0.2;

/// Joint velocity below which the arm is still, `[rad/s]`.
const STILL: f64 = 0.01;

/// A recovery takes at least so many cycles, so that its mode is seen.
const RECOVERY_MIN: u64 = 100;

/// And at most so many more than the brake takes: something may shake the arm forever.
const RECOVERY_MAX: u64 = 2000;

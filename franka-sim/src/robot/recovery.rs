//! Recovery from a reflex: the automatic recovery, and Desk's manual recovery.

use franka_model::JointVector;
use franka_proto::{CommandId, Errors, RecoveryStatus, Reply, RobotMode};

use super::{Activity, Robot};
use crate::generator::PointToPoint;

#[derive(Debug, Clone)]
pub(super) struct Recovery {
    /// Id of the request to answer, if its client is still connected.
    id: Option<CommandId>,
    since: u64,
    /// Motion of the joints back into their range, if a person requested the recovery.
    way: Option<PointToPoint>,
}

impl Recovery {
    /// Continues the recovery after its client has disconnected.
    pub(super) fn forget_client(&mut self) {
        self.id = None;
    }

    /// The motion back into the range.
    pub(super) fn way(&mut self) -> Option<&mut PointToPoint> {
        self.way.as_mut()
    }
}

impl Robot {
    /// Begins an automatic recovery, or answers the request at once if no recovery is needed or
    /// possible.
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

    /// True if a joint is too far outside its range for the automatic recovery.
    pub(super) fn is_outside(&self) -> bool {
        let limits = self.model.joint_limits();
        let q = self.measurement.q;
        (0..7).any(|i| {
            q[i] < limits.hard_lower[i] - POSITION_MARGIN
                || q[i] > limits.hard_upper[i] + POSITION_MARGIN
        })
    }

    /// Performs the recovery that a person starts in Desk. Joints outside their range move slowly
    /// back into it, and then the robot clears its errors. If no joint is outside its range, this
    /// function acts like the automatic recovery. It has no effect if the robot has no error, is
    /// locked, or still moves.
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

    /// Clears the errors once the arm is at rest and any motion back into the range is over.
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

    /// Ends a recovery that cannot continue.
    pub(super) fn abort_recovery(&mut self, status: RecoveryStatus) {
        if let Some(Recovery { id: Some(id), .. }) = self.recovery.take() {
            self.reply(id, Reply::Recovery(status));
        }
    }
}

// These constants are choices of the simulator.

/// Distance outside its range up to which a joint does not count as outside, `[rad]`.
const POSITION_MARGIN: f64 = 0.01;

/// Distance inside its range at which a returning joint stops, `[rad]`.
const INSIDE: f64 = 0.02;

/// Velocity of returning joints, `[rad/s]`.
const RETURN_VELOCITY: f64 = 0.2;

/// Joint velocity below which the arm is still, `[rad/s]`.
const STILL: f64 = 0.01;

/// Smallest number of cycles of a recovery, because clients must see its mode.
const RECOVERY_MIN: u64 = 100;

/// Largest number of cycles of a recovery, without the cycles in which the arm brakes. Without this
/// limit, an external force could prolong the recovery forever.
const RECOVERY_MAX: u64 = 2000;

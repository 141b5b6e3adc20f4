//! The controls that a person at the robot uses: user stop, brakes, guiding, safety functions,
//! Desk.
//!
//! ```text
//!   Other <── close brakes ── any ── press the stop, safety function ──> User stopped
//!     └─ open brakes ─> Idle <─────────── release, deactivate ─────────────────┘
//!   Idle, Reflex, User stopped <── let go ── guide ──> Guiding
//! ```

use franka_model::JointVector;
use franka_proto::{MoveStatus, RecoveryStatus, Reply, RobotError};

use super::ratchet::Ratchet;
use super::{Activity, Robot};
use crate::brake::Brake;

/// An arm that is guided by hand.
#[derive(Debug, Clone, Copy)]
pub(super) struct Guidance {
    /// Joint positions at the start, `[rad]`. Locked directions stay at these positions.
    pub(super) start: JointVector,
    /// Check of each joint against the ends of its range.
    ends: [Ratchet; 7],
}

/// Conditions, other than errors, that prevent motions.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Lock {
    pub(super) user_stop: bool,
    pub(super) safety_function: bool,
    pub(super) brakes_closed: bool,
}

/// Ways in which an arm ignores its commands. The robot still reports the running motion, and no
/// error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Freeze {
    /// The joints do not move, as if the brakes were closed. The robot still accepts torques and
    /// setpoints.
    Joints,
    /// The torques are zero, and neither the setpoints nor the joints move, as if the controllers
    /// had stopped.
    Controllers,
}

/// An arm that ignores its commands.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frozen {
    pub(super) freeze: Freeze,
    /// Positions of the joints, `[rad]`.
    pub(super) q: JointVector,
}

impl Robot {
    /// Makes the arm ignore its commands; `None` makes the arm obey commands again. No manual of
    /// the vendor describes this behaviour, but users have reported it.
    pub fn freeze(&mut self, freeze: Option<Freeze>) {
        let q = *self.plant.q();
        self.frozen = freeze.map(|freeze| Frozen { freeze, q });
    }

    /// True if the arm ignores its commands.
    pub fn is_frozen(&self) -> bool {
        self.frozen.is_some()
    }

    /// True if the robot accepts neither torques nor setpoints.
    pub(super) fn takes_no_commands(&self) -> bool {
        let frozen = self.frozen.map(|frozen| frozen.freeze);
        frozen == Some(Freeze::Controllers)
    }

    /// Presses or releases the user stop. Pressing it ends any motion or recovery. While it is
    /// pressed, the robot starts no motion or recovery, but a person can guide the arm.
    pub fn press_user_stop(&mut self, pressed: bool) {
        self.lock.user_stop = pressed;
        if pressed {
            self.end_everything(
                MoveStatus::EmergencyAborted,
                RecoveryStatus::EmergencyAborted,
            );
        }
    }

    /// Activates or deactivates a safety function that forbids motion, as set up in Desk. A Franka
    /// Research 3 then refuses motions with statuses for safety functions. An FER has no such
    /// statuses, and acts as if the user stop were pressed.
    pub fn activate_safety_function(&mut self, active: bool) {
        self.lock.safety_function = active;
        if active {
            let safety = &self.kind.safety;
            self.end_everything(safety.preempted, safety.recovery);
            self.guide(false);
        }
    }

    /// Closes the brakes. Any motion ends, and no push moves the arm.
    pub fn close_brakes(&mut self) {
        self.lock.brakes_closed = true;
        self.end_everything(MoveStatus::Aborted, RecoveryStatus::Aborted);
        self.guide(false);
    }

    /// Opens the brakes.
    pub fn open_brakes(&mut self) {
        self.lock.brakes_closed = false;
    }

    /// Presses or releases the guiding buttons. Returns true if a person can then guide the arm.
    ///
    /// A guided arm supports itself and its declared load. It moves where a person pushes it, in
    /// the directions that `SetGuidingMode` permits. Guiding requires open brakes and no running
    /// motion. It is also possible after a reflex, and while the user stop is pressed. After the
    /// buttons are released, the arm stops and holds its position.
    pub fn guide(&mut self, pressed: bool) -> bool {
        match (&self.activity, pressed) {
            (Activity::Guided(_), true) => {}
            (Activity::Guided(_), false) => {
                let limits = self.model.joint_limits();
                let start = self.measured_signal();
                let brake = Brake::from(&start, &limits.acceleration, &limits.jerk);
                self.activity = Activity::Braking(brake);
            }
            (Activity::Holding, true) if self.can_be_guided() => {
                self.activity = Activity::Guided(Guidance {
                    start: self.measurement.q,
                    ends: [Ratchet::new(); 7],
                });
            }
            _ => {}
        }
        matches!(self.activity, Activity::Guided(_))
    }

    fn can_be_guided(&self) -> bool {
        !self.lock.brakes_closed && !self.lock.safety_function && self.recovery.is_none()
    }

    /// True if a person has guided a joint further out of its range than it was before.
    pub(super) fn is_guided_out(&mut self) -> bool {
        let limits = self.model.joint_limits();
        let q = self.measurement.q;
        let Activity::Guided(guidance) = &mut self.activity else {
            return false;
        };
        let mut out = false;
        for (i, end) in guidance.ends.iter_mut().enumerate() {
            let clearance = (q[i] - limits.hard_lower[i]).min(limits.hard_upper[i] - q[i]);
            out |= end.is_passed(clearance, 0.0, GUIDED_OUT);
        }
        out
    }

    /// Ends the current motion, a waiting motion and a recovery, and answers their requests.
    fn end_everything(&mut self, moves: MoveStatus, recovery: RecoveryStatus) {
        self.end_motion(moves);
        if let Some((id, _)) = self.waiting.take() {
            self.reply(id, Reply::Move(moves));
        }
        self.abort_recovery(recovery);
    }

    /// Raises an error, which causes a reflex.
    pub fn trip(&mut self, error: RobotError) {
        self.reflex(error.into());
    }
}

/// Largest distance that a joint may be guided out of its range, `[rad]`: a choice of the
/// simulator.
const GUIDED_OUT: f64 = 0.01;

//! The state machine of a motion, from the request to the robot's final reply. It combines the
//! reports of the command connection and of the thread.
//!
//! ```text
//!            begin                      both sides have ended
//!   Idle ------------> UnderWay ------------------------------------> Idle (or the next motion)
//!                         |  command side: Requested -> Started -> Ended(status)
//!                         |  thread side:  Armed -> Running -> Ended(how)
//!                         |
//!                         | given up                  the thread side has ended
//!                         +-----------> Abandoned ------------------> Idle (or the next motion)
//! ```
//!
//! The thread is armed before the `Move` is sent, so it is ready for the first state of the motion.
//! Robot and thread then report in any order; the motion has ended when both have reported its end.
//! Goals can change within a motion: a newer goal supersedes the older one, and a goal that came
//! too late for the motion gets its own motion. Each program of the user runs in its own motion. A
//! motion is given up if a reply cannot be read or a deadline has passed. It then resolves at once,
//! and the next motion waits until the thread has seen the robot leave the old motion. The phases
//! `Stalled` and `Closed` can follow any other phase. A stop lasts longer than the motion that it
//! brakes: it waits until a state shows the arm at rest. If a hand keeps the arm in motion, the
//! robot is asked to stop it, because a motion that finished with a moving arm would end in a
//! reflex.
//!
//! Inputs are [`Lifecycle::begin`], `update`, `close`, `cancel`, `stop`, `chunk`, `tune` and
//! `disengage` (from users), and the `on_*` methods (from the command connection, the thread and
//! the clock). [`Lifecycle::poll`] returns the effects. The lifecycle has no clock, socket or task:
//! `now` is an argument, and it is the time since any fixed moment.

mod close_reason;
mod current_motion;
mod differences;
mod ending;
mod engagement;
mod goal_progress;
mod goals;
mod new_motion;
mod outcome;
mod programs;
mod reports;
mod stops;
#[cfg(test)]
mod tests;
mod unready;

use core::time::Duration;
use std::collections::VecDeque;
use std::sync::Arc;

use franka_model::Model;
use franka_proto::{Request, RobotState, Version};

use crate::driver::{ControlLog, LINK_TIMEOUT, LinkTimeout, MotionId, Order};
use crate::identify::Identified;
use crate::law::Gains;
use crate::law::compensation::Learned;
use crate::session::{Backend, Goal, GoalId, KeepOut, Margin};

use current_motion::CurrentMotion;
use stops::Stop;

pub use close_reason::CloseReason;
pub use differences::Differences;
pub use engagement::{Engagement, Tuning};
pub use new_motion::NewMotion;
pub use outcome::{ControlError, MotionError, MotionReport, Outcome, Party, Stage};
pub use unready::Unready;

/// Time within which the robot must answer a `Move`. After the answer, its states must show the
/// motion's modes within the same time.
pub const START_TIMEOUT: Duration = Duration::from_secs(5);

/// Time within which robot and thread must both end a motion, counted from the moment when the
/// first of them ends it.
pub const END_TIMEOUT: Duration = Duration::from_secs(2);

/// Time within which a stop must bring an arm under target control to rest. After that time, the
/// robot is asked to stop the arm. The robot then has [`END_TIMEOUT`] to end the motion, and the
/// same time to show an arm at rest.
pub const BRAKE_TIMEOUT: Duration = Duration::from_secs(2);

/// An effect that the caller of [`Lifecycle::poll`] must carry out. Effects must be carried out in
/// the order in which they are returned.
#[derive(Debug)]
pub enum Output {
    /// Pass this order to the thread.
    Order(Order),
    /// Send this request on the command connection. Pass the replies to a `Move` to
    /// [`Lifecycle::on_move_reply`] with this motion. No reply to another request is needed.
    Send {
        /// The motion that the request belongs to.
        motion: MotionId,
        /// The request.
        request: Request,
    },
    /// Notify the caller that began this program or session that it now runs, if the caller
    /// requested this notice.
    Began {
        /// Name of the program or session.
        id: GoalId,
    },
    /// Send the outcome to the caller that awaits this goal. Each accepted goal gets exactly one
    /// outcome.
    Resolve {
        /// The goal.
        goal: GoalId,
        /// Outcome of the goal.
        result: Outcome,
    },
}

/// The state machine. See the module's documentation.
#[derive(Debug)]
pub struct Lifecycle {
    model: Arc<Model>,
    version: Version,
    phase: LifecyclePhase,
    /// Motion that waits for the end of the current motion, or of an abandoned motion.
    next: Option<NewMotion>,
    /// The last session that lasted from goal to goal, and its error, if it did not end as
    /// requested.
    ended: Option<(GoalId, MotionError)>,
    /// Stops that have not resolved yet.
    stops: Vec<Stop>,
    motions: u64,
    log_size: usize,
    /// Time without a state after which a change that no state has shown counts as missing.
    link_timeout: Duration,
    keep_out: KeepOut,
    /// Values of the arm from an earlier identification; `None` once a session has begun with them.
    known: Option<Box<Identified>>,
    learned: Learned,
    outputs: VecDeque<Output>,
}

/// Phase of the motion, to the knowledge of the lifecycle.
#[derive(Debug)]
enum LifecyclePhase {
    Idle,
    UnderWay(Box<CurrentMotion>),
    /// A motion was given up and has resolved, but the thread has not seen the robot end it. The
    /// next motion waits until the thread has seen it.
    Abandoned {
        motion: MotionId,
        /// Deadline until which the next motion waits. After the deadline, the error with which new
        /// motions are refused.
        deadline: Result<Duration, MotionError>,
    },
    /// A thread of the user has borrowed the cycle and does not run the cycle. No motion can run.
    Stalled {
        /// The motion that was given up because of the stall, until the thread has ended it.
        abandoned: Option<MotionId>,
    },
    /// The connection has ended, for this reason. No motion starts any more.
    Closed {
        reason: CloseReason,
        /// The motion that still brakes, until the thread has ended it.
        braking: Option<MotionId>,
    },
}

impl LifecyclePhase {
    fn abandoned(motion: MotionId, now: Duration) -> Self {
        let deadline = Ok(now + END_TIMEOUT);
        Self::Abandoned { motion, deadline }
    }
}

impl Lifecycle {
    /// Creates an idle lifecycle for a robot with this model and protocol `version`. Goals must
    /// stay within the model's limits.
    pub fn new(model: Arc<Model>, version: Version) -> Self {
        Self {
            model,
            version,
            phase: LifecyclePhase::Idle,
            next: None,
            ended: None,
            stops: Vec::new(),
            motions: 0,
            log_size: ControlLog::DEFAULT_CAPACITY,
            link_timeout: LINK_TIMEOUT,
            keep_out: KeepOut::default(),
            known: None,
            learned: Learned::default(),
            outputs: VecDeque::new(),
        }
    }

    /// Sets the number of cycles that the log of a motion holds. The default is
    /// [`ControlLog::DEFAULT_CAPACITY`].
    #[must_use]
    pub fn with_log_size(mut self, cycles: usize) -> Self {
        self.log_size = cycles;
        self
    }

    /// Sets the time without a state after which the link counts as lost. The default is
    /// [`LINK_TIMEOUT`].
    #[must_use]
    pub fn with_link_timeout(mut self, timeout: LinkTimeout) -> Self {
        self.link_timeout = timeout.get();
        self
    }

    /// Returns the model of the robot.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Returns the goal with which `motion` would begin under this host's law. Returns `None` for a
    /// program, and under the robot's controller.
    pub fn compliant_goal<'a>(&self, motion: &'a NewMotion) -> Option<&'a Goal> {
        let goals = self.goals().filter(|_| motion.is_within_a_session());
        let compliant = goals.is_none_or(|goals| goals.backend == Backend::Torques);
        motion.compliant_goal().filter(|_| compliant)
    }

    /// Returns the stability margin of these gains for an arm in `state`: see [`Margin::of`].
    pub fn margin(&self, gains: &Gains, state: &RobotState) -> Option<Margin> {
        Margin::of(gains, &self.model, state, self.version)
    }

    /// Makes the first session begin with the identified values of the arm, which must have been
    /// [checked](Identified::check). The part of the identified load that is not declared when that
    /// session begins counts as bias.
    #[must_use]
    pub fn knowing(mut self, found: Identified) -> Self {
        self.known = Some(Box::new(found));
        self
    }

    /// Keeps the arm out of these regions under target control, beginning with the next motion that
    /// starts.
    pub fn keep_out_of(&mut self, regions: KeepOut) {
        self.keep_out = regions;
    }

    /// True if no motion runs and no motion or stop waits. The arm may still brake after the end of
    /// the connection: see [`Self::is_braking`].
    pub fn is_idle(&self) -> bool {
        if !self.stops.is_empty() {
            return false;
        }
        match &self.phase {
            LifecyclePhase::Idle
            | LifecyclePhase::Stalled { .. }
            | LifecyclePhase::Closed { .. } => true,
            // The lifecycle does not wait for a motion whose deadline has passed.
            LifecyclePhase::Abandoned { deadline, .. } => deadline.is_err(),
            LifecyclePhase::UnderWay(_) => false,
        }
    }

    /// True if the connection has ended but the thread is still needed to brake an arm that was on
    /// its way to a goal.
    pub fn is_braking(&self) -> bool {
        matches!(
            self.phase,
            LifecyclePhase::Closed {
                braking: Some(_),
                ..
            }
        )
    }

    /// Returns the next effect to carry out.
    pub fn poll(&mut self) -> Option<Output> {
        self.outputs.pop_front()
    }

    /// Returns the current motion, if it is `motion`.
    fn current(&mut self, motion: MotionId) -> Option<&mut CurrentMotion> {
        match &mut self.phase {
            LifecyclePhase::UnderWay(current) if current.motion == motion => Some(current),
            _ => None,
        }
    }

    fn check_open(&self) -> Result<(), MotionError> {
        match &self.phase {
            LifecyclePhase::Closed { reason, .. } => Err(MotionError::ConnectionClosed {
                reason: reason.clone(),
            }),
            LifecyclePhase::Stalled { .. } => Err(MotionError::Busy),
            LifecyclePhase::Abandoned {
                deadline: Err(why), ..
            } => Err(why.clone()),
            LifecyclePhase::Idle
            | LifecyclePhase::UnderWay(_)
            | LifecyclePhase::Abandoned { .. } => Ok(()),
        }
    }

    fn send(&mut self, motion: MotionId, request: Request) {
        self.outputs.push_back(Output::Send { motion, request });
    }
}

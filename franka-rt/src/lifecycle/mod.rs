//! The state machine of a motion, from the request to the robot's final reply, across the command
//! connection and the thread.
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
//! The thread is armed before the `Move` is sent, so the first state of the motion finds it ready.
//! Robot and thread then report in any order; the motion has ended when both have reported its end.
//! Goals come and go meanwhile: a newer goal supersedes the older one within the same motion, and a
//! goal that came too late for it gets its own motion. A program of the user runs in a separate
//! motion. A motion that is given up, because a reply cannot be read or a deadline has passed,
//! resolves at once; the next motion waits until the thread has seen the robot leave it. The phases
//! `Stalled` and `Closed` can follow on any other phase. A stop outlives the motion that it brakes:
//! it waits until a state shows an arm at rest. If a hand keeps the arm in motion, the robot stops
//! it, because a motion that finished with a moving arm would end in a reflex.
//!
//! Inputs are [`Lifecycle::begin`], `update`, `close`, `cancel`, `stop`, `chunk`, `tune` and
//! `disengage` (from users), and the `on_*` methods (from the command connection, the thread and
//! the clock). Effects are returned by [`Lifecycle::poll`]. The lifecycle has no clock, socket or
//! task: `now` is an argument, counted from any fixed moment.

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

/// Time for the robot to answer a `Move`, and to show the motion's modes after that.
pub const START_TIMEOUT: Duration = Duration::from_secs(5);

/// Time for robot and thread to end a motion, counted from the first end of the two.
pub const END_TIMEOUT: Duration = Duration::from_secs(2);

/// Time for a stop to bring an arm under target control to rest. After that, the robot is asked to
/// stop the arm. The robot then has [`END_TIMEOUT`] to end the motion, and the same time to show an
/// arm at rest.
pub const BRAKE_TIMEOUT: Duration = Duration::from_secs(2);

/// An effect to carry out, in the order in which effects are returned.
#[derive(Debug)]
pub enum Output {
    /// Pass this order to the thread.
    Order(Order),
    /// Send this request on the command connection. Replies to `Move` come back through
    /// [`Lifecycle::on_move_reply`] with this motion; replies to other requests are not awaited.
    Send {
        /// The motion of the request.
        motion: MotionId,
        /// The request.
        request: Request,
    },
    /// Notify the caller that began this program or session that it runs now, if the caller asked
    /// for this.
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
    /// Motion that waits for the end of the motion under way, or of an abandoned motion.
    next: Option<NewMotion>,
    /// The last session that lasted from goal to goal, if it did not end as asked, and its error.
    ended: Option<(GoalId, MotionError)>,
    /// Stops that have not resolved.
    stops: Vec<Stop>,
    motions: u64,
    /// Number of cycles that the log of a motion holds.
    log_size: usize,
    /// Silence of the robot after which a change that no state has shown counts as missing.
    link_timeout: Duration,
    /// Regions that the arm keeps out of under target control.
    keep_out: KeepOut,
    /// Earlier knowledge of the arm; `None` once a session has begun with it.
    known: Option<Box<Identified>>,
    /// Values that sessions have learned about the arm.
    learned: Learned,
    outputs: VecDeque<Output>,
}

/// Phase of the motion, as known.
#[derive(Debug)]
enum LifecyclePhase {
    Idle,
    UnderWay(Box<CurrentMotion>),
    /// A motion was given up and has resolved, but the thread has not seen the robot end it. The
    /// next motion waits for that.
    Abandoned {
        motion: MotionId,
        /// Deadline until which the next motion waits. After that, the error with which new motions
        /// are refused.
        deadline: Result<Duration, MotionError>,
    },
    /// A thread of the user has borrowed the cycle and does not run it. No motion can run.
    Stalled {
        /// The motion that was given up because of this, until the thread has ended it.
        abandoned: Option<MotionId>,
    },
    /// The connection is gone, for this reason; no motion starts any more.
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
    /// Returns an idle lifecycle for a robot of this model and protocol `version`. Goals must keep
    /// the model's limits.
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

    /// Replaces the number of cycles that the log of a motion holds,
    /// [`ControlLog::DEFAULT_CAPACITY`] by default.
    #[must_use]
    pub fn with_log_size(mut self, cycles: usize) -> Self {
        self.log_size = cycles;
        self
    }

    /// Replaces the silence after which the link counts as lost, [`LINK_TIMEOUT`] by default.
    #[must_use]
    pub fn with_link_timeout(mut self, timeout: LinkTimeout) -> Self {
        self.link_timeout = timeout.get();
        self
    }

    /// Returns the model of the robot.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// Returns the goal that `motion` would begin with under this host's law. `None` for a program,
    /// and under the robot's controller.
    pub fn compliant_goal<'a>(&self, motion: &'a NewMotion) -> Option<&'a Goal> {
        let goals = self.goals().filter(|_| motion.is_within_a_session());
        let compliant = goals.is_none_or(|goals| goals.backend == Backend::Torques);
        motion.compliant_goal().filter(|_| compliant)
    }

    /// Returns the stability margin of these gains for an arm in `state`: see [`Margin::of`].
    pub fn margin(&self, gains: &Gains, state: &RobotState) -> Option<Margin> {
        Margin::of(gains, &self.model, state, self.version)
    }

    /// Begins the first session with the identified values of the arm, which were
    /// [checked](Identified::check). The load that is declared at that time counts.
    #[must_use]
    pub fn knowing(mut self, found: Identified) -> Self {
        self.known = Some(Box::new(found));
        self
    }

    /// Keeps the arm out of these regions under target control, from the next motion that starts.
    pub fn keep_out_of(&mut self, regions: KeepOut) {
        self.keep_out = regions;
    }

    /// Returns true if no motion is under way, and no motion or stop waits. The arm may still brake
    /// after the end of the connection: see [`Self::is_braking`].
    pub fn is_idle(&self) -> bool {
        if !self.stops.is_empty() {
            return false;
        }
        match &self.phase {
            LifecyclePhase::Idle
            | LifecyclePhase::Stalled { .. }
            | LifecyclePhase::Closed { .. } => true,
            // The lifecycle does not wait for a motion that has passed its deadline.
            LifecyclePhase::Abandoned { deadline, .. } => deadline.is_err(),
            LifecyclePhase::UnderWay(_) => false,
        }
    }

    /// True if the thread is still needed after the end of the connection, to brake an arm that was
    /// on its way to a goal.
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

    /// Returns the motion under way, if it is `motion`.
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

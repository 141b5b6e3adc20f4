//! Target control: turns goals into one continuous joint-space reference and torques.
//!
//! ```text
//! prepared: newest goal -> lead -> course (joint generator | pose generator -> inverse kinematics)
//!           -> clearance
//! answered: -> leash -> law -> guards of the torques -> torques
//! ```
//!
//! The session prepares as much of an answer as it can before the state arrives. Between the state
//! and the answer, it computes only the parts that need this state.
//!
//! The state of a session is a joint reference `q, dq, ddq`. A course moves the reference. For
//! joint goals and for braking, the course has seven axes, one for each joint. For poses, it has
//! three axes of translation and three of rotation. When the kind of goal changes, the new course
//! starts from the position, velocity and acceleration of the reference, so none of them jumps.
//!
//! A goal that should finish passes through the stages of `GoalStage`: under way, landing,
//! releasing, finished. From any stage except finished, a newer goal returns the session to the
//! stage under way.

mod aim;
mod approach;
mod arrival;
mod backend;
mod budget;
pub(crate) mod check;
mod chunk;
pub mod condition;
mod course;
mod effort;
pub mod geometry;
mod goal;
mod goal_error;
mod guard;
mod guide;
mod joints;
mod kinematics;
mod margin;
mod membership;
mod pose;
mod reaction;
mod reference;
mod running;
mod setpoint_stream;
mod settlement;
mod step;
#[cfg(test)]
mod tests;
mod tolerance;
mod tool;

use core::time::Duration;
use std::sync::Arc;

use franka_model::Model;
use franka_proto::{RobotState, Version};

use crate::law::compensation::Learned;
use crate::team::{Member, MemberFault};
use crate::together::{Gate, StartFault};
use crate::triple_buffer;

pub use approach::{target_range, target_range_of};
pub(crate) use arrival::REST_VELOCITY;
pub use arrival::{PoseError, RELEASE_TIMEOUT, Settling, Shortfall};
pub use backend::{Backend, Controller, Setpoints};
pub use budget::Budget;
pub use chunk::{
    Blocked, Chunk, ChunkError, ChunkReader, ChunkWriter, Fate, Full, PathError, Preview, Returned,
    Waypoint, chunk_ring,
};
pub use goal::{Free, Goal, GoalId, OnArrival, Target};
pub use goal_error::{GoalError, Hindrance, TooManyChunks};
pub use guard::clearance::{KEEP_OUT_MAX, KEEP_OUT_STOP, KeepOut, SELF_STOP, SLOW_ZONE};
pub use guard::deadman::{Deadman, DeadmanMonitor, Pulse};
pub use guard::deviation::Deviation;
pub use guard::force_cap::ForceCap;
pub use guard::lead::Lead;
pub use guard::leash::Leash;
pub use guard::torque_clamp::LimitedTorque;
pub use guard::velocity_barrier::ONSET as VELOCITY_BARRIER_ONSET;
pub use guard::watchdog::{OnTimeout, Watchdog};
pub use guard::{Bindings, Guard};
pub use margin::Margin;
pub use reaction::{Reacted, Reaction};
pub use settlement::{Lapse, SessionEvent, Settlement};
pub use tolerance::Tolerance;

pub(crate) use step::{SessionCommand, SessionStep, Trace};

use membership::Membership;
use running::RunningSession;
use tool::{end_effector_of, load_of, rigid};

/// Time for which an obstacle, or the joints' bounds, may hold the reference back while the arm
/// comes no nearer to its target. A goal that should finish is then braked, and ends where it is.
/// Pauses of up to a second count as part of this time.
pub const STALL_TIMEOUT: Duration = Duration::from_secs(5);

/// One session of target control. The program creates the session, moves it into the control
/// thread, and gets it back when the session has ended.
#[derive(Debug)]
pub struct TargetSession {
    model: Arc<Model>,
    goals: triple_buffer::Reader<Goal>,
    active: Option<RunningSession>,
    /// A goal that waits for its common start with other robots.
    held: Option<Goal>,
    /// A goal whose common start failed, and why it failed.
    unstarted: Option<(GoalId, StartFault)>,
    deadman: Option<DeadmanMonitor>,
    team: Option<Membership>,
    backend: Backend,
    version: Version,
    chunks: Option<ChunkReader>,
    keep_out: KeepOut,
    speed_cap: Option<f64>,
    /// Action of the session after a held goal had to be given up.
    afterwards: OnArrival,
    /// State of the gate, which lets the goals of a common start begin, in the newest state.
    gate: Gate,
    /// Values learned about the arm in earlier sessions.
    known: Learned,
}

impl TargetSession {
    /// Creates a session that follows the goals written to `goals`, for a robot with protocol
    /// `version`. The first goal must be written before the session runs.
    pub fn new(model: Arc<Model>, version: Version, goals: triple_buffer::Reader<Goal>) -> Self {
        Self {
            model,
            goals,
            active: None,
            held: None,
            unstarted: None,
            deadman: None,
            team: None,
            backend: Backend::default(),
            version,
            chunks: None,
            keep_out: KeepOut::default(),
            speed_cap: None,
            afterwards: OnArrival::ReportAndFinish,
            gate: Gate::Closed,
            known: Learned::default(),
        }
    }

    /// Begins with the values that earlier sessions have [learned](Self::learned) about the arm.
    #[must_use]
    pub(crate) fn knowing(mut self, learned: Learned) -> Self {
        self.known = learned;
        self
    }

    /// Returns the values learned about the arm so far.
    pub(crate) fn learned(&self) -> Learned {
        let active = self.active.as_ref();
        active.map_or(self.known, |active| active.learned(self.known))
    }

    /// Makes the session hold the arm, where a held goal was given up, until the next goal arrives.
    /// By default the session ends there.
    #[must_use]
    pub fn going_on(mut self) -> Self {
        self.afterwards = OnArrival::ReportAndHold;
        self
    }

    /// Keeps the arm out of these regions; by default there are no regions. The arm always keeps
    /// clear of itself.
    ///
    /// If the robot reports an end effector with a mass, the session assumes the vendor's Hand on
    /// the flange.
    #[must_use]
    pub fn out_of(mut self, regions: KeepOut) -> Self {
        self.keep_out = regions;
        self
    }

    /// Caps the speed of every point of the arm, `[m/s]`; by default the session has no cap.
    #[must_use]
    pub fn no_faster_than(mut self, speed_cap: f64) -> Self {
        self.speed_cap = Some(speed_cap);
        self
    }

    /// Sets the backend that turns setpoints into torques. The default is the session's own control
    /// law.
    #[must_use]
    pub fn with_backend(mut self, backend: Backend) -> Self {
        self.backend = backend;
        if let Some(limited) = backend.limited(&self.model) {
            self.model = Arc::new(limited);
        }
        self
    }

    /// Binds the session to a deadman, which brakes the arm when the program falls silent.
    #[must_use]
    pub fn bound_to(mut self, deadman: DeadmanMonitor) -> Self {
        self.deadman = Some(deadman);
        self
    }

    /// Makes the session a member of a team.
    #[must_use]
    pub fn in_team(mut self, member: Member) -> Self {
        self.team = Some(Membership::new(member));
        self
    }

    /// Stops the team for a fault outside the session's goals. Does nothing if the session is in no
    /// team.
    pub(crate) fn fail_team(&mut self, fault: MemberFault) {
        if let Some(team) = &mut self.team {
            team.fail(fault);
        }
    }

    /// Reports to the team that no state has arrived for `silence`.
    pub(crate) fn on_silence(&mut self, silence: Duration) {
        if let Some(team) = &mut self.team {
            team.on_silence(silence);
        }
    }

    pub(crate) fn leave_team(&mut self) {
        if let Some(team) = &mut self.team {
            team.leave();
        }
    }

    /// Lets the session follow chunks.
    ///
    /// The newest chunk of the current goal moves the arm; meanwhile, the goal's own target has no
    /// effect. At the end of the chunk, the arm rests, and [`OnArrival`] applies.
    ///
    /// Send the first chunk before you write its goal, so that the arm does not start to move to
    /// the goal's target. [`Target::Rest`] is a suitable target for most of these goals.
    #[must_use]
    pub fn with_chunks(mut self, chunks: ChunkReader) -> Self {
        self.chunks = Some(chunks);
        self
    }

    /// Returns the newest goal that the session has accepted. Newer goals in the slot came too late
    /// for this session.
    pub fn last_goal(&self) -> Option<GoalId> {
        let active = self.active.as_ref().map(|active| active.goal.id);
        self.held.map(|held| held.id).or(active)
    }

    /// Returns how far the arm was from its target at the release, before the robot's controller
    /// took over.
    pub(crate) fn released(&self) -> Option<PoseError> {
        self.active.as_ref()?.released()
    }

    /// Removes the path of `goal` from a session that has ended before it saw that goal.
    pub(crate) fn take_path(&mut self, goal: GoalId) -> Option<Chunk> {
        self.chunks.as_mut()?.take(goal)
    }

    /// True if all values of `state` that the session uses are finite. Measured joints and torques
    /// are checked elsewhere.
    pub(crate) fn can_read(&self, state: &RobotState) -> bool {
        self.backend.can_read(state)
    }

    /// Answers one state with the results of [`Self::prepare`]. Takes bounded time and does not
    /// allocate.
    ///
    /// While the gate of a common start is closed, the session holds the arm where it is, with the
    /// gains of the waiting goal. If the start fails, the arm lands there, unless another goal
    /// arrives.
    ///
    /// The report is written to `event`, because a return value of 280 bytes would be copied in
    /// every cycle.
    pub(crate) fn answer(
        &mut self,
        gate: Gate,
        state: &RobotState,
        event: &mut Option<SessionEvent>,
    ) -> SessionStep {
        self.gate = gate;
        if self.active.is_none() {
            let Some(goal) = self.newer() else {
                // The first goal was torn (read while it was being written), so the arm is held for
                // this cycle.
                return SessionStep {
                    answer: self.backend.holding(state),
                    trace: Trace::default(),
                    finished: false,
                };
            };
            let goal = match &mut self.team {
                Some(team) => team.first(goal),
                None => goal,
            };
            self.active = RunningSession::begin(
                &self.model,
                goal,
                self.backend,
                self.version,
                self.keep_out,
                self.afterwards,
                state,
            )
            .map(|active| active.knowing(self.known).no_faster_than(self.speed_cap));
        }
        self.prepare_for(state.message_id);
        let Some(active) = &mut self.active else {
            *event = Some(SessionEvent::BadTool);
            return SessionStep {
                answer: self.backend.holding(state),
                trace: Trace::default(),
                finished: true,
            };
        };
        let step = active.answer(&self.model, state, event);
        if let (Some(team), Some(event)) = (&mut self.team, &*event) {
            team.settle(event, active.goal.target);
        }
        if let Some(SessionEvent::Settled {
            goal, settlement, ..
        }) = event
            && let Some((unstarted, fault)) = self.unstarted
            && *goal == unstarted
        {
            *settlement = Settlement::Unstarted(fault);
        }
        step
    }

    /// Computes everything that does not depend on the next state: accepts goals and chunks, plans,
    /// and moves the reference by one step. Takes bounded time and does not allocate.
    pub(crate) fn prepare(&mut self) {
        if let Some(active) = &self.active {
            let next = active.newest() + 1;
            self.prepare_for(next);
        }
    }

    /// Prepares the answer to the state with `message_id` `now`, unless that answer is already
    /// prepared.
    fn prepare_for(&mut self, now: u64) {
        if self.active.as_ref().is_none_or(RunningSession::is_prepared) {
            return;
        }
        let mut newer = self.newer();
        let mut stop = None;
        if let Some(team) = &mut self.team {
            (newer, stop) = team.admit(newer, now);
        }
        let alive = |monitor: &mut DeadmanMonitor| monitor.is_alive(now);
        let alive = self.deadman.as_mut().is_none_or(alive);
        if let Some(active) = &mut self.active {
            let waits = self.team.as_ref().is_some_and(Membership::waits);
            let watched = (alive, stop, waits);
            active.prepare(
                &self.model,
                newer.as_ref(),
                watched,
                self.chunks.as_mut(),
                now,
            );
            if let Some(team) = &mut self.team {
                team.watch(active);
            }
        }
    }

    /// True if the goal that waits for its common start was withdrawn or replaced.
    pub(crate) fn is_withdrawn(&mut self) -> bool {
        let Some(goal) = self.read() else {
            return false;
        };
        let before = self.held.replace(goal);
        goal.target == Target::Rest || before.is_some_and(|before| before.id != goal.id)
    }

    /// Returns the newest goal, if the session has not begun it. Before a common start, returns the
    /// goal's substitute.
    fn newer(&mut self) -> Option<Goal> {
        match self.gate {
            Gate::Open => {
                let newer = self.read();
                if self.held.is_none() {
                    return newer;
                }
                newer.or(self.held.take())
            }
            Gate::Closed => {
                let nothing = self.active.is_none();
                self.held.filter(|_| nothing).map(|held| Goal {
                    id: GoalId::default(), // no goal's
                    watchdog: None,        // No goal may expire before the common start.
                    ..held.at_rest(OnArrival::Hold)
                })
            }
            Gate::Broken(fault) => {
                let waited = self.held.take();
                let newer = self.read();
                let unstarted = waited.or(newer)?.id;
                let (unstarted, _) = *self.unstarted.get_or_insert((unstarted, fault));
                let goal = newer.or(waited)?;
                Some(if goal.id == unstarted {
                    goal.at_rest(OnArrival::ReportAndFinish)
                } else {
                    goal
                })
            }
        }
    }

    fn read(&mut self) -> Option<Goal> {
        self.goals.read_newer()
    }
}

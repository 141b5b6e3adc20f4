//! Stops: the moving arm brakes, and after that the states must show that the arm rests.

use core::mem;
use core::time::Duration;

use franka_proto::{MotionGeneratorMode, Request, RobotMode, RobotState};

use super::ending::STILL_SHOWN;
use super::outcome::Counted;
use super::{
    BRAKE_TIMEOUT, END_TIMEOUT, Lifecycle, LifecyclePhase, MotionError, MotionId, MotionReport,
    Outcome, Output,
};
use crate::session::{Goal, GoalId, OnArrival, REST_VELOCITY};

/// A stop that has not resolved yet.
#[derive(Debug)]
pub(super) struct Stop {
    id: GoalId,
    stage: StopStage,
}

#[derive(Debug)]
enum StopStage {
    /// The current motion brakes.
    Braking {
        /// The goal whose outcome decides the outcome of the stop. Several stops may share one
        /// goal.
        goal: GoalId,
        /// Deadline after which the robot is asked to stop the motion; `None` once the robot was
        /// asked.
        until: Option<Duration>,
    },
    /// Nothing that this program started moves any more. The states must show this.
    Showing {
        /// Report on the motion that was stopped.
        report: Box<MotionReport>,
        /// Deadline until which the states must show it; `None` until the first state.
        until: Option<Duration>,
        /// Reason why the newest state does not show an arm at rest.
        why: MotionError,
    },
}

impl StopStage {
    fn is_braking_by(&self, newest: GoalId) -> bool {
        matches!(self, Self::Braking { goal, .. } if *goal == newest)
    }

    fn until(&self) -> Option<Duration> {
        match self {
            Self::Braking { until, .. } | Self::Showing { until, .. } => *until,
        }
    }

    fn showing(report: MotionReport) -> Self {
        Self::Showing {
            report: Box::new(report),
            until: None,
            why: STILL_SHOWN,
        }
    }
}

impl Lifecycle {
    /// Brakes everything that moves. Goals from before the stop resolve as
    /// [`MotionError::Stopped`]. The stop resolves with `id` when the motion has ended and a state
    /// shows the arm at rest and the robot without a motion. Does nothing and returns false if the
    /// arm already rests, or if the connection has ended.
    ///
    /// `StopMove` is sent again if a motion was given up and the robot may still run it. It is also
    /// sent if the current motion has not ended after [`BRAKE_TIMEOUT`]. Stops that are requested
    /// at the same time share one braking and its outcome.
    pub fn stop(&mut self, id: GoalId, state: &RobotState, now: Duration) -> bool {
        match &self.phase {
            LifecyclePhase::Closed { .. } => return false,
            LifecyclePhase::Idle if unrest(state).is_none() => return false,
            LifecyclePhase::UnderWay(_) => {
                self.brake(id, now);
                return true;
            }
            LifecyclePhase::Idle
            | LifecyclePhase::Abandoned { .. }
            | LifecyclePhase::Stalled { .. } => {}
        }
        self.resolve_next(MotionError::Stopped);
        self.send(MotionId(self.motions), Request::StopMove);
        let report = MotionReport::new(&Counted::default(), 0, None);
        let stage = StopStage::showing(report);
        self.stops.push(Stop { id, stage });
        true
    }

    fn brake(&mut self, id: GoalId, now: Duration) {
        if self.stop_program(id, now) {
            // The waiting session waits for the program's end.
            self.resolve_next(MotionError::Stopped);
            return self.await_brake(id, id, now);
        }
        if let Some(goal) = self.brake_of_a_stop() {
            if self.next.as_ref().is_some_and(|next| next.id() != goal) {
                self.resolve_next(MotionError::Stopped);
            }
            return self.await_brake(id, goal, now);
        }
        if let Some(goals) = self.goals() {
            let goal = Goal {
                id,
                ..goals.current.at_rest(OnArrival::ReportAndFinish)
            };
            self.await_brake(id, id, now);
            self.replace(goal, None, MotionError::Stopped);
        }
    }

    fn await_brake(&mut self, id: GoalId, goal: GoalId, now: Duration) {
        let until = Some(now + BRAKE_TIMEOUT);
        let stage = StopStage::Braking { goal, until };
        self.stops.push(Stop { id, stage });
    }

    fn brake_of_a_stop(&self) -> Option<GoalId> {
        let (newest, _) = self.heading()?;
        let brakes = |stop: &Stop| stop.stage.is_braking_by(newest);
        self.stops.iter().any(brakes).then_some(newest)
    }

    /// Processes the newest state for stops that wait until a state shows an arm at rest.
    pub fn on_state(&mut self, state: &RobotState, now: Duration) {
        if self.stops.is_empty() {
            return;
        }
        let unrest = match &self.phase {
            LifecyclePhase::Idle => unrest(state),
            // Another motion has begun, or a goal within the stopped motion.
            LifecyclePhase::UnderWay(_) => return self.fail_stops(&MotionError::Superseded),
            // The thread has not seen the end of the motion.
            _ => Some(STILL_SHOWN),
        };
        for stop in mem::take(&mut self.stops) {
            let Stop { id, stage } = stop;
            let stage = match (stage, &unrest) {
                (StopStage::Showing { report, .. }, None) => {
                    self.tell_of_stop(id, Ok(*report));
                    continue;
                }
                (StopStage::Showing { report, until, .. }, Some(why)) => StopStage::Showing {
                    report,
                    until: until.or(Some(now + END_TIMEOUT)),
                    why: why.clone(),
                },
                (braking, _) => braking,
            };
            self.stops.push(Stop { id, stage });
        }
    }

    /// Resolves the stops that brake with this goal, using its outcome. Returns the outcome if
    /// there is no such stop.
    pub(super) fn share_with_stops(&mut self, goal: GoalId, result: Outcome) -> Option<Outcome> {
        let brakes = |stop: &Stop| stop.stage.is_braking_by(goal);
        if !self.stops.iter().any(brakes) {
            return Some(result);
        }
        for stop in mem::take(&mut self.stops) {
            match &result {
                _ if !brakes(&stop) => self.stops.push(stop),
                Ok(report) => {
                    let stage = StopStage::showing(*report);
                    self.stops.push(Stop { stage, ..stop });
                }
                Err(error) => self.tell_of_stop(stop.id, Err(error.clone())),
            }
        }
        None
    }

    /// Handles stops whose deadline has passed. If a motion still brakes, the robot is asked to
    /// stop it. A stop that waits for a state resolves: with `unseen` if no state arrived,
    /// otherwise with the reason from the newest state.
    pub(super) fn give_up_stops(&mut self, now: Duration, unseen: Option<&MotionError>) {
        for mut stop in mem::take(&mut self.stops) {
            let is_over = stop.stage.until().is_some_and(|until| until <= now);
            match &mut stop.stage {
                StopStage::Showing { why, .. } if is_over => {
                    let error = unseen.unwrap_or(why).clone();
                    self.tell_of_stop(stop.id, Err(error));
                    continue;
                }
                StopStage::Braking { until, .. } if is_over => {
                    *until = None;
                    self.send_stop(now);
                }
                StopStage::Showing { .. } | StopStage::Braking { .. } => {}
            }
            self.stops.push(stop);
        }
    }

    pub(super) fn fail_stops(&mut self, error: &MotionError) {
        for stop in mem::take(&mut self.stops) {
            match stop.stage {
                StopStage::Showing { .. } => self.tell_of_stop(stop.id, Err(error.clone())),
                StopStage::Braking { .. } => self.stops.push(stop),
            }
        }
    }

    pub(super) fn deadline_of_stops(&self) -> Option<Duration> {
        let until = self.stops.iter().map(|stop| stop.stage.until());
        until.flatten().min()
    }

    pub(super) fn postpone_stops(&mut self, now: Duration, later: Duration) {
        for stop in &mut self.stops {
            if let StopStage::Braking {
                until: Some(until), ..
            }
            | StopStage::Showing {
                until: Some(until), ..
            } = &mut stop.stage
                && *until <= now
            {
                *until = later;
            }
        }
    }

    fn tell_of_stop(&mut self, goal: GoalId, result: Outcome) {
        self.outputs.push_back(Output::Resolve { goal, result });
    }
}

/// Returns the reason why `state` does not show an arm at rest and a robot without a motion.
/// Returns `None` if it shows both.
fn unrest(state: &RobotState) -> Option<MotionError> {
    // The modes of a motion appear in the states before the robot's mode changes.
    let begins = state.robot_mode == RobotMode::Idle
        && state.motion_generator_mode != MotionGeneratorMode::Idle;
    if begins || state.robot_mode == RobotMode::Move {
        return Some(STILL_SHOWN);
    }
    let rests = |dq: &f64| dq.abs() < REST_VELOCITY;
    let joint = state.dq.iter().position(|dq| !rests(dq))?;
    Some(MotionError::NotAtRest {
        joint: joint + 1,
        velocity: state.dq[joint],
    })
}

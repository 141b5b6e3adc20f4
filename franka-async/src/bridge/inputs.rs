//! Inputs of handles and motions to the bridge: to begin, change and end goals.

use franka_rt::lifecycle::{MotionError, NewMotion};
use franka_rt::session::{Chunk, GoalId};
use tracing::Span;

use super::planning::PLANS;
use super::{Bridge, Caller, log};
use crate::destination::Now;
use crate::input::{Beginning, EndReply, Input, Replies};

impl Bridge {
    pub(super) fn on_input(&mut self, input: Input) {
        let now = self.now();
        self.catch_up();
        match input {
            Input::Begin {
                mut motion,
                replies,
            } => match (self.check_turn_of_plan(&motion.motion), motion.path.take()) {
                (Err(error), _) => self.refuse(motion.motion.id(), replies, error),
                (Ok(()), Some(waypoints)) => self.plan(motion, waypoints, replies, PLANS),
                (Ok(()), None) => self.take_up(motion, None, replies),
            },
            Input::Update {
                goal,
                target,
                taken,
            } => {
                let updated = self.lifecycle.update(goal, target, &self.publisher.state());
                self.course.head_for(self.lifecycle.heading());
                let _ = taken.send(updated);
            }
            Input::Set { motion, taken } => {
                let id = motion.motion.id();
                let begun = self.begin(motion, None);
                self.course.head_for(self.lifecycle.heading());
                self.note_refusal(id, &begun);
                let _ = taken.send(begun);
            }
            Input::SetNewest { waiting } => {
                let Some(motion) = waiting.take() else {
                    return;
                };
                let id = motion.motion.id();
                let begun = self.begin(motion, None);
                self.note_refusal(id, &begun);
            }
            Input::Chunk {
                id,
                goal,
                chunk,
                taken,
            } => {
                let (state, number) = (*self.publisher.state(), goal.id);
                let sent = self.lifecycle.chunk(id, *goal, *chunk, &state);
                if sent.is_ok() {
                    self.supersede_plans(Some(id));
                }
                self.course.head_for(self.lifecycle.heading());
                self.note_refusal(number, &sent);
                let _ = taken.send(sent);
            }
            Input::Tune {
                id,
                tuning,
                kept,
                taken,
            } => {
                let state = *self.publisher.state();
                let tuned = self.lifecycle.tune(id, *tuning, &state);
                if tuned.is_ok() {
                    kept.change(*tuning);
                    self.tune_plans(id, &tuning);
                    self.warn_of_margin(id, tuning.gains, &state);
                    self.warn_of_thresholds(id, tuning.force_cap);
                }
                let _ = taken.send(tuned);
            }
            // The waiting future may have been dropped.
            Input::Await { taken } => drop(taken.send(Ok(()))),
            Input::Disengage { id } => {
                self.end_plans_of(id);
                self.lifecycle.disengage(id);
            }
            Input::Close { goal } => self.lifecycle.close(goal),
            Input::Pause { goal, paused } => {
                self.pause_plan(goal, paused);
                self.lifecycle.pause(goal, paused);
            }
            Input::Cancel { goal, .. } if self.cancel_plan(goal) => {}
            Input::Cancel { goal, refused } => {
                if let Some(error) = refused {
                    tracing::info!(goal = goal.0, %error, "target refused; the motion stops");
                    if let Some(caller) = self.callers.get_mut(&goal) {
                        caller.refused = Some(error);
                    }
                }
                self.lifecycle.cancel(goal, now);
            }
            Input::Stop { goal, ended, .. } => {
                self.drop_plans(MotionError::Stopped);
                let stops = self.lifecycle.stop(goal, &self.publisher.state(), now);
                if stops {
                    let ended = EndReply::One(ended);
                    let span = tracing::info_span!("stop", goal = goal.0);
                    self.await_end(goal, Replies { began: None, ended }, span);
                }
                // Otherwise the arm rests already. Dropping `ended` reports this.
            }
            Input::Lose { reason } => self.lose(reason),
            Input::Shutdown { .. } => unreachable!("taken where the loop decides to close"),
        }
    }

    /// Reads the values that the control thread has published. The caller may react to an event
    /// that is in the queue but not yet read by this task. Also, without wake-ups for every state,
    /// the last published state is old.
    pub(super) fn catch_up(&mut self) {
        self.publisher.refresh();
        self.observe();
        self.look_for_a_stall();
        self.take_notices();
    }

    /// Begins a motion, along `path` if there is one, or refuses the motion.
    pub(super) fn take_up(&mut self, motion: Beginning, path: Option<Chunk>, replies: Replies) {
        let id = motion.motion.id();
        let compliant = self.lifecycle.compliant_goal(&motion.motion);
        let gains = compliant.map(|goal| goal.gains);
        let force_cap = compliant.map(|goal| goal.force_cap);
        match self.begin(motion, path) {
            Ok(()) => {
                self.warn_of_margin(id, gains, &self.publisher.state());
                self.warn_of_thresholds(id, force_cap);
                let span = tracing::info_span!("motion", goal = id.0);
                self.await_end(id, replies, span);
            }
            Err(error) => self.refuse(id, replies, error),
        }
    }

    fn await_end(&mut self, id: GoalId, replies: Replies, span: Span) {
        let caller = Caller {
            replies,
            span,
            refused: None,
        };
        self.callers.insert(id, caller);
    }

    /// Completes the motion with the robot's present position, and begins it.
    fn begin(&mut self, beginning: Beginning, path: Option<Chunk>) -> Result<(), MotionError> {
        let (now, state) = (self.now(), *self.publisher.state());
        let Beginning {
            mut motion,
            destination,
            path: _,
            refused,
            joint_fallback: _,
        } = beginning;
        if let Some(error) = refused {
            return Err(error.into());
        }
        let NewMotion::Goal {
            goal,
            path: chunk,
            session,
            ..
        } = &mut motion
        else {
            return self.lifecycle.begin(motion, &state, now);
        };
        if let Some(destination) = destination {
            let reference = self.course.reference().map(|reference| reference.q);
            let heading = self.lifecycle.heading().map(|(_, target)| target);
            let now = Now::of(self.lifecycle.model(), &state, heading, reference);
            goal.target = destination.seen_from(&now);
        }
        *chunk = path.map(Box::new);
        let session = *session;
        self.lifecycle.begin(motion, &state, now)?;
        self.supersede_plans(session);
        Ok(())
    }

    /// Records a goal that its session has not accepted.
    fn note_refusal(&self, goal: GoalId, taken: &Result<(), MotionError>) {
        if let Err(error) = taken {
            let refused = Err(error.clone());
            log(goal, &refused);
            #[cfg(feature = "record")]
            self.supervisor.write_down(goal, &refused);
        }
    }

    pub(super) fn refuse(&self, goal: GoalId, replies: Replies, error: MotionError) {
        let refused = Err(error);
        log(goal, &refused);
        self.supervisor.on_ended(goal, &refused);
        replies.ended.send(refused);
    }
}

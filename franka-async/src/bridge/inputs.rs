//! What handles and motions ask of the bridge: goals to begin, to change and to end.

use franka_rt::lifecycle::{MotionError, NewMotion};
use franka_rt::session::{Chunk, GoalId};

use super::{Bridge, log};
use crate::destination::Now;
use crate::input::{Beginning, EndReply, Input, Replies};

impl Bridge {
    pub(super) fn on_input(&mut self, input: Input) {
        let now = self.now();
        // If no wake-up per state is requested, the state that was published last is old.
        self.publisher.refresh();
        self.observe();
        // The caller may react to an event that is in the queue and not yet read by this task: the
        // queue is read before the input is handled.
        self.look_for_a_stall();
        self.take_notices();
        match input {
            Input::Begin { motion, replies } => {
                let id = motion.motion.id();
                let compliant = self.lifecycle.compliant_goal(&motion.motion);
                let gains = compliant.map(|goal| goal.gains);
                let force_cap = compliant.map(|goal| goal.force_cap);
                match self.begin(motion) {
                    Ok(()) => {
                        self.warn_of_margin(id, gains, &self.publisher.state());
                        self.warn_of_thresholds(id, force_cap);
                        let span = tracing::info_span!("motion", goal = id.0);
                        self.replies.insert(id, (replies, span));
                    }
                    Err(error) => self.refuse(id, replies, error),
                }
            }
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
                let begun = self.begin(motion);
                self.course.head_for(self.lifecycle.heading());
                self.note_refusal(id, &begun);
                let _ = taken.send(begun);
            }
            Input::SetNewest { waiting } => {
                let Some(motion) = waiting.take() else {
                    return;
                };
                let id = motion.motion.id();
                let begun = self.begin(motion);
                self.note_refusal(id, &begun);
            }
            Input::Chunk {
                id,
                goal,
                chunk,
                taken,
            } => {
                let (state, number) = (&self.publisher.state(), goal.id);
                let sent = self.lifecycle.chunk(id, *goal, *chunk, state);
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
                let state = &self.publisher.state();
                let tuned = self.lifecycle.tune(id, *tuning, state);
                if tuned.is_ok() {
                    kept.change(*tuning);
                    self.warn_of_margin(id, tuning.gains, state);
                    self.warn_of_thresholds(id, tuning.force_cap);
                }
                let _ = taken.send(tuned);
            }
            Input::Disengage { id } => self.lifecycle.disengage(id),
            Input::Close { goal } => self.lifecycle.close(goal),
            Input::Pause { goal, paused } => self.lifecycle.pause(goal, paused),
            Input::Cancel { goal, refused } => {
                if let Some(error) = refused {
                    tracing::info!(goal = goal.0, %error, "a target is refused: the motion stops");
                    self.refused = Some((goal, error));
                }
                self.lifecycle.cancel(goal, now);
            }
            Input::Stop { goal, ended } => {
                let stops = self.lifecycle.stop(goal, &self.publisher.state(), now);
                if stops {
                    let ended = EndReply::One(ended);
                    let span = tracing::info_span!("stop", goal = goal.0);
                    self.replies
                        .insert(goal, (Replies { began: None, ended }, span));
                }
                // Otherwise the arm rests already, and dropping `ended` says so.
            }
            Input::Lose { reason } => self.lose(reason),
            Input::Shutdown { .. } => unreachable!("taken where the loop decides to close"),
        }
    }

    /// Completes a motion by where the robot is, and begins it.
    fn begin(&mut self, beginning: Beginning) -> Result<(), MotionError> {
        let (now, state) = (self.now(), &self.publisher.state());
        let Beginning {
            mut motion,
            destination,
            path,
            refused,
        } = beginning;
        if let Some(error) = refused {
            return Err(error.into());
        }
        let NewMotion::Goal {
            goal, path: chunk, ..
        } = &mut motion
        else {
            return self.lifecycle.begin(motion, state, now);
        };
        let reference = self.course.reference().map(|reference| reference.q);
        if let Some(destination) = destination {
            let heading = self.lifecycle.heading().map(|(_, target)| target);
            let now = Now::of(self.lifecycle.model(), state, heading, reference);
            goal.target = destination.seen_from(&now);
        }
        if let Some(path) = path {
            let q = reference.unwrap_or(state.q);
            let path = Chunk::through(&path, &q, goal, self.lifecycle.model(), state)?;
            *chunk = Some(Box::new(path));
        }
        self.lifecycle.begin(motion, state, now)
    }

    /// Notes a goal that its session has not taken.
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

//! Streamed goals: targets that move, and chunks.

use std::time::Duration;

use franka_rt::session::{GoalId, OnArrival, OnTimeout, Target, Watchdog};
use rand::Rng;

use super::super::draw;
use super::super::submission::{Submission, Work};
use super::Sessions;

impl Sessions<'_> {
    /// Moves the target of a held goal at a random rate, and then may stop doing so.
    pub(super) fn stream(&mut self) {
        if self.held().is_none() {
            let target = draw::pose(&mut self.random, &self.lockstep.arm_pose(), 0.02, 0.05);
            self.submit(target, OnArrival::Hold);
        }
        let Some(id) = self.held() else {
            return;
        };
        let most = self.random.random_range(2..60);
        for _ in 0..self.random.random_range(2..30) {
            let target = if self.random.random_bool(0.8) {
                let here = self.lockstep.reference_pose();
                draw::pose(&mut self.random, &here, 0.03, 0.1)
            } else {
                Target::Joints(draw::joints(&mut self.random, 0.15))
            };
            let now = self.lockstep.now();
            let updated = self.lockstep.update(id, target);
            let submission = self.open.iter_mut().find(|submission| submission.id == id);
            match (updated, submission) {
                (Ok(true), Some(submission)) => {
                    submission.work = Work::Goal(target);
                    submission.heard.push(now);
                }
                (Ok(false), submission) => {
                    let told = self.lockstep.client.outcome(id).is_some();
                    let lost = |submission: &mut Submission| {
                        told || submission.cancelled || self.causes.any()
                    };
                    assert!(submission.is_none_or(lost), "it is followed");
                    return;
                }
                (Ok(true), None) => panic!("the goal was resolved before"),
                (Err(_), _) => {}
            }
            let pause = self.random.random_range(1..most);
            self.run(pause);
        }
    }

    /// The newest goal, if it is held and still open.
    pub(super) fn held(&self) -> Option<GoalId> {
        let current = self.session.as_ref()?.current?;
        let submission = self
            .open
            .iter()
            .find(|submission| submission.id == current)?;
        let guided = matches!(submission.work, Work::Goal(Target::Guide(_)) | Work::Chunks);
        (submission.on_arrival == OnArrival::Hold && !submission.cancelled && !guided)
            .then_some(current)
    }

    /// Sends successive chunks, like a policy: most arrive before the previous one has ended.
    pub(super) fn chunk(&mut self) {
        for _ in 0..self.random.random_range(1..6) {
            let Some(session) = &self.session else {
                return;
            };
            let id = session.id;
            let (q, pose) = (
                self.lockstep.client.record.q_ref,
                self.lockstep.reference_pose(),
            );
            let now = self.lockstep.client.state.message_id;
            let chunk = draw::chunk(&mut self.random, &q, &pose, now);
            let mut goal = self.lockstep.goal(chunk.target(), OnArrival::Hold);
            goal.budget = self.budget();
            if self.random.random_bool(0.3) {
                goal.watchdog = Some(self.watchdog());
            }
            let before = self.session.as_ref().and_then(|session| session.current);
            let taken = self.lockstep.submit_chunk(id, goal, chunk);
            let heard = self.lockstep.now();
            let goes_on = self.open.iter_mut().find(|submission| {
                Some(submission.id) == before
                    && submission.work == Work::Chunks
                    && !submission.cancelled
            });
            match (goes_on, &taken) {
                (Some(submission), Ok(_)) => {
                    submission.heard.push(heard);
                    self.chunks.push(goal.id);
                }
                _ => {
                    self.note(goal, Work::Chunks, false, taken);
                }
            }
            let pause = self.random.random_range(1..150);
            self.run(pause);
        }
    }

    pub(super) fn watchdog(&mut self) -> Watchdog {
        Watchdog {
            silence: Duration::from_millis(self.random.random_range(20..200)),
            on_timeout: [OnTimeout::Hold, OnTimeout::Brake][self.random.random_range(0..2)],
        }
    }
}

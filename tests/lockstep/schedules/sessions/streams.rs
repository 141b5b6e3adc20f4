//! Goals that are fed: targets that move, and chunks.

use std::time::Duration;

use franka_rt::session::{GoalId, OnArrival, OnTimeout, Target, Watchdog};
use rand::Rng;

use super::super::draw;
use super::super::given::{Given, Work};
use super::Sessions;

impl Sessions<'_> {
    /// Moves the target of a goal that is held, at a random rate, and then perhaps never again.
    pub(super) fn stream(&mut self) {
        if self.held().is_none() {
            let target = draw::pose(&mut self.random, &self.lockstep.true_pose(), 0.02, 0.05);
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
            let given = self.open.iter_mut().find(|given| given.id == id);
            match (updated, given) {
                (Ok(true), Some(given)) => {
                    given.work = Work::Goal(target);
                    given.heard = now;
                }
                (Ok(false), given) => {
                    let told = self.lockstep.client.outcome(id).is_some();
                    let lost = |given: &mut Given| told || given.cancelled || self.causes.any();
                    assert!(given.is_none_or(lost), "it is followed");
                    return;
                }
                (Ok(true), None) => panic!("nobody is told twice"),
                (Err(_), _) => {}
            }
            let pause = self.random.random_range(1..most);
            self.run(pause);
        }
    }

    /// The newest goal, if it is held and still open.
    pub(super) fn held(&self) -> Option<GoalId> {
        let current = self.session.as_ref()?.current?;
        let given = self.open.iter().find(|given| given.id == current)?;
        let guided = matches!(given.work, Work::Goal(Target::Guide(_)) | Work::Chunks);
        (given.on_arrival == OnArrival::Hold && !given.cancelled && !guided).then_some(current)
    }

    /// Some chunks one after the other, as of a policy: most come before the one before them has
    /// ended.
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
            let goes_on = self.open.iter_mut().find(|given| {
                Some(given.id) == before && given.work == Work::Chunks && !given.cancelled
            });
            match (goes_on, &taken) {
                (Some(given), Ok(_)) => {
                    given.heard = heard;
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

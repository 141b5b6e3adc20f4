//! The end of a session, the end of a schedule, and the recovery from a reflex.

use franka_lockstep::Link;
use franka_model::READY;
use franka_proto::{Request, RobotMode};
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{GoalId, Lapse, OnArrival, Target};
use rand::Rng;

use super::super::submission::{Submission, Work};
use super::{REFLEX_MAX, SETTLING, STOP_MAX, Sessions, TIME_MAX};

impl Sessions<'_> {
    /// Ends the session in a random way.
    pub(super) fn end(&mut self) {
        let Some(session) = &mut self.session else {
            return;
        };
        let (id, over) = (session.id, session.over);
        let way = self.random.random_range(0..3);
        session.over = true;
        if way == 2 {
            self.end_by_stop();
            return;
        }
        if !over {
            for submission in &mut self.open {
                submission.released = true;
                submission.stopped |= submission.id != id;
            }
        }
        match way {
            0 => self.lockstep.disengage(id),
            _ => self.lockstep.cancel(id),
        }
    }

    /// Stops any activity of the robot, and returns the stop if there is one.
    pub(super) fn end_by_stop(&mut self) -> Option<GoalId> {
        let now = self.lockstep.now();
        let stop = self.lockstep.stop()?;
        for submission in &mut self.open {
            submission.stopped = true;
        }
        let on_arrival = OnArrival::ReportAndFinish;
        self.add(Submission::new(stop, Work::Stop, on_arrival, now));
        Some(stop)
    }

    /// Stops the robot, and checks that the arm stops in time and stays there.
    pub(super) fn stop_and_rest(&mut self) {
        let begin = self.lockstep.now();
        let stop = self.end_by_stop();
        if let Some(session) = &mut self.session {
            session.over = true;
        }
        while !self.lockstep.client.lifecycle.is_idle() {
            self.tick();
            let waited = self.lockstep.now() - begin;
            assert!(waited < STOP_MAX, "{:?}", self.lockstep.client.lifecycle);
        }
        self.counts.longest_stop = self.counts.longest_stop.max(self.lockstep.now() - begin);
        let outcome = stop.and_then(|stop| self.lockstep.client.outcome(stop).cloned());
        if !matches!(outcome, Some(Ok(_))) {
            // The robot has stopped itself, and still brakes.
            self.run(REFLEX_MAX);
        }
        let q = *self.lockstep.robot.q();
        for _ in 0..300 {
            self.tick();
            let idle = self.lockstep.client.driver.is_watching();
            assert!(idle, "a motion runs that nothing has requested");
        }
        let moved = (self.lockstep.robot.q() - q).amax();
        assert!(
            moved < SETTLING,
            "after {outcome:?} the arm moved on by {moved} rad"
        );
        if self.lockstep.client.state.robot_mode == RobotMode::Reflex {
            self.recover();
        }
    }

    /// Runs until everything has ended, and checks it.
    pub(super) fn finish(&mut self) {
        self.lockstep.robot.press_user_stop(false);
        if self.random.random_bool(0.8) {
            self.end();
        }
        let begin = self.lockstep.now();
        while !self.lockstep.client.lifecycle.is_idle() {
            let waited = self.lockstep.now() - begin;
            // A session that has not ended yet is ended here.
            if waited == 1000 {
                self.end_by_stop();
            }
            assert!(waited < TIME_MAX, "{:?}", self.lockstep.client.lifecycle);
            self.tick();
        }
        self.tick();
        assert!(self.open.is_empty(), "{:?}", self.open);
        let late = |id: &&GoalId| self.lockstep.client.outcome(**id).is_some();
        let late = self.chunks.iter().filter(late).count();
        assert_eq!(self.submitted + late, self.lockstep.client.resolved());
        self.lockstep.robot.let_go();
        self.lockstep.link = Link::perfect();
        self.run(400);
        let dq = self.lockstep.robot.dq();
        assert!(dq.amax() < 0.02, "the arm still moves: {dq}");
        assert!(self.lockstep.client.driver.is_watching());
        // After any event the next motion works.
        let stopped_itself = self.lockstep.client.state.robot_mode != RobotMode::Idle;
        if stopped_itself {
            assert!(!self.calm);
            self.recover();
        }
        if stopped_itself || self.random.random_bool(0.2) {
            let again = self.lockstep.begin(Target::Joints(READY.into()));
            let outcome = self.lockstep.until_resolved(again, TIME_MAX);
            // An arm that was pushed into itself may find no path from there.
            let is_blocked = matches!(outcome, Err(MotionError::Braked(Lapse::Blocked { .. })));
            let pushed_together = self.causes.pushed() && is_blocked;
            assert!(outcome.is_ok() || pushed_together, "{outcome:?}");
        }
        self.counts.robot_time += self.lockstep.now();
    }

    pub(super) fn recover(&mut self) {
        self.lockstep.request(&Request::AutomaticErrorRecovery);
        let begin = self.lockstep.now();
        while self.lockstep.client.state.robot_mode != RobotMode::Idle {
            self.tick();
            assert!(self.lockstep.now() < begin + 2000, "it recovers");
        }
    }
}

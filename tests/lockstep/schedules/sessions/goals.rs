//! Goals that are submitted, changed and cancelled.

use franka_lockstep::set_in_motion;
use franka_rt::lifecycle::{MotionError, NewMotion, Tuning};
use franka_rt::session::{
    Backend, Budget, ForceCap, Free, Goal, GoalId, Lapse, OnArrival, Target, Tolerance, Waypoint,
};
use rand::Rng;

use super::super::draw;
use super::super::submission::{Submission, Work};
use super::{Sessions, TIME_MAX};

impl Sessions<'_> {
    /// Submits a goal of any kind to the session.
    pub(super) fn give(&mut self) {
        let backend = self.session.as_ref().map(|session| session.backend);
        let kinds = match backend {
            Some(Backend::RobotController { .. }) => 8,
            _ => 10,
        };
        let target = match self.random.random_range(0..kinds) {
            0..=3 => draw::pose(&mut self.random, &self.home, 0.1, 0.3),
            4 => Target::Rest,
            5..=7 => Target::Joints(draw::joints(&mut self.random, 0.3)),
            _ => Target::Guide(Free {
                axes: core::array::from_fn(|_| self.random.random_bool(0.5)),
                elbow: self.random.random_bool(0.5),
            }),
        };
        let on_arrival = match self.random.random_range(0..20) {
            0 if !matches!(target, Target::Guide(_)) => OnArrival::ReportAndFinish,
            1..=9 if !matches!(target, Target::Guide(_)) => OnArrival::ReportAndHold,
            _ => OnArrival::Hold,
        };
        self.submit(target, on_arrival);
    }

    /// Goes through some places, rounded or with a stop at each.
    pub(super) fn go_through(&mut self) {
        let Some(session) = &self.session else {
            return;
        };
        let (id, joints) = (session.id, session.backend == Backend::Torques);
        let joints = joints && self.random.random_bool(0.5);
        let waypoints: Vec<Waypoint> = (0..self.random.random_range(1..5))
            .map(|_| {
                let target = if joints {
                    Target::Joints(draw::joints(&mut self.random, 0.3))
                } else {
                    draw::pose(&mut self.random, &self.home, 0.1, 0.3)
                };
                let blend = [0.0, 0.02, 0.1][self.random.random_range(0..3)];
                Waypoint::new(target).blend(blend)
            })
            .collect();
        let last = waypoints.last().map_or(Target::Rest, |last| *last.target());
        let on_arrival = match self.random.random_range(0..20) {
            0 => OnArrival::ReportAndFinish,
            _ => OnArrival::ReportAndHold,
        };
        let mut goal = self.lockstep.goal(last, on_arrival);
        goal.budget = self.budget();
        let motion = NewMotion::Goal {
            goal: Box::new(goal),
            path: None,
            ticket: None,
            session: Some(id),
        };
        let taken = self.lockstep.client.begin_along(&waypoints, motion);
        self.note(goal, Work::Goal(last), false, taken);
    }

    /// Submits a goal with random options. Returns true if it was accepted.
    pub(super) fn submit(&mut self, target: Target, on_arrival: OnArrival) -> bool {
        let mut goal = self.lockstep.goal(target, on_arrival);
        goal.budget = self.budget();
        let mut soft = false;
        if !matches!(target, Target::Guide(_)) && self.random.random_bool(0.3) {
            goal.gains = draw::gains(&mut self.random);
            soft = true;
        }
        if self.random.random_bool(0.2) {
            goal.force_cap = ForceCap::Newtons(self.random.random_range(10.0..100.0));
            soft = true;
        }
        // Guiding gets no stream of targets.
        let streams = on_arrival == OnArrival::Hold && !matches!(target, Target::Guide(_));
        if streams && self.random.random_bool(0.5) {
            goal.watchdog = Some(self.watchdog());
        }
        if on_arrival == OnArrival::Hold && self.random.random_bool(0.3) {
            goal.target = set_in_motion(target, &mut self.random);
            goal.paused = self.random.random_bool(0.1);
        }
        let Some(session) = &self.session else {
            return false;
        };
        let poses = session.backend.is_cartesian();
        let reaction = draw::reaction(&mut self.random, &self.home, poses);
        // A paused goal that has reacted waits until it is resumed, which never happens here.
        goal.reaction = reaction.filter(|_| !goal.paused);
        let taken = self.lockstep.submit_within(session.id, goal);
        self.note(goal, Work::Goal(target), soft, taken)
    }

    /// Records a submitted goal.
    pub(super) fn note(
        &mut self,
        goal: Goal,
        work: Work,
        soft: bool,
        taken: Result<GoalId, MotionError>,
    ) -> bool {
        let now = self.lockstep.now();
        let causes = self.causes.any();
        let Some(session) = &mut self.session else {
            return false;
        };
        match taken {
            Ok(id) => {
                assert!(!session.over, "no goal is taken after the last");
                session.over = goal.on_arrival == OnArrival::ReportAndFinish;
                let before = session.current.replace(id);
                let current = session.id;
                for submission in &mut self.open {
                    if Some(submission.id) == before {
                        submission.superseded = true;
                        let told = self.lockstep.client.outcome(submission.id).is_some();
                        // All goals of a session that is ending get its outcome.
                        assert!(told || causes, "{submission:?} is superseded");
                    }
                    if submission.id == current && goal.on_arrival == OnArrival::ReportAndFinish {
                        submission.finishing = true;
                        submission.soft |= soft;
                    }
                }
                let mut submission = Submission::new(id, work, goal.on_arrival, now);
                submission.watchdog = goal.watchdog;
                submission.reaction = goal.reaction.map(|reaction| reaction.then);
                submission.soft = soft;
                if let Backend::RobotController { controller, .. } = session.backend {
                    submission.tolerance = Tolerance::under(controller);
                }
                self.add(submission);
                true
            }
            // From the arm's position, the search may find no path to a pose.
            Err(MotionError::Goal(_) | MotionError::Path(_)) => false,
            Err(error) => {
                let ended = self.lockstep.client.outcome(session.id);
                let of_session = |it: &&Submission| it.id == session.id;
                let silent = self
                    .open
                    .iter()
                    .find(of_session)
                    .is_some_and(|it| it.deadman);
                let fits = match ended {
                    Some(Err(ended)) => error == *ended,
                    Some(Ok(_)) => error == MotionError::Disengaged,
                    None if error == MotionError::Held(Lapse::Deadman) => silent,
                    None => session.over && error == MotionError::Disengaged,
                };
                assert!(fits, "{error:?} of a session that ended as {ended:?}");
                // A deadman that is kept alive again lets the session continue.
                session.over |= ended.is_some() || error != MotionError::Held(Lapse::Deadman);
                false
            }
        }
    }

    pub(super) fn budget(&mut self) -> Budget {
        let goal = self.lockstep.goal(Target::Rest, OnArrival::Hold);
        let speeds = [0.3, 0.6, 1.0, 1.0, 1.4, 1.7];
        goal.budget
            .scaled(speeds[self.random.random_range(0..speeds.len())])
    }

    pub(super) fn tune(&mut self) {
        let Some(session) = &self.session else {
            return;
        };
        let id = session.id;
        let tuning = Tuning {
            gains: self
                .random
                .random_bool(0.7)
                .then(|| draw::gains(&mut self.random)),
            leash: draw::leash(&mut self.random),
            posture: draw::posture(&mut self.random, &self.lockstep.client.record.q),
            ..Tuning::default()
        };
        let budget = self.random.random_bool(0.5).then(|| self.budget());
        let tuned = self.lockstep.tune(id, Tuning { budget, ..tuning });
        match tuned {
            Ok(()) => {
                for submission in &mut self.open {
                    submission.soft = true;
                }
            }
            Err(MotionError::Goal(_)) => {}
            Err(error) => {
                let over = self.session.as_ref().is_some_and(|session| session.over);
                let ended = self.lockstep.client.outcome(id).is_some();
                assert!(over || ended, "{error:?}");
            }
        }
    }

    pub(super) fn cancel(&mut self) {
        let sessions =
            |submission: &&mut Submission| matches!(submission.work, Work::Goal(_) | Work::Chunks);
        if let Some(submission) = self.open.iter_mut().rev().find(sessions) {
            submission.cancelled = true;
            let id = submission.id;
            self.lockstep.cancel(id);
        }
    }

    pub(super) fn close(&mut self) {
        if let Some(id) = self.held() {
            self.lockstep.client.lifecycle.close(id);
            let submission = self.open.iter_mut().find(|submission| submission.id == id);
            submission.expect("it is open").on_arrival = OnArrival::ReportAndHold;
        }
    }

    /// Runs until the newest goal is resolved, if it has an end.
    pub(super) fn wait(&mut self) {
        let Some(current) = self.session.as_ref().and_then(|session| session.current) else {
            return;
        };
        let begin = self.lockstep.now();
        let ends = |submission: &Submission| {
            let watched = submission.watchdog.is_some() && submission.on_arrival == OnArrival::Hold;
            submission.id == current
                && (submission.on_arrival != OnArrival::Hold || submission.cancelled || watched)
        };
        while self.open.iter().any(ends) {
            self.run(1);
            let waited = self.lockstep.now() - begin;
            assert!(waited < TIME_MAX, "{:?}", self.lockstep.client.lifecycle);
        }
    }
}

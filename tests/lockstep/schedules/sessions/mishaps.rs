//! Disturbances of a session from outside.

use franka_model::Wrench;
use franka_proto::RobotError;
use franka_rt::driver::Activity;
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{Backend, OnArrival, Target};
use nalgebra::Vector3;
use rand::Rng;

use super::Sessions;

impl Sessions<'_> {
    /// Stops feeding the deadman for a while, or drops it.
    pub(super) fn fall_silent(&mut self) {
        let now = self.lockstep.now();
        let pause = self.random.random_range(20..300);
        let for_good = self.random.random_bool(0.1);
        let Some(feed) = self
            .session
            .as_mut()
            .and_then(|session| session.deadman.as_mut())
        else {
            return;
        };
        feed.silent = now + pause;
        if for_good {
            feed.token = None;
        }
        self.run(pause);
    }

    /// Submits a motion from another handle.
    pub(super) fn interfere(&mut self) {
        let goal = self.lockstep.goal(Target::Rest, OnArrival::ReportAndFinish);
        let Some(session) = self.session.as_ref().filter(|session| !session.over) else {
            return;
        };
        let id = session.id;
        let of_it = self.open.iter().find(|submission| submission.id == id);
        let ended = self.lockstep.client.outcome(id).is_some();
        // While a session is ending, other motions may wait for the arm.
        if ended || of_it.is_none_or(|submission| submission.released || submission.stopped) {
            return;
        }
        match self.lockstep.submit(goal) {
            Ok(waiting) => {
                // By the robot: its answer has come, the states that show it have not.
                assert!(self.causes.any(), "the session goes on");
                self.lockstep.cancel(waiting);
                let told = |it: &Self| it.lockstep.client.outcome(id).is_some();
                let ended = (0..100).any(|_| {
                    self.tick();
                    told(self)
                });
                assert!(ended, "the session is ending");
                // Resolved like the motions of the schedule.
                self.submitted += 1;
            }
            refused => assert_eq!(refused, Err(MotionError::Busy)),
        }
    }

    pub(super) fn lose(&mut self) {
        if self.lockstep.client.record.activity != Activity::Running {
            return;
        }
        let count = match self.random.random_range(0..4) {
            0 => self.random.random_range(18..30),
            _ => self.random.random_range(1..17),
        };
        self.causes.lose(self.lockstep.now(), count);
        if self.random.random_bool(0.5) {
            self.lockstep.link.drop_states(count);
        } else {
            self.lockstep.link.drop_commands(count);
        }
    }

    /// Pushes the arm, only under our own torques: the stiffness of the robot's own controller is
    /// not tested here.
    pub(super) fn push(&mut self) {
        let ours = self
            .session
            .as_ref()
            .is_some_and(|session| session.backend == Backend::Torques);
        if !ours || self.lockstep.client.record.activity != Activity::Running {
            return;
        }
        self.causes.push();
        let force = Vector3::from_fn(|_, _| self.random.random_range(-25.0..25.0));
        let duration = self.random.random_range(20..400);
        let wrench = Wrench::new(force.x, force.y, force.z, 0.0, 0.0, 0.0);
        self.lockstep.robot.push_end_effector(wrench, duration);
    }

    pub(super) fn trip(&mut self) {
        let error = RobotError::CartesianReflex;
        self.causes.trip(error);
        self.lockstep.robot.trip(error);
    }

    pub(super) fn press_user_stop(&mut self) {
        self.causes.stopped = true;
        self.lockstep.robot.press_user_stop(true);
        let pause = self.random.random_range(1..300);
        self.run(pause);
        self.lockstep.robot.press_user_stop(false);
    }
}

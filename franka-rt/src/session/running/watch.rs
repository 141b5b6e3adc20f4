//! The guards that move a goal's target closer, or give up the goal: lead, deviation, speed cap,
//! unresponsive arm, watchdog and deadman.

use core::time::Duration;

use franka_model::{JointVector, Model};

use super::goals::Bearing;
use super::{Drive, GoalStage, RunningSession, Standing};
use crate::session::course::Course;
use crate::session::geometry::LEVER;
use crate::session::guard::lead::Lead;
use crate::session::{Lapse, OnArrival, OnTimeout, PoseError, Target};
use crate::team::TeamStop;

impl RunningSession {
    /// If the target is too far ahead of the arm, moves it closer. Returns true if it was moved.
    pub(super) fn draw_nearer(&mut self, now: u64) -> bool {
        let Some(lead) = self.goal.lead else {
            return false;
        };
        let chunks = self.goal.along_path
            || matches!(self.route.course, Course::Chunk(_))
            || self.route.chunk_end.is_some();
        if chunks || self.has_reacted() || !matches!(self.stage, GoalStage::UnderWay) {
            return false;
        }
        if now.saturating_sub(self.heard) <= Lead::FRESH_MS {
            let since = now.saturating_sub(self.heard);
            let place = self.goal.target.after(since).place();
            let drawn = lead.drawn(&place, &self.arm.q, &self.arm.object);
            let target = drawn.unwrap_or(self.goal.target);
            if target != self.aim.target() {
                self.turn_to(target);
            }
        }
        self.aim.target() != self.goal.target
    }

    /// Halts if the target no longer counts as moving, because it got no update for too long or was
    /// given up.
    pub(super) fn halt_without_news(&mut self, now: u64) {
        let silent = now.saturating_sub(self.heard) >= Target::MOVES_ON_MS;
        if let Bearing::Followed(target) = self.aim
            && target.moves()
            && (silent || self.is_given_up())
        {
            self.aim = Bearing::Halted(target);
            self.route.outdate();
        }
    }

    pub(super) fn give_up(&mut self, lapse: Lapse) {
        self.goal = self.goal.at_rest(self.goal.on_arrival);
        self.fade();
        self.set_out();
        self.lapse(OnTimeout::Brake, lapse);
    }

    /// True if the goal was given up or has reacted, and neither an update nor a chunk can resume
    /// it.
    pub(super) fn is_given_up_for_good(&self) -> bool {
        let settled = matches!(self.stage, GoalStage::Staying) || self.stage.lets_go();
        match self.standing {
            Standing::GivenUp { cause, .. } => settled || cause.is_final(),
            Standing::Reacted(_) => true,
            Standing::InForce | Standing::TakenBack => false,
        }
    }

    /// True if the goal was given up, for good or until the next update.
    pub(super) fn is_given_up(&self) -> bool {
        matches!(self.standing, Standing::GivenUp { .. })
    }

    /// Gives up the goal for `cause`. `action` decides if the arm holds the last target or brakes.
    fn lapse(&mut self, action: OnTimeout, cause: Lapse) {
        if self.goal.on_arrival == OnArrival::Hold {
            self.goal.on_arrival = self.afterwards;
        }
        let reacted = self.reacted();
        self.standing = Standing::GivenUp {
            action,
            cause,
            reacted,
        };
    }

    /// Gives up the goal if the arm was pushed off its path. Returns true if so.
    pub(super) fn watch_deviation(&mut self, model: &Model, leashed: bool) -> bool {
        if !leashed {
            self.displacement.set_free(&self.reference.q);
            return false;
        }
        if matches!(self.heading(), Target::Rest | Target::Guide(_)) {
            return matches!(
                self.standing,
                Standing::GivenUp {
                    cause: Lapse::Displaced,
                    ..
                }
            );
        }
        let arm = &self.arm;
        let aim = self.aim(model, arm.time).target.place();
        let most = &self.goal.deviation;
        let exceeded =
            self.displacement
                .is_exceeded(model, &self.ee, &arm.q, &arm.object, &aim, most);
        let follows = matches!(
            self.stage,
            GoalStage::UnderWay | GoalStage::Landing(_) | GoalStage::Staying
        );
        if exceeded && follows {
            self.give_up(Lapse::Displaced);
        }
        exceeded
    }

    /// Records whether the leash or the `course` itself holds the goal back.
    pub(super) fn watch_progress(&mut self, leashed: bool, course: bool, now: u64) {
        let held = leashed || course || self.lags || self.route.hindrance().is_some();
        match held {
            true => self.progress.hold(self.distance(now), leashed, now),
            false => self.progress.release(now),
        }
    }

    /// Returns the distance of the measured position from the target, in any unit; infinite for a
    /// target without a place. A chunk has its remaining time instead, since its points may lead
    /// away from its end.
    fn distance(&self, now: u64) -> f64 {
        let arm = &self.arm;
        match (&self.route.course, self.heading()) {
            (Course::Chunk(chunk), _) => chunk.remaining(now),
            (_, Target::Pose(there)) => {
                let off = PoseError::between(&arm.object, &there);
                off.translation + LEVER * off.rotation
            }
            (_, Target::Joints(q)) => (JointVector::from(q) - arm.q).amax(),
            _ => f64::INFINITY,
        }
    }

    /// Gives up the goal if the arm moved faster than the cap. Returns true if it did.
    pub(super) fn watch_speed(&mut self, model: &Model) -> bool {
        let arm = &self.arm;
        let fastest = || model.fastest_point(&arm.q, &arm.dq, &self.hand);
        let too_fast = self.speed_cap.is_some_and(|cap| fastest() > cap);
        let over = self.stage.lets_go();
        if too_fast && !over && self.heading() != Target::Rest {
            self.give_up(Lapse::TooFast);
        }
        too_fast
    }

    /// Gives up the goal if the arm ignores its commands. Returns true if so.
    pub(super) fn watch_response(&mut self) -> bool {
        let over = self.stage.lets_go();
        if self.ignores && !over && !self.is_given_up() && self.heading() != Target::Rest {
            self.give_up(Lapse::Unresponsive);
            // A robot that refuses setpoints keeps its own setpoint, and a reference that follows
            // that setpoint does not move.
            if !self.response.refuses() {
                self.return_to_arm();
            }
        }
        self.ignores
    }

    /// Moves the reference back to the arm if it is ahead of an arm that stands still. Otherwise
    /// the arm would leap when it can move again.
    fn return_to_arm(&mut self) {
        if (self.reference.q - self.arm.q).amax() < NEAR {
            return;
        }
        let back = match &self.drive {
            Drive::Setpoints(stream) if stream.is_cartesian() => Target::Pose(self.arm.object),
            Drive::Setpoints(_) | Drive::Torques(_) => Target::Joints(self.arm.q.into()),
        };
        self.goal.target = back;
        self.turn_to(back);
    }

    /// Gives up the goal if the team has just stopped and the arm is on its way to a target. A goal
    /// that was given up before keeps its own cause.
    pub(super) fn stop_with_team(&mut self, stop: Option<TeamStop>) {
        let over = self.stage.lets_go();
        if let Some(stop) = stop
            && !over
            && self.heading() != Target::Rest
        {
            self.give_up(Lapse::Team(stop));
        }
    }

    /// True if the goal was given up because the team has stopped.
    pub(super) fn has_stopped_with_team(&self) -> bool {
        matches!(
            self.standing,
            Standing::GivenUp {
                cause: Lapse::Team(_),
                ..
            }
        )
    }

    /// True if the goal was given up and the arm is braking, or has braked, for that reason.
    pub(in crate::session) fn has_braked(&self) -> bool {
        matches!(
            self.standing,
            Standing::GivenUp {
                action: OnTimeout::Brake,
                ..
            }
        )
    }

    /// Gives up the goal if its updates stop arriving or if its deadman is silent.
    pub(super) fn watch(&mut self, alive: bool, now: u64) {
        let braked = self.has_braked();
        // A goal that stops the arm needs no deadman.
        let comes_to_rest =
            self.heading() == Target::Rest && self.goal.on_arrival != OnArrival::Hold;
        if braked || comes_to_rest || self.stage.lets_go() {
            return;
        }
        if !alive {
            return self.give_up(Lapse::Deadman);
        }
        let silence = Duration::from_millis(now.saturating_sub(self.heard));
        if let Some(watchdog) = self.goal.watchdog
            && self.goal.on_arrival == OnArrival::Hold
            && silence >= watchdog.silence
        {
            let silent = Lapse::Silent { silence };
            match (watchdog.on_timeout, self.goal.target) {
                // Guiding has no target that could be held, so the arm brakes.
                (OnTimeout::Brake, _) | (_, Target::Guide(_)) => self.give_up(silent),
                (OnTimeout::Hold, _) => self.lapse(OnTimeout::Hold, silent),
            }
        }
    }
}

/// Distance from the reference within which an arm that can move again does not leap, `[rad]`.
const NEAR: f64 = 2e-3;

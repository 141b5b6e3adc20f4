//! Goals of a session: how they begin and are tuned, and the aim that follows from them.

use franka_model::Model;

use super::progress::Progress;
use super::react::Reacting;
use super::{Drive, GoalStage, RunningSession, Standing, carry};
use crate::session::aim::Aim;
use crate::session::{Budget, Goal, OnArrival, Target};

#[derive(Clone, Copy, Debug)]
pub(super) enum Bearing {
    /// The reference moves to this target.
    Followed(Target),
    /// A moving target that got no update for too long. The reference halts on its way.
    Halted(Target),
}

impl Bearing {
    pub(super) fn target(self) -> Target {
        match self {
            Self::Followed(target) | Self::Halted(target) => target,
        }
    }
}

impl RunningSession {
    /// Accepts a goal that was read from the slot: tunes the current goal, or replaces it and plans
    /// anew.
    pub(super) fn take_up(&mut self, goal: &Goal, now: u64) {
        if matches!(self.stage, GoalStage::Restless | GoalStage::Finished(_)) {
            return;
        }
        let named = goal.id == self.goal.id;
        let taken_back = goal.target == Target::Rest && goal.on_arrival != OnArrival::Hold;
        // Tuning does not change the revision.
        let tuned = goal.revision == self.goal.revision;
        // The caller has not yet seen the abort or the reaction, so the target of its update is
        // ignored.
        let aborted = !taken_back && self.is_given_up_for_good();
        if named && (tuned || aborted) {
            return self.tune(goal);
        }
        self.heard = now;
        let same = named
            && !self.is_given_up()
            && goal.target == self.goal.target
            && !goal.target.moves()
            && goal.on_arrival == self.goal.on_arrival;
        if same && !matches!(self.stage, GoalStage::Releasing(_)) {
            return self.tune(goal);
        }
        if !named {
            self.since = now;
            self.reacting = Reacting::to(goal, now);
            self.renew_correction();
        }
        self.goal = *goal;
        self.take_hold();
        self.fade();
        self.standing = if named && taken_back {
            Standing::TakenBack
        } else {
            Standing::InForce
        };
        self.set_out();
    }

    /// Keeps the target, but takes budget, gains, tolerance and guards from `goal`. Gains for
    /// guiding are ignored, because they would release an arm that is already held.
    fn tune(&mut self, goal: &Goal) {
        let Goal {
            target, on_arrival, ..
        } = self.goal;
        let gains = match target {
            Target::Guide(_) => goal.gains,
            _ => goal.at_rest(on_arrival).gains,
        };
        let before = core::mem::replace(
            &mut self.goal,
            Goal {
                target,
                on_arrival,
                gains,
                ..*goal
            },
        );
        self.fade();
        let changed = goal.budget != before.budget || goal.paused != before.paused;
        if changed && !matches!(self.stage, GoalStage::Releasing(_)) {
            self.route.outdate();
        }
    }

    /// Starts the fade of gains, force cap and leash to the goal's values.
    pub(super) fn fade(&mut self) {
        self.leash.towards(self.goal.leash);
        if let Drive::Torques(effort) = &mut self.drive {
            effort.take_up(&self.goal);
        }
    }

    /// Starts the motion to the target of the goal, or along its path once the path has arrived.
    pub(super) fn set_out(&mut self) {
        self.stage = GoalStage::UnderWay;
        self.is_refined = false;
        self.progress = Progress::default();
        self.route.chunk_end = None;
        self.begin_line();
        self.turn_to(match self.goal.along_path {
            true => Target::Rest,
            false => self.goal.target,
        });
    }

    /// Ends the course, so that a new course is planned to `target`.
    pub(super) fn turn_to(&mut self, target: Target) {
        self.route.turn();
        self.aim = Bearing::Followed(target);
    }

    /// Returns the reference's target, at its place at the time `now`.
    pub(super) fn target_at(&self, now: u64) -> Target {
        let since = now.saturating_sub(self.heard).min(Target::MOVES_ON_MS);
        self.aim.target().after(since)
    }

    /// Returns the aim of the reference at `now`. After a reaction, the arm does not continue at
    /// the pace of a deliberately slow goal.
    pub(super) fn aim(&self, model: &Model, now: u64) -> Aim {
        let mut aim = Aim {
            goal: self.goal.id,
            target: self.target_at(now),
            budget: self.goal.budget,
            paused: match self.aim {
                // A stop cannot be paused.
                Bearing::Followed(Target::Rest) => false,
                Bearing::Followed(_) => self.goal.paused || self.waits,
                Bearing::Halted(_) => true,
            },
            leash: self.leash.now(),
        };
        if self.waits {
            aim.budget = carry::quick_to_halt(aim.budget);
        }
        if self.has_reacted() {
            let default = Budget::of(model.joint_limits());
            aim.budget = aim.budget.as_brisk_as(&default);
        }
        aim
    }
}

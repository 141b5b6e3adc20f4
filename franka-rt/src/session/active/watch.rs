//! Who watches over a goal: the lead of its target, the deviation of the arm, its watchdog and the
//! deadman.

use core::time::Duration;

use franka_model::Model;

use super::{Active, Measured, Stage};
use crate::session::course::Course;
use crate::session::guard::lead::LEAD_FRESH_MS;
use crate::session::{Lapse, OnArrival, OnTimeout, Target};

impl Active {
    /// Draws a target nearer that is too far ahead of the arm; tells whether it is.
    pub(super) fn draw_nearer(&mut self, model: &Model, arm: &Measured, now: u64) -> bool {
        let Some(lead) = self.goal.lead else {
            return false;
        };
        let chunks = matches!(self.route.course, Course::Chunk(_)) || self.chunk_end.is_some();
        if chunks || !matches!(self.stage, Stage::UnderWay) {
            return false;
        }
        if now.saturating_sub(self.heard) <= LEAD_FRESH_MS {
            let drawn = lead.drawn(&self.goal.target, &arm.q, &arm.pose);
            let target = drawn.unwrap_or(self.goal.target);
            if target != self.aim {
                self.turn_to(model, target);
            }
        }
        self.aim != self.goal.target
    }

    /// Gives the goal up, and brakes.
    pub(super) fn give_up(&mut self, model: &Model, lapse: Lapse) {
        self.goal = self.goal.at_rest(self.goal.on_arrival);
        self.fade_gains();
        self.set_out(model);
        self.lapse(OnTimeout::Brake, lapse);
    }

    /// Whether neither an update nor a chunk brings back a goal that was given up.
    pub(super) fn is_given_up_for_good(&self) -> bool {
        let settled = matches!(self.stage, Stage::Staying | Stage::Releasing(_));
        self.lapse
            .as_ref()
            .is_some_and(|(_, lapse)| settled || lapse.is_final())
    }

    /// Has the goal come to its end where the arm comes to rest.
    fn lapse(&mut self, on_timeout: OnTimeout, lapse: Lapse) {
        if self.goal.on_arrival == OnArrival::Hold {
            self.goal.on_arrival = self.afterwards;
        }
        self.lapse = Some((on_timeout, lapse));
    }

    /// Gives up a goal whose arm is being carried off; tells whether it is.
    pub(super) fn watch_deviation(&mut self, model: &Model, arm: &Measured, leashed: bool) -> bool {
        if !leashed {
            self.deviation.set_free(&self.reference.q);
            return false;
        }
        if matches!(self.heading(), Target::Rest | Target::Guide(_)) {
            return matches!(self.lapse, Some((_, Lapse::Displaced)));
        }
        let exceeded = self
            .deviation
            .is_exceeded(model, &self.ee, &arm.q, &arm.pose, &self.aim);
        let follows = matches!(
            self.stage,
            Stage::UnderWay | Stage::Landing(_) | Stage::Staying
        );
        if exceeded && follows {
            self.give_up(model, Lapse::Displaced);
        }
        exceeded
    }

    /// Gives the goal up: its updates stay away, or its deadman is silent.
    pub(super) fn watch(&mut self, model: &Model, alive: bool, now: u64) {
        let given_up = matches!(self.lapse, Some((OnTimeout::Brake, _)));
        // Whoever asks for rest gets it, with or without a deadman.
        let comes_to_rest =
            self.heading() == Target::Rest && self.goal.on_arrival != OnArrival::Hold;
        if given_up || comes_to_rest || matches!(self.stage, Stage::Releasing(_) | Stage::Finished)
        {
            return;
        }
        if !alive {
            return self.give_up(model, Lapse::Deadman);
        }
        let silence = Duration::from_millis(now.saturating_sub(self.heard));
        if let Some(watchdog) = self.goal.watchdog
            && self.goal.on_arrival == OnArrival::Hold
            && silence >= watchdog.silence
        {
            let silent = Lapse::Silent { silence };
            match (watchdog.on_timeout, self.goal.target) {
                // A hand leads to no last target.
                (OnTimeout::Brake, _) | (_, Target::Guide(_)) => self.give_up(model, silent),
                (OnTimeout::Hold, _) => self.lapse(OnTimeout::Hold, silent),
            }
        }
    }
}

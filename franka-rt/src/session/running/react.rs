//! Reaction of a session when the condition of its goal becomes true.

use core::time::Duration;

use franka_proto::RobotState;

use super::{GoalStage, RunningSession, Standing};
use crate::session::condition::{Observed, Watch};
use crate::session::{Goal, OnArrival, OnTimeout, Reacted, Reaction, Target};

#[derive(Debug)]
pub(super) struct Reacting {
    watch: Watch,
    then: Target,
    /// The newest state that was answered, until the condition has been checked in it.
    newest: Option<Observed>,
}

impl Reacting {
    /// Returns the reaction of a goal that begins with the state whose `message_id` is `since`.
    /// Returns `None` if the goal has no reaction.
    pub(super) fn to(goal: &Goal, since: u64) -> Option<Self> {
        let Reaction { condition, then } = goal.reaction?;
        Some(Self {
            watch: Watch::new(condition, since),
            then,
            newest: None,
        })
    }
}

impl RunningSession {
    /// Records the newest state, so that [`Self::react`] can check it after the answer.
    pub(super) fn observe(&mut self, state: &RobotState) {
        if let Some(reacting) = &mut self.reacting {
            reacting.newest = Some(Observed::of(state));
        }
    }

    /// Checks the condition in the newest state, in which `self.arm` was measured. If the condition
    /// is true, brakes, and makes the goal end at rest or at the other target.
    pub(super) fn react(&mut self) {
        let watched = self.is_watched();
        let Some(reacting) = &mut self.reacting else {
            return;
        };
        let Some(state) = reacting.newest.take() else {
            return;
        };
        let is_met = reacting.watch.is_met(&state, &self.arm);
        if !is_met || !watched {
            return;
        }
        let then = reacting.then;
        let reacted = Reacted {
            after: Duration::from_millis(self.arm.time.saturating_sub(self.since)),
            time: self.arm.time,
            wrench: state.wrench,
            pose: self.arm.as_reported(),
        };
        let on_arrival = match self.goal.on_arrival {
            OnArrival::Hold => self.afterwards,
            reporting => reporting,
        };
        self.goal = Goal {
            target: then,
            paused: self.goal.paused,
            ..self.goal.at_rest(on_arrival)
        };
        self.fade();
        self.set_out();
        self.line = None;
        self.turn_to(Target::Rest);
        self.standing = Standing::Reacted(reacted);
        self.yields = true;
        self.reacting = None;
    }

    /// True while the goal's condition still counts: until the goal is reported, cancelled or
    /// braked.
    fn is_watched(&self) -> bool {
        let pursued = match self.standing {
            Standing::InForce => true,
            Standing::GivenUp { action, .. } => action == OnTimeout::Hold,
            Standing::TakenBack | Standing::Reacted(_) => false,
        };
        pursued && matches!(self.stage, GoalStage::UnderWay | GoalStage::Landing(_))
    }

    /// True if the arm has braked for a reaction but has not yet moved to `heading`.
    pub(super) fn has_braked_before(&self, heading: &Target) -> bool {
        self.has_reacted() && self.aim.target() == Target::Rest && *heading != Target::Rest
    }

    /// Returns what was measured when the goal's condition became true, even if the goal was given
    /// up since.
    pub(super) fn reacted(&self) -> Option<Reacted> {
        match self.standing {
            Standing::Reacted(reacted) => Some(reacted),
            Standing::GivenUp { reacted, .. } => reacted,
            Standing::InForce | Standing::TakenBack => None,
        }
    }

    /// True if the goal's target was replaced because its condition became true.
    pub(super) fn has_reacted(&self) -> bool {
        matches!(self.standing, Standing::Reacted(_))
    }
}

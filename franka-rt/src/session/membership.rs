//! The part of a session in its team. It decides when goals may begin, when the arm must brake
//! because of another member, and when the other members must brake because of this arm.

use core::time::Duration;

use super::running::RunningSession;
use super::{Goal, GoalId, OnArrival, SessionEvent, Settlement, Target};
use crate::team::{Carrying, Member, MemberFault, Passage, Round, TeamStop};

/// The session's data about its team.
#[derive(Debug)]
pub(super) struct Membership {
    member: Member,
    /// A goal of a common motion (round) that has not begun.
    waiting: Option<(Round, Goal)>,
    /// The goal of a common motion that has begun.
    pursued: Option<Pursued>,
    /// True if the session has reported a fault to the team since the newest state.
    has_failed: bool,
    /// Progress with an object that the team carries, if there is one.
    carrying: Option<Carrying>,
}

#[derive(Clone, Copy, Debug)]
struct Pursued {
    round: Round,
    goal: GoalId,
    /// Target at which the arm is held after its goal ended as requested.
    held: Option<Target>,
}

/// Greatest distance by which the reference may be ahead of the other arms' references, `[m]`.
const AHEAD: f64 = 0.002;

impl Membership {
    pub(super) fn new(member: Member) -> Self {
        Self {
            member,
            waiting: None,
            pursued: None,
            has_failed: false,
            carrying: None,
        }
    }

    /// Returns the first goal of a session, or a goal that holds the arm if the first goal must
    /// wait.
    pub(super) fn first(&mut self, goal: Goal) -> Goal {
        let Some(round) = goal.round else {
            return goal;
        };
        self.waiting = Some((round, goal));
        Goal {
            id: GoalId::default(), // no goal's
            watchdog: None,        // No goal may expire before it begins.
            ..goal.at_rest(OnArrival::Hold)
        }
    }

    /// Returns the goal to begin while the state with `message_id` `now` is answered, and the
    /// team's stop. The stop is returned in the cycle that sees it, or that begins a goal of a
    /// stopped round.
    pub(super) fn admit(
        &mut self,
        newer: Option<Goal>,
        now: u64,
    ) -> (Option<Goal>, Option<TeamStop>) {
        self.has_failed = false;
        let mut stop = self.member.take_stop();
        let mut taken = newer.filter(|goal| !self.keeps(goal));
        if let Some((round, goal)) = self.waiting {
            match self.member.pass(round, now) {
                Passage::Waiting => return (taken, stop),
                Passage::Open => {
                    // The stop belongs to an older round. A stop of the team now would have stopped
                    // this round.
                    stop = None;
                    self.pursued = Some(Pursued {
                        round,
                        goal: goal.id,
                        held: None,
                    });
                }
                Passage::Stopped(reason) => {
                    // The arm also no longer pursues its goal of an older round.
                    self.pursued = None;
                    stop = Some(reason);
                }
            }
            self.waiting = None;
            taken = Some(goal);
        }
        (taken, stop)
    }

    /// Records a goal that was read from the slot. Returns true if the goal waits for the other
    /// members.
    fn keeps(&mut self, goal: &Goal) -> bool {
        // A goal of a round may also hold the arm.
        let comes_to_rest = goal.target == Target::Rest && goal.on_arrival != OnArrival::Hold;
        let taken_back = comes_to_rest && goal.round.is_none();
        if let Some((round, waiting)) = self.waiting
            && (waiting.id != goal.id || taken_back)
        {
            self.waiting = None;
            self.member.give_up(round, MemberFault::TakenBack);
        }
        if let Some(pursued) = &mut self.pursued {
            if pursued.goal == goal.id && !taken_back {
                return false;
            }
            // The goal was tuned while it is held, and has the session's id by now.
            let stays = pursued.held == Some(goal.target) && goal.round.is_none();
            if stays && !taken_back {
                pursued.goal = goal.id;
                return false;
            }
            // The member pursues its goal until all goals of the next round have arrived.
            let waits = goal.round.is_some_and(|next| next != pursued.round);
            if !waits {
                let Pursued { round, held, .. } = *pursued;
                self.pursued = None;
                if held.is_none() {
                    self.member.give_up(round, MemberFault::TakenBack);
                }
            }
        }
        let Some(round) = goal.round else {
            return false;
        };
        self.waiting = Some((round, *goal));
        true
    }

    /// True if the reference must wait for the arms that carry the same object, this arm included.
    pub(super) fn waits(&self) -> bool {
        let (Some(pursued), Some(own)) = (self.pursued, self.carrying) else {
            return false;
        };
        let others = self.member.others(pursued.round);
        own.lags || others.lags || others.remaining > own.remaining + AHEAD
    }

    /// Stops the common motion if its goal was given up. Reports the arm's progress to the other
    /// members.
    pub(super) fn watch(&mut self, session: &mut RunningSession) {
        self.carrying = session.carrying();
        if let (Some(pursued), Some(own)) = (self.pursued, self.carrying) {
            self.member.tell(pursued.round, own);
        }
        if let Some(pursued) = self.pursued
            && session.has_braked()
        {
            self.pursued = None;
            self.member.give_up(pursued.round, MemberFault::GivenUp);
        }
    }

    /// Records the end of a goal at this target. A goal that ended as requested stays part of its
    /// round, even if it is tuned. If it is given up later, the other members brake.
    pub(super) fn settle(&mut self, event: &SessionEvent, target: Target) {
        let (SessionEvent::Settled { settlement, .. }, Some(pursued)) = (event, &mut self.pursued)
        else {
            return;
        };
        let fault = match settlement {
            Settlement::Arrived(_) | Settlement::AtRest => {
                pursued.held = Some(target);
                return;
            }
            Settlement::TargetNotReached(_) => MemberFault::NotReached,
            Settlement::Held(_) | Settlement::Braked(_) | Settlement::Unstarted(_) => {
                MemberFault::GivenUp
            }
        };
        let round = pursued.round;
        self.pursued = None;
        self.member.give_up(round, fault);
    }

    /// Stops the team for a fault outside the goals, at most once for each state.
    pub(super) fn fail(&mut self, fault: MemberFault) {
        if !self.has_failed {
            self.has_failed = true;
            self.member.stop(fault);
        }
    }

    /// Stops the team if `silence` is too long.
    pub(super) fn on_silence(&mut self, silence: Duration) {
        if silence >= self.member.silence() {
            self.fail(MemberFault::Silent);
        }
    }

    /// Leaves the team without a fault.
    pub(super) fn leave(&mut self) {
        self.member.leave();
    }
}

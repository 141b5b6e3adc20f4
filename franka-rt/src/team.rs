//! Joint motions of several robots: they begin together, and a fault of one robot brakes the other
//! robots.
//!
//! ```text
//!  Coordinator::begin --> Round: one goal for each member
//!
//!              the last goal is taken up            a goal is given up, a robot stops, ...
//!   waiting ---------------------------------> open ---------------------------------> stopped
//!      |                                                                                  ^
//!      +----------------------------------------------------------------------------------+
//!         a goal is refused or taken back, a robot stops, a member has waited too long
//! ```
//!
//! A joint motion of a team is a *round*. The state of the newest round is one atomic word, which
//! every member loads once in each of its own cycles. A member that detects a fault writes it into
//! the word with a compare-and-exchange. No thread waits for another thread, and no async runtime
//! is involved. A member begins to brake within two of its cycles after the thread of the faulty
//! member has detected the fault. Only the first fault of a round counts. A newer round hides no
//! stop: a member that has not checked yet still sees the stop. A stop of the team also stops a
//! round that begins before all members have seen it.
//!
//! [`together`](crate::together) contains common starts of independent motions. In a team, a
//! session moves from goal to goal.

#[cfg(loom)]
use loom::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};
#[cfg(not(loom))]
use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

use core::num::NonZeroU32;
use core::time::Duration;

/// Largest number of members in a team.
pub const MEMBERS_MAX: usize = 254;

/// Default time for which a member's robot may be silent before the other members brake. A robot
/// that misses commands for this long stops on its own. Detection may take one wait of the member's
/// thread longer, up to 20 ms.
pub const SILENCE: Duration = Duration::from_millis(20);

/// Time for which a goal of a common motion waits for the goals of the other members, by the clock
/// of its robot. Meanwhile the driver holds the arm, or the previous motion continues.
pub const START_TIMEOUT: Duration = Duration::from_secs(10);

/// Identifies one round: a motion that all members of a team begin together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Round(NonZeroU32);

impl Round {
    pub(crate) fn to_word(round: Option<Self>) -> u64 {
        round.map_or(0, |round| round.0.get().into())
    }

    pub(crate) fn from_word(word: u64) -> Option<Self> {
        NonZeroU32::new(word as u32).map(Self)
    }
}

/// Reason why the members of a team brake. Members are counted from 0, in the order of the team.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum TeamStop {
    /// Caller: a program stopped the team.
    Requested,
    /// A member has a fault; its own motion reports the details.
    Member {
        /// Number of the member.
        member: usize,
        /// Fault of the member.
        fault: MemberFault,
    },
}

/// Fault of a member of a team.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum MemberFault {
    /// The member's robot ended the session because of a reflex, a user stop, or another client.
    RobotStopped,
    /// The member's robot was silent for longer than the team allows; by default [`SILENCE`].
    Silent,
    /// A command of the member could not be sent, so the robot was asked to stop.
    Failed,
    /// The member's session was dropped, because the control thread ended or panicked.
    Gone,
    /// The member's goal was given up. The arm was displaced or too fast, its path is blocked, or
    /// its deadman or its stream of targets is silent.
    GivenUp,
    /// The member's arm did not reach its target.
    NotReached,
    /// The member's motion was dropped, cancelled or stopped, or another goal replaced it.
    TakenBack,
    /// The member's goal was refused.
    Refused,
    /// The goals of the other members did not come in time.
    TimedOut,
}

impl core::fmt::Display for TeamStop {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Requested => write!(f, "the team was stopped on request"),
            Self::Member { member, fault } => write!(f, "member {member} of the team: {fault}"),
        }
    }
}

impl core::fmt::Display for MemberFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::RobotStopped => "its robot stopped itself",
            Self::Silent => "no states arrive from its robot",
            Self::Failed => "its command could not be sent",
            Self::Gone => "its session has ended",
            Self::GivenUp => "its goal was given up",
            Self::NotReached => "its target was not reached",
            Self::TakenBack => "its motion was cancelled",
            Self::Refused => "its goal was refused",
            Self::TimedOut => "it waited too long for the other members",
        })
    }
}

/// Begins and stops the common motions of a team, from any thread. Clones control the same team.
#[derive(Clone, Debug)]
pub struct Coordinator {
    shared: Arc<Shared>,
}

/// Progress of a member that carries an object together with its team.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Carrying {
    /// Distance that the member's reference still has to move, `[m]`, rotations included.
    pub remaining: f64,
    /// True if the member's arm lags behind its reference.
    pub lags: bool,
}

/// Membership of one session in a team. Dropping it is a fault, unless the member has left the
/// team.
#[derive(Debug)]
#[must_use = "dropping a member stops the team"]
pub struct Member {
    shared: Arc<Shared>,
    number: u8,
    /// Newest round that the member has joined, and the time when it joined, `[ms]` of its robot's
    /// clock.
    arrived: Option<(Round, u64)>,
    /// Newest stop that the member has seen.
    seen: Word,
    has_left: bool,
}

/// Decision whether the member may pursue a goal of a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passage {
    /// Not yet, because some members have no goal of the round.
    Waiting,
    /// The member may pursue the goal.
    Open,
    /// The member may not pursue the goal, for this reason.
    Stopped(TeamStop),
}

/// Returns a team of `N` members, one for each session.
pub fn team<const N: usize>() -> (Coordinator, [Member; N]) {
    team_tolerating(SILENCE)
}

/// Returns a team whose members' robots may be silent for at most `silence`.
pub fn team_tolerating<const N: usize>(silence: Duration) -> (Coordinator, [Member; N]) {
    const { assert!(0 < N && N <= MEMBERS_MAX, "a team has one member to 254") };
    let shared = Arc::new(Shared {
        word: AtomicU64::new(Word::default().0),
        stopped: AtomicU64::new(Word::default().0),
        seen: (0..N).map(|_| AtomicU64::new(0)).collect(),
        carrying: (0..N).map(|_| AtomicU64::new(0)).collect(),
        members: N as u8,
        silence,
    });
    let member = |number| Member {
        shared: shared.clone(),
        number: number as u8,
        arrived: None,
        seen: Word::default(),
        has_left: false,
    };
    let members = core::array::from_fn(member);
    (Coordinator { shared }, members)
}

impl Coordinator {
    /// Begins a round: the members wait until each of them has a goal of the round. An earlier
    /// round that has not opened never opens. If goals of an older round are under way, each
    /// continues until the member's goal of this round begins.
    ///
    /// The round stops at once, and never opens, if a member has not seen an earlier
    /// [stop](Self::stop) or the session of a member has ended. A member checks in each cycle of
    /// its robot. Until it has checked, every new round stops in this way.
    pub fn begin(&self) -> Round {
        let word = self.shared.change(|word| {
            let next = word.next_round();
            let unseen = word.is_of_the_team() && !self.shared.have_all_seen(word);
            Some(if unseen { next.stopped_as(word) } else { next })
        });
        word.round().unwrap_or(Round(NonZeroU32::MIN))
    }

    /// Brakes all members within two of their cycles. They hold where they stop, until they receive
    /// new goals. Wait-free except for changes by the members.
    pub fn stop(&self) {
        self.shared.stop(CALLER, Cause::Requested);
    }

    /// Notes that the goal of `member` in this round was refused or has ended with an error. Has no
    /// effect if the round has stopped or is not the newest.
    pub fn refuse(&self, round: Round, member: usize) {
        let cause = Cause::Member(MemberFault::Refused);
        self.shared.stop_round(round, member as u8, cause);
    }

    /// Brakes all members if this round is the newest. Has no effect if it has stopped.
    pub fn take_back(&self, round: Round) {
        self.shared.stop_round(round, CALLER, Cause::Requested);
    }

    /// Returns the reason why the newest round has stopped; `None` if it has not stopped.
    pub fn stopped(&self) -> Option<TeamStop> {
        self.shared.look().stop()
    }
}

impl Member {
    /// Returns the number of the member, counted from 0.
    pub fn number(&self) -> usize {
        self.number.into()
    }

    /// Returns the time for which the member's robot may be silent.
    pub fn silence(&self) -> Duration {
        self.shared.silence
    }

    /// Returns whether the member may pursue the goal of `round` at `now`, `[ms]` of the robot's
    /// clock. With the first call, the member arrives in the round. Never waits.
    pub fn pass(&mut self, round: Round, now: u64) -> Passage {
        let since = match self.arrived {
            Some((arrived, since)) if arrived == round => since,
            // The round is not the newest or has stopped, so keep the arrival in another round.
            _ if !self.shared.look().is_going(round) => return self.passage(round),
            _ => {
                self.arrived = Some((round, now));
                let arrives = |word: Word| word.is_going(round).then(|| word.with_one_more());
                self.shared.change(arrives);
                now
            }
        };
        let passage = self.passage(round);
        let waited = u128::from(now.saturating_sub(since));
        if passage == Passage::Waiting && waited >= START_TIMEOUT.as_millis() {
            self.give_up(round, MemberFault::TimedOut);
            return self.passage(round);
        }
        passage
    }

    fn passage(&self, round: Round) -> Passage {
        let word = self.shared.look();
        match word.stop() {
            Some(stop) => Passage::Stopped(stop),
            None if word.round() != Some(round) => Passage::Stopped(TeamStop::Member {
                member: self.number(),
                fault: MemberFault::TakenBack,
            }),
            None if word.present() == self.shared.members => Passage::Open,
            None => Passage::Waiting,
        }
    }

    /// Returns each stop of the team once. Does not return a stop of a motion that this member
    /// cancelled itself: its next motion continues.
    pub fn take_stop(&mut self) -> Option<TeamStop> {
        let (word, stop) = self.shared.stop_after(self.seen)?;
        self.seen = word;
        if !self.has_left {
            self.shared.note_seen(self.number, word);
        }
        let own = TeamStop::Member {
            member: self.number(),
            fault: MemberFault::TakenBack,
        };
        (stop != own).then_some(stop)
    }

    /// Stops `round` because of a fault of this member. Has no effect if the round has stopped.
    ///
    /// If an arm failed during the motion, this also stops a newer round that has begun in the
    /// meantime, because the other members may still pursue their goals of `round`. It does not
    /// stop the newer round if this member has seen that `round` stopped. A goal that was
    /// cancelled, was refused or has waited too long stops only its own round.
    pub fn give_up(&self, round: Round, fault: MemberFault) {
        let cause = Cause::Member(fault);
        match fault {
            MemberFault::TakenBack | MemberFault::Refused | MemberFault::TimedOut => {
                self.shared.stop_round(round, self.number, cause);
            }
            _ if Word::of(round).is_newer_than(self.seen) => {
                self.shared.stop_newest(self.number, cause);
            }
            _ => {}
        }
    }

    /// Stops all motions of the other members, whether they belong to a round or not.
    pub fn stop(&self, fault: MemberFault) {
        self.shared.stop(self.number, Cause::Member(fault));
    }

    /// Reports the member's progress in `round` to the other members.
    pub fn tell(&self, round: Round, carrying: Carrying) {
        let micrometres = (carrying.remaining.max(0.0) * 1e6) as u64;
        let way = micrometres.min(WAY_MAX);
        let word = Round::to_word(Some(round)) << 32 | u64::from(carrying.lags) << 31 | way;
        // Each member has its own word, which needs no other memory.
        self.shared.carrying[usize::from(self.number)].store(word, Ordering::Relaxed);
    }

    /// Returns the combined progress of the other members of `round`: the longest remaining
    /// distance, and true if one of them lags. Members that have not reported progress do not
    /// count.
    pub fn others(&self, round: Round) -> Carrying {
        let mut all = Carrying::default();
        for (number, word) in self.shared.carrying.iter().enumerate() {
            let word = word.load(Ordering::Relaxed);
            if number != self.number() && Round::from_word(word >> 32) == Some(round) {
                all.remaining = all.remaining.max((word & WAY_MAX) as f64 * 1e-6);
                all.lags |= word >> 31 & 1 == 1;
            }
        }
        all
    }

    /// Leaves the team. The team continues as long as no round needs a goal of this member.
    pub fn leave(&mut self) {
        self.has_left = true;
        self.shared.note_seen(self.number, GONE);
    }
}

impl Drop for Member {
    fn drop(&mut self) {
        if !self.has_left {
            self.stop(MemberFault::Gone);
            self.shared.note_seen(self.number, GONE);
        }
    }
}

#[derive(Debug)]
struct Shared {
    word: AtomicU64,
    /// Word of the newest stopped round, if it was replaced. Written after the new word.
    stopped: AtomicU64,
    /// Newest stop that each member has seen; [`GONE`] for a member that has left.
    seen: Box<[AtomicU64]>,
    /// [`Carrying`] of each member. The low 31 bits contain the remaining distance in micrometres;
    /// the next bit is set if the member lags. The upper half contains the round.
    carrying: Box<[AtomicU64]>,
    members: u8,
    silence: Duration,
}

impl Shared {
    fn look(&self) -> Word {
        // Relaxed, here and below: no other memory is read depending on the word, and all threads
        // see the changes of one atomic in the same order.
        Word(self.word.load(Ordering::Relaxed))
    }

    /// Stops the newest round or, if it has already stopped, the motions after it.
    fn stop(&self, member: u8, cause: Cause) {
        self.change(|word| {
            let going = match word.stop() {
                None if word.round().is_some() => word,
                // Each stop has its own round.
                _ => word.next_round(),
            };
            Some(going.stopped(member, cause).of_the_team())
        });
    }

    fn stop_round(&self, round: Round, member: u8, cause: Cause) {
        self.change(|word| word.is_going(round).then(|| word.stopped(member, cause)));
    }

    /// Stops the newest round, unless it has stopped.
    fn stop_newest(&self, member: u8, cause: Cause) {
        self.change(|word| {
            let going = word.round().is_some_and(|round| word.is_going(round));
            going.then(|| word.stopped(member, cause))
        });
    }

    /// Returns the newest stop and its word, unless it equals `seen`.
    fn stop_after(&self, seen: Word) -> Option<(Word, TeamStop)> {
        let word = self.look();
        if let Some(stop) = word.stop() {
            return (word != seen).then_some((word, stop));
        }
        let kept = Word(self.stopped.load(Ordering::Relaxed));
        let stop = kept.stop().filter(|_| kept.is_newer_than(seen));
        stop.map(|stop| (kept, stop))
    }

    fn note_seen(&self, member: u8, word: Word) {
        self.seen[usize::from(member)].store(word.0, Ordering::Relaxed);
    }

    /// True if all remaining members have seen this stop, which is the newest.
    fn have_all_seen(&self, stop: Word) -> bool {
        let seen = |by: &AtomicU64| [stop, GONE].contains(&Word(by.load(Ordering::Relaxed)));
        self.seen.iter().all(seen)
    }

    /// Keeps a stop for members that check only after a newer round has begun.
    fn keep(&self, stop: Word) {
        let order = Ordering::Relaxed;
        let mut kept = Word(self.stopped.load(order));
        // Two threads may arrive here in a different order than they changed the word.
        while stop.is_newer_than(kept) {
            match self.stopped.compare_exchange(kept.0, stop.0, order, order) {
                Ok(_) => return,
                Err(newer) => kept = Word(newer),
            }
        }
    }

    /// Replaces the word if `to` returns a new word. Returns the newest word.
    fn change(&self, to: impl Fn(Word) -> Option<Word>) -> Word {
        let mut word = self.look();
        while let Some(next) = to(word) {
            // Strong: the exchange fails only if another thread has changed the word. Each member
            // changes it at most twice in a round; other changes are calls from outside.
            let order = Ordering::Relaxed;
            match self.word.compare_exchange(word.0, next.0, order, order) {
                Ok(_) => {
                    if next.stop().is_some() {
                        self.keep(next);
                    }
                    return next;
                }
                Err(newer) => word = Word(newer),
            }
        }
        word
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    Requested,
    Member(MemberFault),
}

/// Bytes, from the lowest: number of members present; number of the member that stopped the round;
/// reason (0 while the round continues). The lowest bit of the next byte is set if the stop holds
/// for the team and not only for the round. The upper half contains the round.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Word(u64);

impl Word {
    fn of(round: Round) -> Self {
        Self(Round::to_word(Some(round)) << 32)
    }

    fn round(self) -> Option<Round> {
        Round::from_word(self.0 >> 32)
    }

    fn present(self) -> u8 {
        self.0 as u8
    }

    /// True if this is the newest round, and it has not stopped.
    fn is_going(self, round: Round) -> bool {
        self.round() == Some(round) && self.stop().is_none()
    }

    fn stop(self) -> Option<TeamStop> {
        let cause = (self.0 >> 16) as u8;
        if cause == REQUESTED {
            return Some(TeamStop::Requested);
        }
        let fault = *FAULTS.get(usize::from(cause).checked_sub(1)?)?;
        let member = usize::from((self.0 >> 8) as u8);
        Some(TeamStop::Member { member, fault })
    }

    fn next_round(self) -> Self {
        // After four thousand million rounds, the numbers start again at 1. 0 means that there is
        // no round.
        let round = ((self.0 >> 32) as u32).wrapping_add(1).max(1);
        Self(u64::from(round) << 32)
    }

    /// True if the round of this word comes after the round of `other`, even if the numbers wrap.
    fn is_newer_than(self, other: Self) -> bool {
        let ahead = ((self.0 >> 32) as u32).wrapping_sub((other.0 >> 32) as u32);
        other.round().is_none() || 0 < ahead as i32
    }

    fn is_of_the_team(self) -> bool {
        self.0 & OF_THE_TEAM != 0
    }

    fn of_the_team(self) -> Self {
        Self(self.0 | OF_THE_TEAM)
    }

    /// Returns this word, stopped for the same reason as `other`.
    fn stopped_as(self, other: Self) -> Self {
        Self(self.0 | other.0 & (0xffff << 8 | OF_THE_TEAM))
    }

    fn with_one_more(self) -> Self {
        Self(self.0 + 1)
    }

    fn stopped(self, member: u8, cause: Cause) -> Self {
        let cause = match cause {
            Cause::Requested => REQUESTED,
            // The list contains every fault, as a test checks.
            Cause::Member(fault) => FAULTS
                .iter()
                .position(|it| *it == fault)
                .map_or(REQUESTED, |place| place as u8 + 1),
        };
        Self(self.0 | u64::from(member) << 8 | u64::from(cause) << 16)
    }
}

/// Longest distance that can be reported, `[um]`.
const WAY_MAX: u64 = (1 << 31) - 1;

/// Bit for a stop of the whole team instead of a round.
const OF_THE_TEAM: u64 = 1 << 24;

/// Newest stop of a member that has left, as if it had seen every stop.
const GONE: Word = Word(u64::MAX);

/// Number that stands for the caller instead of a member.
const CALLER: u8 = u8::MAX;

/// Value that stands for [`TeamStop::Requested`] in a word.
const REQUESTED: u8 = u8::MAX;

/// Faults in the order of their values in a word, from 1.
const FAULTS: [MemberFault; 9] = [
    MemberFault::RobotStopped,
    MemberFault::Silent,
    MemberFault::Failed,
    MemberFault::Gone,
    MemberFault::GivenUp,
    MemberFault::NotReached,
    MemberFault::TakenBack,
    MemberFault::Refused,
    MemberFault::TimedOut,
];

// This path is also valid where `tests/loom` includes this file.
#[cfg(all(test, not(loom)))]
#[path = "team/tests.rs"]
mod tests;

//! Motions of several robots that begin together.
//!
//! ```text
//!  StartBarrier::tickets --> one StartTicket for each motion
//!
//!               the last one arrives
//!   waiting ---------------------------> open     every motion begins with its next state
//!      |
//!      +-------------------------------> broken   none begins; each resolves as StartFault
//!         a member is dropped, ends, is taken back, or has waited too long
//! ```
//!
//! A motion *arrives* when its robot shows the motion's modes. From then on, its thread answers
//! every state with a command that holds the arm, until the last member has arrived. A robot
//! requires such commands at the start of a motion. Each thread checks once in each of its own
//! cycles, so the motions begin within a millisecond of each other. The robots' clocks are not
//! synchronised, so a start cannot be more accurate.
//!
//! The state is one atomic word, which leaves `waiting` at most once. No thread waits for another
//! thread. A check is a load. Arriving and leaving are a compare-and-exchange, repeated only if
//! another member has changed the word in between. Each member changes the word at most twice,
//! which limits the repetitions.

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

use core::time::Duration;

/// A common start of several robots' motions, before its tickets are distributed.
///
/// ```
/// use franka_rt::together::StartBarrier;
///
/// let [left, right] = StartBarrier::new().tickets();
/// assert_eq!((left.member(), right.member()), (0, 1));
/// drop(right); // its motion will never begin, so the other one will not either
/// let fault = left.fault().expect("a member is gone");
/// assert_eq!(fault.to_string(), "the motion with start ticket 1 was dropped or refused before the motions began");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use = "only the tickets of a common start do something"]
pub struct StartBarrier {
    timeout: Duration,
}

impl Default for StartBarrier {
    fn default() -> Self {
        Self::new()
    }
}

impl StartBarrier {
    /// Default time for which a motion waits for the other motions. It is twice the time in which a
    /// robot must show the modes of a motion.
    pub const TIMEOUT: Duration = Duration::from_secs(10);

    /// Largest number of members.
    pub const MEMBERS_MAX: usize = u16::MAX as usize;

    /// Returns a start whose motions wait for at most [`Self::TIMEOUT`].
    pub fn new() -> Self {
        Self {
            timeout: Self::TIMEOUT,
        }
    }

    /// Replaces the time for which a motion waits for the other motions. It is counted from the
    /// motion's arrival, by its robot's clock.
    pub fn timeout(mut self, timeout: Duration) -> Self {
        self.timeout = timeout;
        self
    }

    /// Returns one ticket for each of `N` motions.
    pub fn tickets<const N: usize>(self) -> [StartTicket; N] {
        const { assert!(N <= Self::MEMBERS_MAX, "so many members fit") };
        let shared = self.shared(N);
        core::array::from_fn(|member| StartTicket::new(shared.clone(), member))
    }

    /// Returns one ticket for each of `members` motions. Use it if the number is not known at
    /// compile time.
    ///
    /// # Panics
    /// Panics if there are more than [`Self::MEMBERS_MAX`] members.
    pub fn tickets_for(self, members: usize) -> Vec<StartTicket> {
        assert!(members <= Self::MEMBERS_MAX, "so many members fit");
        let shared = self.shared(members);
        let ticket = |member| StartTicket::new(shared.clone(), member);
        (0..members).map(ticket).collect()
    }

    fn shared(self, members: usize) -> Arc<Shared> {
        Arc::new(Shared {
            word: AtomicU64::new(Word::Waiting { present: 0 }.into()),
            members: members as u16,
            timeout: self.timeout,
        })
    }
}

/// Ticket of one motion for a common start. If it is dropped before the start, the wait of the
/// other motions ends with an error.
#[derive(Debug)]
#[must_use = "dropping a ticket ends the common start"]
pub struct StartTicket {
    shared: Arc<Shared>,
    member: u16,
    state: MemberState,
}

/// State of a member in a common start.
#[derive(Clone, Copy, Debug)]
enum MemberState {
    Outside,
    /// The member has waited since this time, `[ms]` of its robot's clock.
    Arrived(u64),
    /// The wait of the member is over, with this result.
    Decided(Gate),
}

/// Decision whether a motion of a common start may begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gate {
    /// The motion may not begin yet.
    Closed,
    /// The motion may begin. This decision is final.
    Open,
    /// The motion will not begin, for this reason. This decision is final.
    Broken(StartFault),
}

/// Caller: the common start failed. Members are counted from 0, in the order of their tickets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StartFault {
    /// A ticket was dropped, or its motion was dropped before it was awaited, or its motion was
    /// refused before anything was sent to the robot.
    #[error(
        "the motion with start ticket {member} was dropped or refused before the motions began"
    )]
    Dropped {
        /// Number of the member.
        member: usize,
    },
    /// A motion was dropped, stopped or superseded while it waited.
    #[error("the motion with start ticket {member} was cancelled while it waited for the others")]
    Withdrawn {
        /// Number of the member.
        member: usize,
    },
    /// A motion ended before the start, because its robot refused it, stopped, or fell silent. The
    /// motion's own error reports the cause.
    #[error("the motion with start ticket {member} ended before the others were ready")]
    Ended {
        /// Number of the member.
        member: usize,
    },
    /// Not all members arrived in time.
    #[error(
        "{present} of {members} motions were ready to start together within {} ms, expected all of \
         them",
        .waited.as_millis()
    )]
    TimedOut {
        /// Number of members that had arrived.
        present: usize,
        /// Number of members.
        members: usize,
        /// Time for which the member that gave up first had waited.
        waited: Duration,
    },
}

impl StartFault {
    /// Returns the name of this error's row in the error chapter of the book, `errors.md`.
    pub fn entry(&self) -> &'static str {
        match self {
            Self::Dropped { .. } => "start-dropped",
            Self::Withdrawn { .. } => "start-withdrawn",
            Self::Ended { .. } => "start-ended",
            Self::TimedOut { .. } => "start-timed-out",
        }
    }
}

/// Reason why a member leaves a common start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    Dropped,
    Withdrawn,
    Ended,
    TimedOut,
}

impl StartTicket {
    fn new(shared: Arc<Shared>, member: usize) -> Self {
        Self {
            shared,
            member: member as u16,
            state: MemberState::Outside,
        }
    }

    /// Returns the number of the member, counted from 0 in the order of the tickets.
    pub fn member(&self) -> usize {
        self.member.into()
    }

    /// Returns the reason why the common start has failed; `None` if it has not failed.
    pub fn fault(&self) -> Option<StartFault> {
        match self.shared.gate() {
            Gate::Broken(fault) => Some(fault),
            Gate::Closed | Gate::Open => None,
        }
    }

    /// Returns whether the motion may begin at `now`, `[ms]` of its robot's clock. With the first
    /// call, the motion arrives. Never waits.
    pub fn pass(&mut self, now: u64) -> Gate {
        let since = match self.state {
            MemberState::Decided(gate) => return gate,
            MemberState::Arrived(since) => since,
            MemberState::Outside => {
                self.shared.arrive();
                self.state = MemberState::Arrived(now);
                now
            }
        };
        let mut gate = self.shared.gate();
        let waited = u128::from(now.saturating_sub(since));
        if gate == Gate::Closed && waited >= self.shared.timeout.as_millis() {
            self.shared.leave(self.member, Cause::TimedOut);
            gate = self.shared.gate();
        }
        if gate != Gate::Closed {
            self.state = MemberState::Decided(gate);
        }
        gate
    }

    /// True until it is decided whether the motion begins.
    pub fn is_undecided(&self) -> bool {
        !matches!(self.state, MemberState::Decided(_))
    }

    /// Returns the reason why the common start failed for this motion; `None` if it did not fail.
    pub fn refusal(&self) -> Option<StartFault> {
        match self.state {
            MemberState::Decided(Gate::Broken(fault)) => Some(fault),
            _ => None,
        }
    }

    /// Removes the motion from the common start, so that it continues alone. The wait of the other
    /// motions ends with an error.
    pub fn withdraw(&mut self) {
        if self.is_undecided() {
            self.shared.leave(self.member, Cause::Withdrawn);
            self.state = MemberState::Decided(Gate::Open);
        }
    }

    /// Notes that the motion has ended. If the other motions still wait, their wait ends with an
    /// error.
    pub fn end(&mut self) {
        self.leave(Cause::Ended);
    }

    fn leave(&mut self, cause: Cause) {
        if self.is_undecided() {
            self.shared.leave(self.member, cause);
            self.state = MemberState::Decided(self.shared.gate());
        }
    }
}

impl Drop for StartTicket {
    fn drop(&mut self) {
        self.leave(Cause::Dropped);
    }
}

#[derive(Debug)]
struct Shared {
    word: AtomicU64,
    members: u16,
    timeout: Duration,
}

/// Content of the atomic word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Word {
    /// Waiting; `present` members have arrived. Open once all members have arrived.
    Waiting { present: u16 },
    /// `member` has left when `present` members had arrived.
    Broken {
        present: u16,
        member: u16,
        cause: Cause,
    },
}

impl Shared {
    fn gate(&self) -> Gate {
        // Relaxed, here and below: no other memory is read depending on the word, and all threads
        // see the changes of one atomic in the same order.
        match Word::from(self.word.load(Ordering::Relaxed)) {
            Word::Waiting { present } if present == self.members => Gate::Open,
            Word::Waiting { .. } => Gate::Closed,
            Word::Broken {
                present,
                member,
                cause,
            } => Gate::Broken(self.fault(present, member, cause)),
        }
    }

    fn fault(&self, present: u16, member: u16, cause: Cause) -> StartFault {
        let member = member.into();
        match cause {
            Cause::Dropped => StartFault::Dropped { member },
            Cause::Withdrawn => StartFault::Withdrawn { member },
            Cause::Ended => StartFault::Ended { member },
            Cause::TimedOut => StartFault::TimedOut {
                present: present.into(),
                members: self.members.into(),
                waited: self.timeout,
            },
        }
    }

    fn arrive(&self) {
        self.change(|present| Word::Waiting {
            present: present + 1,
        });
    }

    fn leave(&self, member: u16, cause: Cause) {
        self.change(|present| Word::Broken {
            present,
            member,
            cause,
        });
    }

    /// Replaces the word unless it is open or broken, which are final.
    fn change(&self, to: impl Fn(u16) -> Word) {
        let mut word = self.word.load(Ordering::Relaxed);
        while let Word::Waiting { present } = Word::from(word)
            && present < self.members
        {
            // Strong: the exchange fails only if another member has changed the word. Each member
            // does so at most twice.
            match self.word.compare_exchange(
                word,
                to(present).into(),
                Ordering::Relaxed,
                Ordering::Relaxed,
            ) {
                Ok(_) => return,
                Err(newer) => word = newer,
            }
        }
    }
}

/// The lowest 16 bits contain the number of members present, the next 16 bits the number of the
/// member that left. The next byte contains the reason; it is 0 if no member has left.
impl From<Word> for u64 {
    fn from(word: Word) -> Self {
        match word {
            Word::Waiting { present } => present.into(),
            Word::Broken {
                present,
                member,
                cause,
            } => {
                let cause = match cause {
                    Cause::Dropped => 1,
                    Cause::Withdrawn => 2,
                    Cause::Ended => 3,
                    Cause::TimedOut => 4,
                };
                u64::from(present) | u64::from(member) << 16 | cause << 32
            }
        }
    }
}

impl From<u64> for Word {
    fn from(word: u64) -> Self {
        let present = word as u16;
        let cause = match word >> 32 {
            0 => return Self::Waiting { present },
            1 => Cause::Dropped,
            2 => Cause::Withdrawn,
            3 => Cause::Ended,
            _ => Cause::TimedOut,
        };
        Self::Broken {
            present,
            member: (word >> 16) as u16,
            cause,
        }
    }
}

// This path is also valid where `tests/loom` includes this file.
#[cfg(all(test, not(loom)))]
#[path = "together/tests.rs"]
mod tests;

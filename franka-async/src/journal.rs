//! What is asked of a robot or an end effector, and what comes of it, for recorders.
//!
//! ```text
//! supervisor       goals, stops, outcomes, events, connections --+
//! command channel  requests and their answers -------------------+--> Journal --> a bounded queue per reader
//! device           actions of an end effector, its states -------+
//! ```
//!
//! An entry holds what its writer has at hand; readers make words of it on a thread of theirs.
//! Writing never waits for a reader. Without one, nothing is kept.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{SyncSender, TrySendError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use franka_proto::{Request, gripper, vacuum};
use franka_record::EventKind;
use franka_rt::driver::Program;
use franka_rt::lifecycle::{NewMotion, Outcome};
use franka_rt::session::{Goal, GoalId, OnArrival};
use franka_rt::supervision::Event;
use franka_rt::thread::{AttachError, CycleFeed, CycleReader};

use crate::destination::Destination;
use crate::input::{Beginning, Input};

/// Where entries are written. Clones are the same journal.
#[derive(Clone, Debug, Default)]
pub(crate) struct Journal(Arc<Mutex<Vec<Reader>>>);

/// Where a journal goes to.
#[derive(Clone, Debug)]
pub(crate) struct Reader {
    /// Which journal this is, for a reader of several.
    pub(crate) track: usize,
    pub(crate) entries: SyncSender<(usize, Entry)>,
    /// Counts the entries for which there was no room.
    pub(crate) lost: Arc<AtomicU64>,
    /// How many cycles of a connection may wait for it; `None` if it takes none.
    pub(crate) cycles: Option<usize>,
}

/// Something that was asked for or happened.
#[derive(Debug)]
pub(crate) struct Entry {
    pub(crate) at: Instant,
    pub(crate) what: What,
}

#[derive(Debug)]
pub(crate) enum What {
    /// A goal, a session or a program was asked for.
    Goal(Given),
    /// It has ended, or never began.
    Ended {
        goal: GoalId,
        outcome: Arc<Outcome>,
    },
    /// Something happened to the robot.
    Event(Event),
    /// There is a new connection, whose cycles these are.
    Connected(Result<CycleReader, AttachError>),
    /// The robot has answered a request, or did not.
    Answered {
        request: Box<Request>,
        /// Why it was not done, if it was not.
        error: Option<String>,
    },
    /// An action of the Hand has ended.
    Hand {
        request: gripper::Request,
        ended: ActionEnd,
    },
    HandState(gripper::State),
    /// An action of a vacuum gripper has ended.
    Vacuum {
        request: vacuum::Request,
        ended: ActionEnd,
    },
    VacuumState(vacuum::State),
    /// The caller changed its mind: a stop, a pause, a motion taken back.
    Remark(String),
    /// What the recorder itself was told.
    Told(Box<EventKind>),
    /// The reader reads no further.
    End,
}

/// Whether an action did what it was to do, or the text of its error.
pub(crate) type ActionEnd = Result<bool, String>;

/// A goal, a session or a program that was asked for.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    pub(crate) id: GoalId,
    pub(crate) kind: &'static str,
    /// The goal; `None` of a program.
    pub(crate) goal: Option<Box<Goal>>,
    /// Where it leads, if that takes the poses of when it begins: the goal has no target then.
    pub(crate) destination: Option<Destination>,
}

impl Entry {
    /// `what`, now.
    pub(crate) fn now(what: What) -> Self {
        let at = Instant::now();
        Self { at, what }
    }
}

impl Journal {
    /// Has everything from now on go to `reader`, until that is gone.
    pub(crate) fn read(&self, reader: Reader) {
        self.with(|readers| readers.push(reader));
    }

    /// Writes what `what` returns, if anybody reads it.
    pub(crate) fn write(&self, what: impl Fn() -> Option<What>) {
        let tell = |reader: &Reader| what().is_none_or(|what| reader.tell(Entry::now(what)));
        self.with(|readers| readers.retain(tell));
    }

    /// Writes that there is a new connection, and gives its readers the cycles from now on: they
    /// may come to read of it much later.
    pub(crate) fn connected(&self, cycles: &CycleFeed) {
        // Attaching takes memory, for which nobody is to wait at the lock.
        for reader in self.with(|readers| readers.clone()) {
            if let Some(capacity) = reader.cycles {
                let attached = cycles.attach(capacity);
                reader.tell(Entry::now(What::Connected(attached)));
            }
        }
    }

    /// Writes down how something ended.
    pub(crate) fn ended(&self, goal: GoalId, outcome: &Outcome) {
        self.write(|| {
            let outcome = Arc::new(outcome.clone());
            Some(What::Ended { goal, outcome })
        });
    }

    /// Writes down what a program asks of the bridge. Targets that update a goal are not written:
    /// every cycle has them.
    pub(crate) fn asked(&self, input: &Input) {
        self.write(|| match input {
            Input::Begin { motion, .. } => Some(What::Goal(Given::of(motion, false))),
            Input::Set { motion, .. } => Some(What::Goal(Given::of(motion, true))),
            Input::SetNewest { waiting } => {
                waiting.peek(|motion| What::Goal(Given::of(motion, true)))
            }
            Input::Chunk { goal, .. } => Some(What::Goal(Given {
                id: goal.id,
                kind: "chunk",
                goal: Some(goal.clone()),
                destination: None,
            })),
            Input::Pause { goal, paused } => {
                let what = if *paused { "paused" } else { "let go on" };
                Some(What::Remark(format!("goal {} is {what}", goal.0)))
            }
            Input::Cancel { goal } => Some(What::Remark(format!("goal {} is taken back", goal.0))),
            Input::Disengage { id } => Some(What::Remark(format!("session {} is to end", id.0))),
            Input::Stop { .. } => Some(What::Remark("a stop is asked for".into())),
            Input::Shutdown { .. } => Some(What::Remark("a shutdown is asked for".into())),
            Input::Update { .. }
            | Input::Tune { .. }
            | Input::Close { .. }
            | Input::Lose { .. } => None,
        });
    }

    fn with<T>(&self, act: impl FnOnce(&mut Vec<Reader>) -> T) -> T {
        // Nothing can be half done in there.
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Reader {
    /// Passes an entry on, if there is room. Returns whether the reader is still there.
    fn tell(&self, entry: Entry) -> bool {
        match self.entries.try_send((self.track, entry)) {
            Ok(()) => true,
            Err(TrySendError::Full(_)) => {
                self.lost.fetch_add(1, Ordering::Relaxed);
                true
            }
            Err(TrySendError::Disconnected(_)) => false,
        }
    }
}

impl Given {
    /// What is asked for by `motion`, whose outcome is not awaited if it is `set`.
    fn of(motion: &Beginning, set: bool) -> Self {
        let Beginning {
            motion,
            destination,
            path,
        } = motion;
        let (kind, goal) = match motion {
            NewMotion::Goal { goal, .. } => {
                let kind = match goal.on_arrival {
                    _ if path.is_some() => "move_through",
                    _ if set => "set",
                    OnArrival::Hold => "follow",
                    OnArrival::ReportAndHold | OnArrival::ReportAndFinish => "move_to",
                };
                (kind, Some(goal))
            }
            NewMotion::Session { goal, .. } => ("engage", Some(goal)),
            NewMotion::Program { program, .. } => match program {
                Program::Target(_) => ("targets", None),
                Program::Callback(_) => ("control function", None),
                Program::Active(_) => ("active control", None),
                Program::Asynchronous(_) => ("asynchronous control", None),
            },
        };
        Self {
            id: motion.id(),
            kind,
            goal: goal.cloned(),
            destination: destination.as_deref().copied(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;

    use super::*;

    fn remark(text: &str) -> Option<What> {
        Some(What::Remark(text.into()))
    }

    #[test]
    fn a_full_reader_loses_entries_and_counts_them_and_a_gone_one_is_forgotten() {
        let journal = Journal::default();
        journal.write(|| panic!("nobody reads this"));
        let lost = Arc::<AtomicU64>::default();
        let read = |track| {
            let (entries, queue) = mpsc::sync_channel(2);
            let lost = lost.clone();
            journal.read(Reader {
                track,
                entries,
                lost,
                cycles: None,
            });
            queue
        };
        let (kept, dropped) = (read(7), read(8));
        drop(dropped);
        for text in ["one", "two", "three"] {
            journal.write(|| remark(text));
        }
        assert_eq!(lost.load(Ordering::Relaxed), 1);
        let texts: Vec<_> = kept
            .try_iter()
            .map(|(track, entry)| match entry.what {
                What::Remark(text) => (track, text),
                other => panic!("{other:?}"),
            })
            .collect();
        assert_eq!(texts, [(7, "one".to_owned()), (7, "two".to_owned())]);
        journal.write(|| remark("four"));
        assert_eq!(kept.try_iter().count(), 1);
        drop(kept);
        journal.write(|| remark("five"));
        journal.write(|| panic!("nobody reads this any more"));
    }
}

//! Journal of the requests to a robot or an end effector, and of their results, for recorders.
//!
//! ```text
//! supervisor       goals, stops, outcomes, events, connections --+
//! command channel  requests and their answers -------------------+--> Journal --> a bounded queue per reader
//! device           actions of an end effector, its states -------+
//! ```
//!
//! A writer copies the data into an entry; readers convert it into words on their own thread.
//! Writing never waits for a reader. Without a reader, nothing is kept.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use franka_proto::{Request, gripper, vacuum};
use franka_record::EventKind;
use franka_rt::driver::Program;
use franka_rt::lifecycle::{NewMotion, Outcome};
use franka_rt::session::{Goal, GoalId, OnArrival, Target};
use franka_rt::supervision::Event;
use franka_rt::thread::{AttachError, CycleFeed, CycleReader};

use crate::destination::Destination;
use crate::input::{Beginning, Input};
use crate::world;

/// The journal to which requests and results are written. Clones share one journal.
#[derive(Clone, Debug, Default)]
pub(crate) struct Journal(Arc<Mutex<Vec<Reader>>>);

/// Reader of a journal.
#[derive(Clone, Debug)]
pub(crate) struct Reader {
    /// Number of the journal, for a reader of several journals.
    pub(crate) track: usize,
    pub(crate) entries: EntrySender,
    /// Number of cycles of a connection that may wait for the reader; `None` if it reads no cycles.
    pub(crate) cycles: Option<usize>,
}

/// The writing end of a reader's queue. Clones write to the same queue.
#[derive(Clone, Debug)]
pub(crate) struct EntrySender {
    entries: Sender<(usize, Entry)>,
    counts: Arc<Counts>,
}

/// The reading end of a reader's queue.
#[derive(Debug)]
pub(crate) struct EntryReceiver {
    entries: Receiver<(usize, Entry)>,
    counts: Arc<Counts>,
}

/// Counts of a queue. All accesses are relaxed, because the counts order no other memory.
#[derive(Debug)]
struct Counts {
    /// Number of further entries that may wait.
    room: AtomicUsize,
    /// Entries for which there was no room.
    lost: AtomicU64,
}

/// Returns a queue in which `room` entries may wait. Entries for which [`What::needs_room`] is
/// false do not count.
pub(crate) fn entry_queue(room: usize) -> (EntrySender, EntryReceiver) {
    let (sender, receiver) = mpsc::channel();
    let counts = Arc::new(Counts {
        room: AtomicUsize::new(room),
        lost: AtomicU64::new(0),
    });
    let sender = EntrySender {
        entries: sender,
        counts: counts.clone(),
    };
    let receiver = EntryReceiver {
        entries: receiver,
        counts,
    };
    (sender, receiver)
}

/// A request or an event.
#[derive(Debug)]
pub(crate) struct Entry {
    pub(crate) at: Instant,
    pub(crate) what: What,
}

#[derive(Debug)]
pub(crate) enum What {
    /// A goal, a session or a program was requested.
    Goal(Given),
    /// A goal, a session or a program has ended, or never began.
    Ended {
        goal: GoalId,
        outcome: Arc<Outcome>,
    },
    /// The state of the robot or of its connection has changed.
    Event(Event),
    /// A new connection, with a reader of its cycles.
    Connected(Result<CycleReader, AttachError>),
    /// The robot has answered a request, or did not answer.
    Answered {
        request: Box<Request>,
        /// Reason why the request was not carried out; `None` if it was.
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
    /// The caller has stopped, paused or cancelled something.
    Remark(String),
    /// An event that the recorder itself has received.
    Told(Box<EventKind>),
    /// The reader must stop reading.
    End,
}

impl What {
    /// True if the entry is dropped when no room is left. The entry of a connection is kept,
    /// because its cycles would be lost with it, and so is the end. Both are rare.
    fn needs_room(&self) -> bool {
        !matches!(self, Self::Connected(_) | Self::End)
    }
}

/// True if an action succeeded, false if it did not, or the text of its error.
pub(crate) type ActionEnd = Result<bool, String>;

/// A goal, a session or a program that was requested.
#[derive(Clone, Debug)]
pub(crate) struct Given {
    pub(crate) id: GoalId,
    pub(crate) kind: &'static str,
    /// The goal; `None` for a program.
    pub(crate) goal: Option<Box<Goal>>,
    /// Destination, if it depends on the poses at the start; the goal then has no target.
    pub(crate) destination: Option<Destination>,
}

impl Entry {
    /// Returns an entry of `what` at the present time.
    pub(crate) fn now(what: What) -> Self {
        let at = world::now().into_std();
        Self { at, what }
    }
}

impl Journal {
    /// Sends all entries from now on to `reader`, until the reader is gone.
    pub(crate) fn read(&self, reader: Reader) {
        self.with(|readers| readers.push(reader));
    }

    /// True if a reader with this queue reads the journal under this number.
    pub(crate) fn is_read(&self, track: usize, entries: &EntrySender) -> bool {
        let same = |reader: &Reader| {
            reader.track == track && Arc::ptr_eq(&reader.entries.counts, &entries.counts)
        };
        self.with(|readers| readers.iter().any(same))
    }

    /// Writes the result of `what`, if there is a reader.
    pub(crate) fn write(&self, what: impl Fn() -> Option<What>) {
        let tell = |reader: &Reader| {
            let entry = what().map(Entry::now);
            entry.is_none_or(|entry| reader.entries.send(reader.track, entry))
        };
        self.with(|readers| readers.retain(tell));
    }

    /// Writes an entry for a new connection. Readers get its cycles from now on, even if they read
    /// the entry much later.
    pub(crate) fn connected(&self, cycles: &CycleFeed) {
        // Attaching allocates memory, so do it without the lock, for which no caller should wait.
        for reader in self.with(|readers| readers.clone()) {
            if let Some(capacity) = reader.cycles {
                let attached = cycles.attach(capacity);
                let entry = Entry::now(What::Connected(attached));
                reader.entries.send(reader.track, entry);
            }
        }
    }

    /// Writes the end of a goal, a session or a program.
    pub(crate) fn ended(&self, goal: GoalId, outcome: &Outcome) {
        self.write(|| {
            let outcome = Arc::new(outcome.clone());
            Some(What::Ended { goal, outcome })
        });
    }

    /// Writes the requests of a program to the bridge. Updates of a goal's target are not written,
    /// because every cycle contains them.
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
                let what = if *paused { "paused" } else { "resumed" };
                Some(What::Remark(format!("goal {} is {what}", goal.0)))
            }
            Input::Cancel { goal, refused } => Some(What::Remark(match refused {
                Some(error) => format!(
                    "goal {} stops, because a target was refused: {error}",
                    goal.0
                ),
                None => format!("goal {} is cancelled", goal.0),
            })),
            Input::Disengage { id } => {
                Some(What::Remark(format!("end of session {} requested", id.0)))
            }
            Input::Stop { goal, latches, .. } => {
                let what = if *latches { "latched stop" } else { "stop" };
                let text = format!("{what} requested, as goal {}", goal.0);
                Some(What::Remark(text))
            }
            Input::Shutdown { .. } => Some(What::Remark("shutdown requested".into())),
            Input::Update { .. }
            | Input::Tune { .. }
            | Input::Await { .. }
            | Input::Close { .. }
            | Input::Lose { .. } => None,
        });
    }

    fn with<T>(&self, act: impl FnOnce(&mut Vec<Reader>) -> T) -> T {
        // A panic cannot leave the readers half-finished.
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl EntrySender {
    /// Passes on an entry with its journal's number if there is room, and counts the entry as lost
    /// otherwise. Returns true if the reader still exists.
    pub(crate) fn send(&self, track: usize, entry: Entry) -> bool {
        let less = |room: usize| room.checked_sub(1);
        let has_room = || {
            let room = &self.counts.room;
            room.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less)
                .is_ok()
        };
        if entry.what.needs_room() && !has_room() {
            self.counts.lost.fetch_add(1, Ordering::Relaxed);
            return true;
        }
        self.entries.send((track, entry)).is_ok()
    }

    pub(crate) fn lost(&self) -> u64 {
        self.counts.lost.load(Ordering::Relaxed)
    }
}

impl EntryReceiver {
    /// Waits for the next entry, and returns it with its journal's number; `None` once all writers
    /// are gone.
    pub(crate) fn next(&self) -> Option<(usize, Entry)> {
        let (track, entry) = self.entries.recv().ok()?;
        if entry.what.needs_room() {
            self.counts.room.fetch_add(1, Ordering::Relaxed);
        }
        Some((track, entry))
    }
}

impl Given {
    /// Returns the request of `motion`. If it is `set`, its outcome is not awaited.
    fn of(motion: &Beginning, set: bool) -> Self {
        let Beginning {
            motion,
            destination,
            path,
            refused: _,
            joint_fallback: _,
        } = motion;
        let (kind, goal) = match motion {
            NewMotion::Goal { goal, .. } => {
                let kind = match goal.on_arrival {
                    _ if path.is_some() => "move_through",
                    _ if matches!(goal.target, Target::Rest) => "hold",
                    _ if matches!(goal.target, Target::Guide(_)) => "guide",
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
    use franka_proto::Version;
    use franka_rt::thread::cycle_feed;

    use super::*;

    fn remark(text: &str) -> Option<What> {
        Some(What::Remark(text.into()))
    }

    #[test]
    fn journal_drops_remarks_but_no_connection_for_full_reader() {
        let journal = Journal::default();
        journal.write(|| panic!("nobody reads this"));
        let read = |track| {
            let (entries, queue) = entry_queue(2);
            journal.read(Reader {
                track,
                entries: entries.clone(),
                cycles: Some(1),
            });
            (entries, queue)
        };
        let ((entries, kept), (_, dropped)) = (read(7), read(8));
        drop(dropped);
        for text in ["one", "two", "three"] {
            journal.write(|| remark(text));
        }
        let (cycles, _thread) = cycle_feed(Version::V10);
        journal.connected(&cycles);
        assert_eq!(entries.lost(), 1);
        let texts = [(); 2].map(|()| match kept.next() {
            Some((7, entry)) => match entry.what {
                What::Remark(text) => text,
                other => panic!("{other:?}"),
            },
            other => panic!("{other:?}"),
        });
        assert_eq!(texts, ["one", "two"]);
        let (_, connection) = kept.next().unwrap();
        assert!(matches!(connection.what, What::Connected(Ok(_))));
        journal.write(|| remark("four"));
        assert!(kept.next().is_some());
        assert_eq!(entries.lost(), 1);
        drop(kept);
        journal.write(|| remark("five"));
        journal.write(|| panic!("nobody reads this any more"));
    }
}

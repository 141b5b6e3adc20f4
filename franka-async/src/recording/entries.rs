//! The thread that converts journal entries into words.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use franka_record::event::Level;
use franka_record::recorder::{RecordError, RecordHandle};
use franka_record::{EventKind, GripperState};

use super::{Track, words};
use crate::journal::{Entry, EntryReceiver, EntrySender, Journal, Reader, What, entry_queue};
use crate::world;

/// Number of entries that may wait for the thread.
const ENTRIES: usize = 4096;

/// The robots of a recording, by track number.
type Tracks = BTreeMap<usize, Recorded>;

/// A robot of a recording.
#[derive(Debug)]
pub(super) struct Recorded {
    pub(super) handle: RecordHandle,
    pub(super) track: Track,
}

/// Sender of entries to the thread. After the sender is dropped, the thread passes on the waiting
/// entries and then ends; the drop does not wait for that.
#[derive(Debug)]
pub(super) struct EntryQueue {
    entries: EntrySender,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug, Default)]
struct Shared {
    tracks: Mutex<Tracks>,
}

impl EntryQueue {
    pub(super) fn start() -> Result<Self, RecordError> {
        let (entries, queue) = entry_queue(ENTRIES);
        let shared = Arc::<Shared>::default();
        let of_thread = shared.clone();
        let thread = world::start_thread("franka-entries", move || of_thread.write(&queue))
            .map_err(|source| RecordError::Thread {
                source: Arc::new(source),
            })?;
        Ok(Self {
            entries,
            shared,
            thread: Some(thread),
        })
    }

    /// Sends everything that is written to `journal` from now on to the track `id`, including the
    /// cycles of new connections. At most `cycles` cycles may wait.
    pub(super) fn read(&self, journal: &Journal, id: usize, cycles: Option<usize>) {
        journal.read(Reader {
            track: id,
            entries: self.entries.clone(),
            cycles,
        });
    }

    /// Begins the track `id` with this state, and sends everything that is written to `journal`
    /// from now on to that track. States may be a tenth of a second apart. Because of the first
    /// state, entries before the next one belong to a state, too. Returns true if the track is new.
    pub(super) fn read_device(&self, journal: &Journal, state: What, id: usize) -> bool {
        if journal.is_read(id, &self.entries) {
            return false;
        }
        self.entries.send(id, Entry::now(state));
        self.read(journal, id, None);
        true
    }

    /// Reads or changes the tracks, while the thread waits.
    pub(super) fn with<T>(&self, act: impl FnOnce(&mut Tracks) -> T) -> T {
        self.shared.with(act)
    }

    /// Records `event` for the robot with this name, or for all robots, after all journal entries
    /// from before the call.
    pub(super) fn tell(&self, name: Option<&str>, event: &EventKind) {
        let wanted = |(id, recorded): (&usize, &Recorded)| {
            let is_wanted = name.is_none_or(|name| name == recorded.track.name);
            is_wanted.then_some(*id)
        };
        let ids: Vec<_> = self.with(|tracks| tracks.iter().filter_map(wanted).collect());
        for id in ids {
            let entry = Entry::now(What::Told(Box::new(event.clone())));
            self.entries.send(id, entry);
        }
    }

    pub(super) fn lost(&self) -> u64 {
        self.entries.lost()
    }

    /// Waits until everything that was written before the call is passed on, and ends the thread.
    /// Returns how many entries were lost.
    pub(super) fn finish(mut self) -> u64 {
        self.entries.send(usize::MAX, Entry::now(What::End));
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            tracing::error!("the thread that records events panicked");
        }
        self.lost()
    }
}

impl Drop for EntryQueue {
    fn drop(&mut self) {
        self.entries.send(usize::MAX, Entry::now(What::End));
    }
}

impl Shared {
    fn with<T>(&self, act: impl FnOnce(&mut Tracks) -> T) -> T {
        // After a panic in `act`, there is at most one track too many or too few.
        act(&mut self.tracks.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Passes entries on until the queue ends.
    fn write(&self, queue: &EntryReceiver) {
        while let Some((id, entry)) = queue.next() {
            if matches!(entry.what, What::End) {
                break;
            }
            self.with(|tracks| {
                if let Some(recorded) = tracks.get(&id) {
                    recorded.write(entry);
                }
            });
        }
    }
}

impl Recorded {
    fn write(&self, Entry { at, what }: Entry) {
        let time = self.handle.clock().at(at);
        let event = match what {
            What::Goal(given) => words::goal(&given),
            What::Ended { goal, outcome } => {
                self.handle.event_at(time, words::outcome(goal, &outcome));
                match words::diagnosis(goal, &outcome) {
                    Some(diagnosis) => diagnosis,
                    None => return,
                }
            }
            What::Event(event) => match words::happening(&event) {
                Some(event) => event,
                None => return,
            },
            What::Connected(Ok(cycles)) => return self.handle.resume(cycles),
            What::Connected(Err(error)) => {
                let text = format!("cannot record the cycles of the new connection: {error}");
                words::note(Level::Error, "recorder", text)
            }
            What::Answered { request, error } => words::request(&request, error),
            What::Hand { request, ended } => words::hand(&request, ended),
            What::Vacuum { request, ended } => words::vacuum(&request, ended),
            What::HandState(state) => {
                return self.handle.gripper_at(time, GripperState::Hand(state));
            }
            What::VacuumState(state) => {
                return self.handle.gripper_at(time, GripperState::Vacuum(state));
            }
            What::Remark(text) => words::note(Level::Info, "program", text),
            What::Told(event) => *event,
            What::End => return,
        };
        self.handle.event_at(time, event);
    }
}

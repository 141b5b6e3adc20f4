//! The thread that writes events to the file, and its queue.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::cassette::{CassetteError, CassetteWriter, Device, Event, Payload, Side};

type Writer = CassetteWriter<BufWriter<File>>;
type Outcome = Result<(u64, u64), CassetteError>;

/// The thread that writes the file.
#[derive(Debug)]
pub(super) struct Journal {
    recorder: Recorder,
    thread: JoinHandle<Outcome>,
}

/// Sender of one lane's events to the journal.
#[derive(Clone, Debug)]
pub(super) struct Recorder {
    start: Instant,
    notes: SyncSender<Note>,
}

/// One lane: a transport of a connection in one direction. Its events are recorded.
#[derive(Debug)]
pub(super) struct Lane {
    recorder: Recorder,
    source: Source,
    missing: u32,
}

/// The connection, transport and direction of an event.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    pub(super) connection: usize,
    pub(super) device: Device,
    pub(super) from: Side,
    pub(super) stream: bool,
}

#[derive(Debug)]
struct Note {
    source: Source,
    /// Number of events directly before this event that did not fit into the queue.
    missing: u32,
    event: Option<Event>,
}

impl Journal {
    pub(super) fn start(writer: Writer) -> std::io::Result<Self> {
        let (notes, received) = sync_channel(QUEUE);
        let thread = std::thread::Builder::new()
            .name("tap journal".to_owned())
            .spawn(move || write(&received, writer))?;
        let recorder = Recorder {
            start: Instant::now(),
            notes,
        };
        Ok(Self { recorder, thread })
    }

    pub(super) fn recorder(&self) -> Recorder {
        self.recorder.clone()
    }

    /// Completes the file after all lanes are dropped. Returns the numbers of recorded and missing
    /// events.
    pub(super) fn finish(self) -> Outcome {
        drop(self.recorder);
        match self.thread.join() {
            Ok(outcome) => outcome,
            Err(_) => Err(std::io::Error::other("the journal's thread panicked").into()),
        }
    }
}

impl Recorder {
    pub(super) fn lane(&self, source: Source) -> Lane {
        Lane {
            recorder: self.clone(),
            source,
            missing: 0,
        }
    }
}

impl Lane {
    /// Returns the current time on the cassette's clock.
    pub(super) fn now(&self) -> Duration {
        self.recorder.start.elapsed()
    }

    /// Records an event. Drops and counts the event if the queue is full.
    pub(super) fn note(&mut self, at: Duration, what: Payload) {
        let from = self.source.from;
        let note = Note {
            source: self.source,
            missing: self.missing,
            event: Some(Event { at, from, what }),
        };
        match self.recorder.notes.try_send(note) {
            Ok(()) => self.missing = 0,
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {
                self.missing = self.missing.saturating_add(1);
            }
        }
    }
}

impl Drop for Lane {
    fn drop(&mut self) {
        if self.missing > 0 {
            // The lane has stopped forwarding, so this call may block. The journal may have ended
            // already.
            let _ = self.recorder.notes.send(Note {
                source: self.source,
                missing: self.missing,
                event: None,
            });
        }
    }
}

/// Writes events until all senders are dropped. After an error, it continues to receive events, so
/// that no sender blocks.
fn write(notes: &Receiver<Note>, mut writer: Writer) -> Outcome {
    let (mut events, mut dropped) = (0, 0);
    let mut flushed = Instant::now();
    let mut failure = None;
    let mut fresh = false;
    loop {
        let note = match notes.recv_timeout(FLUSH_INTERVAL) {
            Ok(note) => Some(note),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => break,
        };
        if failure.is_some() {
            continue;
        }
        let mut step = || {
            if let Some(note) = &note {
                fresh = true;
                dropped += u64::from(note.missing);
                events += u64::from(note.event.is_some());
                put(&mut writer, note)?;
            }
            if fresh && flushed.elapsed() >= FLUSH_INTERVAL {
                writer.flush()?;
                (flushed, fresh) = (Instant::now(), false);
            }
            Ok(())
        };
        failure = step().err();
    }
    match failure {
        Some(error) => Err(error),
        None => {
            let mut file = writer.finish()?;
            file.flush()?;
            Ok((events, dropped))
        }
    }
}

fn put(writer: &mut Writer, note: &Note) -> Result<(), CassetteError> {
    let Source {
        connection,
        device,
        from,
        stream,
    } = note.source;
    if note.missing > 0 {
        writer.note_dropped(connection, device, from, stream, note.missing)?;
    }
    match &note.event {
        Some(event) => writer.write(connection, device, event),
        None => Ok(()),
    }
}

/// Capacity of the queue, in events. It holds about two seconds of one robot in motion, and needs 7
/// MB at most.
const QUEUE: usize = 4096;

/// Interval of flushes. A power failure loses at most the events of this time.
const FLUSH_INTERVAL: Duration = Duration::from_secs(1);

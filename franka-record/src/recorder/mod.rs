//! Writes every cycle of robots, and their events, to files.
//!
//! ```text
//! control thread --ring of cycles--+
//!                                  +--> "franka-record": messages, chunks, last seconds --> "franka-disk": files
//! RecordHandle --bounded queue-----+
//! ```
//!
//! Both threads are ordinary threads. A slow disk delays only the second thread. Up to 64 MB wait
//! for the disk. Beyond that, the recorder drops cycles and data derived from them, and records
//! their number. Events have another 16 MB, and one file of the black box can wait. A disk failure
//! ends the recording, but does not affect anything else.

mod black_box;
mod disk;
mod drain;
mod encoder;
mod error;
mod files;
mod frames;
#[cfg(feature = "foxglove")]
mod live;
mod mcap_file;
mod options;
mod session;
#[cfg(test)]
mod tests;
mod thinning;

use core::time::Duration;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use franka_rt::thread::CycleReader;

use self::disk::{Disk, DiskStatus};
use self::drain::{Drain, DrainStatus, Order};
pub use self::error::RecordError;
#[cfg(feature = "foxglove")]
pub use self::live::Live;
pub use self::options::{Attachment, BlackBox, RecordOptions, Robot, Rotation};
pub use self::session::RecordClock;
use crate::{Event, EventKind, GripperState, HostTime};

/// Records robots to files, or keeps the last seconds before an incident, or both.
///
/// ```no_run
/// use franka_model::RobotKind;
/// use franka_record::recorder::{RecordOptions, Recorder, Robot};
/// # fn record(cycles: franka_rt::thread::CycleReader)
/// # -> Result<(), franka_record::recorder::RecordError> {
///
/// let recorder = Recorder::to_file("run.mcap", RecordOptions::default())?;
/// let handle = recorder.attach(Robot::new(RobotKind::Fr3), cycles)?;
/// handle.note("ready");
/// // ... the robot moves ...
/// let report = recorder.finish()?;
/// println!("{} cycles, {} dropped", report.cycles, report.dropped);
/// # Ok(())
/// # }
/// ```
///
/// The recorder cannot delay a cycle. Dropping it ends the recording in the background;
/// [`Recorder::finish`] does the same and waits for the end.
#[derive(Debug)]
pub struct Recorder {
    orders: SyncSender<Order>,
    clock: RecordClock,
    disk: Arc<Mutex<DiskStatus>>,
    drained: Arc<Mutex<DrainStatus>>,
    /// Ends when the last byte is written. The thread that finishes the recording locks it.
    done: Mutex<Receiver<()>>,
    /// The robots so far, by index.
    robots: Mutex<Vec<String>>,
}

impl Recorder {
    /// Starts a recording in a new file at `path`.
    ///
    /// # Errors
    /// [`RecordError::Exists`], [`RecordError::Create`] (the folder is missing or read-only),
    /// [`RecordError::Option`], [`RecordError::Thread`].
    pub fn to_file(path: impl AsRef<Path>, options: RecordOptions) -> Result<Self, RecordError> {
        Self::start(Some(path.as_ref()), options)
    }

    /// Keeps only the last seconds in memory. Writes them to a file after an incident has ended a
    /// motion.
    ///
    /// # Errors
    /// [`RecordError::Option`], [`RecordError::Thread`].
    pub fn black_box(black_box: BlackBox) -> Result<Self, RecordError> {
        let options = RecordOptions {
            black_box: Some(black_box),
            ..RecordOptions::default()
        };
        Self::start(None, options)
    }

    /// Records nothing to files, and serves the channels of a recording to Foxglove: see
    /// [`Self::serve`].
    ///
    /// # Errors
    /// The errors of [`Self::serve`], and [`RecordError::Thread`].
    #[cfg(feature = "foxglove")]
    pub fn live(live: &Live) -> Result<(Self, core::net::SocketAddr), RecordError> {
        let recorder = Self::start(None, RecordOptions::default())?;
        let address = recorder.serve(live)?;
        Ok((recorder, address))
    }

    fn start(path: Option<&Path>, options: RecordOptions) -> Result<Self, RecordError> {
        options.check()?;
        // The file is created here, so that the caller receives the error.
        let file = path.map(disk::create).transpose()?;
        Self::start_with(path, file, options, HostTime::now)
    }

    /// Starts a recording in `file`, which is at `path`. `wall` reads the wall clock.
    fn start_with(
        path: Option<&Path>,
        file: Option<File>,
        options: RecordOptions,
        wall: fn() -> HostTime,
    ) -> Result<Self, RecordError> {
        let (orders, queue) = mpsc::sync_channel(ORDERS_MAX);
        let (written, done) = mpsc::channel();
        let clock = RecordClock::start();
        let disk = Disk::start(options.sync, written)?;
        let disk_status = disk.status();
        let drained = Arc::<Mutex<DrainStatus>>::default();
        if let (Some(path), Some(file)) = (path, file) {
            disk.open(path.to_owned(), file);
        }
        let drain = Drain::new(
            queue,
            clock,
            options,
            path.map(Path::to_owned),
            disk,
            drained.clone(),
            wall,
        )?;
        thread::Builder::new()
            .name("franka-record".to_owned())
            .spawn(move || drain.run())
            .map_err(|source| RecordError::Thread {
                source: source.into(),
            })?;
        Ok(Self {
            orders,
            clock,
            disk: disk_status,
            drained,
            done: Mutex::new(done),
            robots: Mutex::default(),
        })
    }

    /// Records `robot` with its `cycles`, until the robot's control thread or the recording ends.
    /// Pass all other data to the returned handle.
    ///
    /// # Errors
    /// [`RecordError::SameName`], [`RecordError::Option`] for an invalid name, and
    /// [`RecordError::Ended`].
    pub fn attach(&self, robot: Robot, cycles: CycleReader) -> Result<RecordHandle, RecordError> {
        robot.check()?;
        let mut robots = lock(&self.robots);
        if robots.contains(&robot.name) {
            return Err(RecordError::SameName { name: robot.name });
        }
        let index = robots.len();
        let name = robot.name.clone();
        let order = Order::Attach(Box::new((robot, cycles)));
        self.orders.send(order).map_err(|_| RecordError::Ended)?;
        robots.push(name);
        Ok(RecordHandle {
            orders: self.orders.clone(),
            clock: self.clock,
            drained: self.drained.clone(),
            robot: index,
        })
    }

    /// Serves the channels of the recording from now on, until the recording ends. Viewers are
    /// Foxglove ("Open connection", "Foxglove WebSocket") and other clients that speak
    /// `foxglove.sdk.v1`. Returns the address; the system chooses the port if the requested port is
    /// 0. A viewer that is too slow loses messages, but the recording does not. This blocks until
    /// the server listens.
    ///
    /// # Errors
    /// [`RecordError::Live`] if the server cannot listen at this address, [`RecordError::Option`],
    /// [`RecordError::Ended`].
    #[cfg(feature = "foxglove")]
    pub fn serve(&self, live: &Live) -> Result<core::net::SocketAddr, RecordError> {
        let (server, address) = live::Server::start(live)?;
        let order = Order::Serve(Box::new(server));
        self.orders.send(order).map_err(|_| RecordError::Ended)?;
        Ok(address)
    }

    /// Returns the clock of recorded time.
    pub fn clock(&self) -> RecordClock {
        self.clock
    }

    /// Returns the progress of the recording, and its failures.
    pub fn status(&self) -> RecordStatus {
        let disk = lock(&self.disk).clone();
        let drained = *lock(&self.drained);
        RecordStatus {
            cycles: drained.cycles,
            dropped: drained.dropped + disk.cycles_lost,
            events_dropped: drained.events_dropped,
            bytes: disk.written,
            waiting: disk.backlog,
            files: disk.files,
            black_boxes: disk.black_boxes,
            error: disk.error,
            black_box_error: disk.black_box_error,
        }
    }

    /// Ends the recording and waits until everything is on the disk, at most 10 s.
    ///
    /// # Errors
    /// The errors of [`Recorder::finish_within`].
    pub fn finish(self) -> Result<RecordStatus, RecordError> {
        self.finish_within(FINISH_MAX)
    }

    /// Ends the recording and waits, up to `limit`, until everything is on the disk.
    ///
    /// # Errors
    /// [`RecordError::Unfinished`] if the disk was too slow, and [`RecordError::Write`] or another
    /// error if the file could not be completed. The written data is readable.
    pub fn finish_within(self, limit: Duration) -> Result<RecordStatus, RecordError> {
        lock(&self.drained).finish = true;
        // Wakes the thread. If the queue is full, the thread is already awake.
        let _ = self.orders.try_send(Order::Finish);
        match lock(&self.done).recv_timeout(limit) {
            Ok(()) | Err(RecvTimeoutError::Disconnected) => {}
            Err(RecvTimeoutError::Timeout) => return Err(RecordError::Unfinished { limit }),
        }
        let status = self.status();
        match status.error {
            Some(error) => Err(error),
            // The thread has panicked.
            None if !lock(&self.drained).ended => Err(RecordError::Ended),
            None => Ok(status),
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        lock(&self.drained).finish = true;
    }
}

/// Progress of a recording, and its failures.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RecordStatus {
    /// Number of cycles received, of all robots.
    pub cycles: u64,
    /// Number of cycles for which there was no space: in the ring, because this host was busy, or
    /// in memory or on the disk. The file records where cycles are missing, unless the recording
    /// ended before.
    pub dropped: u64,
    /// Number of events for which there was no space.
    pub events_dropped: u64,
    /// Number of bytes in the files of the recording.
    pub bytes: u64,
    /// Number of bytes that wait for the disk.
    pub waiting: u64,
    /// The files of the recording, oldest first.
    pub files: Vec<PathBuf>,
    /// The written files of the black box.
    pub black_boxes: Vec<PathBuf>,
    /// Error that ended the recording early.
    pub error: Option<RecordError>,
    /// Error that occurred when the newest black box was written.
    pub black_box_error: Option<RecordError>,
}

/// Handle that accepts the data of one robot other than cycles. It is cheap to clone. Only
/// [`Self::resume`] may wait: data for which there is no space is dropped and counted.
#[derive(Clone, Debug)]
pub struct RecordHandle {
    orders: SyncSender<Order>,
    clock: RecordClock,
    drained: Arc<Mutex<DrainStatus>>,
    robot: usize,
}

impl RecordHandle {
    /// Returns the clock of recorded time.
    pub fn clock(&self) -> RecordClock {
        self.clock
    }

    /// Continues with the cycles of a new control thread of the same robot, after a reconnect. The
    /// recorder first reads all previous cycles. Does nothing if the newest cycles are already from
    /// this thread. Waits while the recorder's queue is full.
    pub fn resume(&self, cycles: CycleReader) {
        // Fails if the recording has ended.
        let _ = self
            .orders
            .send(Order::Resume(self.robot, Box::new(cycles)));
    }

    /// Records an event at the current time.
    pub fn event(&self, kind: EventKind) {
        self.event_at(self.clock.now(), kind);
    }

    /// Records an event at `time`.
    pub fn event_at(&self, time: HostTime, kind: EventKind) {
        let event = Event {
            time,
            robot_time: 0,
            kind,
        };
        self.order(Order::Event(self.robot, Box::new(event)));
    }

    /// Records a remark of the program.
    pub fn note(&self, text: impl Into<String>) {
        self.event(EventKind::Note(crate::event::Note {
            source: "program".to_owned(),
            text: text.into(),
            ..Default::default()
        }));
    }

    /// Records a state of the gripper with the current time.
    pub fn gripper(&self, state: GripperState) {
        self.gripper_at(self.clock.now(), state);
    }

    /// Records a state of the gripper that this host received at `time`.
    pub fn gripper_at(&self, time: HostTime, state: GripperState) {
        self.order(Order::Gripper(self.robot, time, state));
    }

    /// True if the recording has ended. Data passed to this handle is then dropped.
    pub fn has_ended(&self) -> bool {
        lock(&self.drained).ended
    }

    fn order(&self, order: Order) {
        if self.orders.try_send(order).is_err() {
            lock(&self.drained).events_dropped += 1;
        }
    }
}

/// Capacity of the recorder's queue. The recorder polls it 50 times a second.
const ORDERS_MAX: usize = 4096;

const FINISH_MAX: Duration = Duration::from_secs(10);

/// Locks the status. Ordinary threads hold the lock only for a few assignments.
fn lock<T>(status: &Mutex<T>) -> MutexGuard<'_, T> {
    status.lock().unwrap_or_else(PoisonError::into_inner)
}

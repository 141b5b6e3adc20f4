//! Records every cycle and every event of one or more robots to files.
//!
//! ```text
//! control thread --ring of cycles--+
//!                                  +--> "franka-record": messages, chunks, last seconds --> "franka-disk": files
//! RecordHandle --bounded queue-----+
//! ```
//!
//! Both threads are ordinary threads, and a slow disk delays only the second thread. At most 64 MB
//! of data wait for the disk. Beyond this limit, the recorder drops cycles and data derived from
//! them, and records the number of dropped cycles. Another 16 MB are reserved for events, and one
//! black box file can wait. A disk failure ends the recording, but does not affect anything else.

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

/// Recorder that writes the data of robots to files, keeps the last seconds before an incident, or
/// does both.
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
/// The recorder cannot delay a cycle. When you drop the recorder, the recording ends in the
/// background; [`Recorder::finish`] ends the recording and waits until the files are complete.
#[derive(Debug)]
pub struct Recorder {
    orders: SyncSender<Order>,
    clock: RecordClock,
    disk: Arc<Mutex<DiskStatus>>,
    drained: Arc<Mutex<DrainStatus>>,
    /// The channel closes after the last byte is written. The thread that finishes the recording
    /// locks the receiver.
    done: Mutex<Receiver<()>>,
    /// Names of all robots attached so far, by index.
    robots: Mutex<Vec<String>>,
}

impl Recorder {
    /// Starts a recording in a new file at `path`.
    ///
    /// # Errors
    /// Returns [`RecordError::Exists`] if a file exists at `path`, and [`RecordError::Create`] if
    /// the file cannot be created, for example because the folder is missing or read-only.
    /// Returns [`RecordError::Option`] if an option is invalid, and [`RecordError::Thread`] if a
    /// thread cannot be started.
    pub fn to_file(path: impl AsRef<Path>, options: RecordOptions) -> Result<Self, RecordError> {
        Self::start(Some(path.as_ref()), options)
    }

    /// Creates a recorder that keeps only the last seconds in memory. The recorder writes these
    /// seconds to a file after an incident has ended a motion.
    ///
    /// # Errors
    /// Returns [`RecordError::Option`] if an option is invalid, and [`RecordError::Thread`] if a
    /// thread cannot be started.
    pub fn black_box(black_box: BlackBox) -> Result<Self, RecordError> {
        let options = RecordOptions {
            black_box: Some(black_box),
            ..RecordOptions::default()
        };
        Self::start(None, options)
    }

    /// Creates a recorder that writes no files, and serves the channels of a recording to Foxglove
    /// (see [`Self::serve`]).
    ///
    /// # Errors
    /// Returns the errors of [`Self::serve`], and [`RecordError::Thread`] if a thread cannot be
    /// started.
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

    /// Starts a recording in `file`, whose path is `path`. The function `wall` reads the wall
    /// clock.
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

    /// Records the `cycles` of `robot` until the robot's control thread ends or the recording ends.
    /// Pass all other data of the robot to the returned handle.
    ///
    /// # Errors
    /// Returns [`RecordError::SameName`] if a robot with this name is attached,
    /// [`RecordError::Option`] if the name is invalid, and [`RecordError::Ended`] if the recording
    /// has ended.
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

    /// Starts a server for the channels of the recording, and returns its address. The server runs
    /// until the recording ends. Foxglove ("Open connection", "Foxglove WebSocket") and other
    /// clients that support `foxglove.sdk.v1` can connect to it. If the requested port is 0, the
    /// system chooses a port.
    ///
    /// A slow viewer loses messages, but the recording does not. This method blocks until the
    /// server listens.
    ///
    /// # Errors
    /// Returns [`RecordError::Live`] if the server cannot listen at this address,
    /// [`RecordError::Option`] if an option is invalid, and [`RecordError::Ended`] if the recording
    /// has ended.
    #[cfg(feature = "foxglove")]
    pub fn serve(&self, live: &Live) -> Result<core::net::SocketAddr, RecordError> {
        let (server, address) = live::Server::start(live)?;
        let order = Order::Serve(Box::new(server));
        self.orders.send(order).map_err(|_| RecordError::Ended)?;
        Ok(address)
    }

    /// Returns the clock that dates the recorded data.
    pub fn clock(&self) -> RecordClock {
        self.clock
    }

    /// Returns the progress and the failures of the recording.
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

    /// Ends the recording, and waits at most 10 s until all data is on the disk.
    ///
    /// # Errors
    /// Returns the errors of [`Recorder::finish_within`].
    pub fn finish(self) -> Result<RecordStatus, RecordError> {
        self.finish_within(FINISH_MAX)
    }

    /// Ends the recording, and waits at most `limit` until all data is on the disk.
    ///
    /// # Errors
    /// Returns [`RecordError::Unfinished`] if the disk was too slow, and [`RecordError::Write`] or
    /// another error if the file could not be completed. The data written so far remains readable.
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

/// Progress and failures of a recording.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RecordStatus {
    /// Total number of received cycles of all robots.
    pub cycles: u64,
    /// Number of dropped cycles. A cycle is dropped if the ring is full because this host was busy,
    /// or if there is no space in memory or on the disk. The file shows where cycles are missing,
    /// unless the recording ended earlier.
    pub dropped: u64,
    /// Number of events that were dropped because there was no space.
    pub events_dropped: u64,
    /// Number of bytes in the files of the recording.
    pub bytes: u64,
    /// Number of bytes that have not been written to the disk yet.
    pub waiting: u64,
    /// The files of the recording, oldest first.
    pub files: Vec<PathBuf>,
    /// Black box files written so far.
    pub black_boxes: Vec<PathBuf>,
    /// Error that ended the recording early.
    pub error: Option<RecordError>,
    /// Error that prevented the newest black box file from being written.
    pub black_box_error: Option<RecordError>,
}

/// Handle that accepts all data of one robot except its cycles. Clones are cheap. Only
/// [`Self::resume`] may wait. All other methods drop and count data for which there is no space.
#[derive(Clone, Debug)]
pub struct RecordHandle {
    orders: SyncSender<Order>,
    clock: RecordClock,
    drained: Arc<Mutex<DrainStatus>>,
    robot: usize,
}

impl RecordHandle {
    /// Returns the clock that dates the recorded data.
    pub fn clock(&self) -> RecordClock {
        self.clock
    }

    /// Continues with the cycles of a new control thread of the same robot, for example after a
    /// reconnect. The recorder first reads all cycles of the previous thread. This method does
    /// nothing if the recorder already reads the cycles of the new thread. It blocks while the
    /// recorder's queue is full.
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

    /// Records a remark of the program, dated with the current time.
    pub fn note(&self, text: impl Into<String>) {
        self.event(EventKind::Note(crate::event::Note {
            source: "program".to_owned(),
            text: text.into(),
            ..Default::default()
        }));
    }

    /// Records a gripper state, dated with the current time.
    pub fn gripper(&self, state: GripperState) {
        self.gripper_at(self.clock.now(), state);
    }

    /// Records a gripper state that this host received at `time`.
    pub fn gripper_at(&self, time: HostTime, state: GripperState) {
        self.order(Order::Gripper(self.robot, time, state));
    }

    /// Returns true if the recording has ended. The recorder drops data that is passed to this
    /// handle afterwards.
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

//! Recordings of robots: every cycle, and the requests with their results, in files that viewers
//! can open.
//!
//! ```text
//! control thread --ring--------------+
//! goals, outcomes, events, requests -+--> Recorder (ordinary threads) --> MCAP file, black box
//! gripper: actions, states ----------+
//! ```
//!
//! ```no_run
//! use franka_async::recording::{RecordOptions, Recorder, Track};
//! # use franka_async::Robot;
//!
//! # async fn run(robot: Robot) -> Result<(), Box<dyn std::error::Error>> {
//! let recorder = Recorder::to_file("run.mcap", RecordOptions::default())?;
//! recorder.attach(&robot, Track::default()).await?;
//! robot.move_joints([0.0, -0.8, 0.0, -2.4, 0.0, 1.6, 0.8]).await?;
//! let status = recorder.finish()?;
//! println!("{} cycles, {} dropped", status.cycles, status.dropped);
//! # Ok(())
//! # }
//! ```
//!
//! The cycles pass through no task on their way into the file, and the recorder cannot delay a
//! cycle. Cycles that find no room are dropped and counted, and the count is recorded.

mod entries;
mod words;

use std::collections::BTreeMap;
#[cfg(feature = "foxglove")]
use std::net::SocketAddr;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

use franka_model::RobotKind;
use franka_record::event::{EventKind, Level};
use franka_record::recorder;
use franka_rt::thread::{AttachError, CycleFeed};

#[cfg(feature = "foxglove")]
pub use franka_record::recorder::Live;
pub use franka_record::recorder::{
    Attachment, BlackBox, RecordError, RecordOptions, RecordStatus, Rotation,
};
pub use franka_record::recording::{RecordedRobot, RecordingError, RobotRecording};
pub use franka_record::{
    Cycle, Episode, EpisodeError, GripperState, HostTime, ModelFallback, RecordedModel, Recording,
    Sample, Samples, control_log, event,
};

use crate::gripper::Gripper;
use crate::journal::{Journal, What};
use crate::robot::Robot;
use crate::team::Team;
use crate::vacuum::VacuumGripper;
use entries::{EntryQueue, Recorded};

/// Records robots to files, or keeps only the last seconds before an incident, or both.
///
/// A recorder records the [attached](Self::attach) robots until it is finished or dropped, or the
/// robots are gone. It continues with a supervised robot after a reconnect. Dropping the recorder
/// ends the recording in the background, and the newest events may be lost. Motions under way
/// continue.
#[derive(Debug)]
pub struct Recorder {
    entries: EntryQueue,
    inner: recorder::Recorder,
    next: AtomicUsize,
}

/// Options for the recording of a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Track {
    /// Name of the robot in the recording: letters, digits, `-` and `_`. It is empty by default,
    /// which is enough if the recording has only one robot.
    pub name: String,
    /// True if the metadata contains the robot's network address. It is false by default, because
    /// recordings are often passed on.
    pub with_address: bool,
    /// Number of cycles that may wait for the recorder; by default, the cycles of 4 s.
    pub capacity: usize,
}

impl Default for Track {
    fn default() -> Self {
        Self {
            name: String::new(),
            with_address: false,
            capacity: CycleFeed::<()>::DEFAULT_CAPACITY,
        }
    }
}

impl Track {
    /// Returns the default options with this name.
    pub fn named(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..Self::default()
        }
    }
}

/// Error of the caller or the host: a robot or an end effector is not recorded.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrackError {
    /// The control thread provides no cycles.
    #[error(transparent)]
    Cycles(#[from] AttachError),
    /// The recorder does not accept the robot or the end effector.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The robot of an end effector is not attached.
    #[error("no robot named {name:?} is attached to the recorder: attach the robot first")]
    Unknown {
        /// The name that was given.
        name: String,
    },
    /// The recording already has an end effector of this kind for the robot.
    #[error("this end effector is already recorded with the robot {name:?}")]
    Attached {
        /// The robot's name.
        name: String,
    },
}

impl Recorder {
    /// Begins a recording in a new file at `path`.
    ///
    /// # Errors
    /// Returns [`RecordError`] if the file already exists, if its folder is missing or read-only,
    /// if an option is out of range, or if no thread can be started.
    pub fn to_file(path: impl AsRef<Path>, options: RecordOptions) -> Result<Self, RecordError> {
        Self::around(recorder::Recorder::to_file(path, options)?)
    }

    /// Keeps only the last seconds, in memory, and writes them to a file when a reflex, a lost link
    /// or a guard ends a motion.
    ///
    /// # Errors
    /// See [`Self::to_file`].
    pub fn black_box(black_box: BlackBox) -> Result<Self, RecordError> {
        Self::around(recorder::Recorder::black_box(black_box)?)
    }

    /// Returns a recorder that writes no file, and instead serves the recording to Foxglove: see
    /// [`Self::serve`]. Also returns the address of the server.
    ///
    /// # Errors
    /// See [`Self::serve`].
    #[cfg(feature = "foxglove")]
    pub fn live(live: &Live) -> Result<(Self, SocketAddr), RecordError> {
        let (inner, address) = recorder::Recorder::live(live)?;
        Ok((Self::around(inner)?, address))
    }

    /// Serves the channels of the recording to Foxglove ("Open connection", "Foxglove WebSocket"),
    /// from now until the recording ends. Returns the address of the server. A viewer that is too
    /// slow loses messages, but the recording loses none because of it. This call blocks until the
    /// server listens.
    ///
    /// # Errors
    /// Returns [`RecordError::Live`] if the server cannot listen at its address,
    /// [`RecordError::Option`] if an option is out of range, and [`RecordError::Ended`] if the
    /// recording has ended.
    #[cfg(feature = "foxglove")]
    pub fn serve(&self, live: &Live) -> Result<SocketAddr, RecordError> {
        self.inner.serve(live)
    }

    fn around(inner: recorder::Recorder) -> Result<Self, RecordError> {
        Ok(Self {
            entries: EntryQueue::start()?,
            inner,
            next: AtomicUsize::new(0),
        })
    }

    /// Records this robot from now on. The recording contains every cycle, the goals and their
    /// ends, the diagnosis of a reflex, the events of the supervision, and the requests from all
    /// handles of the robot. A Franka Research 3 is asked for its description, which is attached to
    /// the file.
    ///
    /// # Errors
    /// Returns [`TrackError`] if the recording already has a robot of that name, if it has ended,
    /// or if the robot has no connection or no free place for a reader.
    ///
    /// # Cancel safety
    /// Nothing is recorded if the future is dropped.
    pub async fn attach(&self, robot: &Robot, track: Track) -> Result<(), TrackError> {
        // Without a description, only the arm in viewers is missing.
        let urdf = match robot.model().kind() {
            RobotKind::Fer => Ok(String::new()),
            _ => robot.urdf().await,
        };
        let refused = urdf.as_ref().err().map(ToString::to_string);
        let described = recorder::Robot {
            name: track.name.clone(),
            kind: robot.model().kind(),
            lengths: *robot.model().lengths(),
            urdf: urdf.ok().filter(|text| !text.is_empty()),
            metadata: metadata(robot, &track),
            // The next request may come before the first cycle.
            robot_time: robot.state().message_id,
        };
        let id = self.next.fetch_add(1, Ordering::Relaxed);
        self.entries.with(|tracks| {
            // Entries with this identifier wait until the lock is free. Each connection that is
            // made after this line is announced by an entry.
            let capacity = Some(track.capacity);
            self.entries
                .read(&robot.supervisor().journal(), id, capacity);
            let cycles = robot.cycles(track.capacity)?;
            let handle = self.inner.attach(described, cycles)?;
            if let Some(refused) = refused {
                let text = format!("recording without a description of the robot: {refused}");
                handle.event(words::note(Level::Warning, "recorder", text));
            }
            tracks.insert(id, Recorded { handle, track });
            Ok(())
        })
    }

    /// Records the arms of a team, each as [`Self::attach`] does. A remark in the recording states
    /// the number of each arm in the team.
    ///
    /// # Errors
    /// Returns the errors of [`Self::attach`]. Members before the failed member stay attached.
    ///
    /// # Cancel safety
    /// If the future is dropped, some members may be attached.
    pub async fn attach_team<const N: usize>(
        &self,
        team: &Team<N>,
        tracks: [Track; N],
    ) -> Result<(), TrackError> {
        let names = tracks.each_ref().map(|track| track.name.clone());
        for (member, (arm, track)) in team.arms().iter().zip(tracks).enumerate() {
            let name = track.name.clone();
            self.attach(arm.robot(), track).await?;
            let text = format!("member {member} of the team of {}", names.join(", "));
            let note = words::note(Level::Info, "team", text);
            self.entries.tell(Some(&name), &note);
        }
        Ok(())
    }

    /// Records a Franka Hand as part of the robot with this name. The recording contains the newest
    /// state, all later states, and each action when it has ended.
    ///
    /// # Errors
    /// Returns [`TrackError::Unknown`] if no such robot is attached, and [`TrackError::Attached`]
    /// if the robot already has a recorded Hand.
    pub fn attach_gripper(&self, gripper: &Gripper, robot: &str) -> Result<(), TrackError> {
        let state = What::HandState(gripper.state());
        self.attach_device(gripper.journal(), state, robot)
    }

    /// Records a vacuum gripper as part of the robot with this name, as [`Self::attach_gripper`]
    /// does.
    ///
    /// # Errors
    /// See [`Self::attach_gripper`].
    pub fn attach_vacuum_gripper(
        &self,
        gripper: &VacuumGripper,
        robot: &str,
    ) -> Result<(), TrackError> {
        let state = What::VacuumState(gripper.state());
        self.attach_device(gripper.journal(), state, robot)
    }

    fn attach_device(&self, journal: &Journal, state: What, robot: &str) -> Result<(), TrackError> {
        let id = self.entries.with(|tracks| {
            let mut tracks = tracks.iter();
            let found = tracks.find(|(_, recorded)| recorded.track.name == robot);
            found.map(|(id, _)| *id)
        });
        let id = id.ok_or_else(|| TrackError::Unknown { name: robot.into() })?;
        let attached = self.entries.read_device(journal, state, id);
        attached
            .then_some(())
            .ok_or_else(|| TrackError::Attached { name: robot.into() })
    }

    /// Records a remark that applies to all robots.
    pub fn note(&self, text: impl Into<String>) {
        let note = words::note(Level::Info, "program", text.into());
        self.entries.tell(None, &note);
    }

    /// Records that an episode begins, with its name and its task.
    ///
    /// # Errors
    /// Returns [`EpisodeError`] if [`Episode::check`] fails; nothing is recorded then.
    pub fn begin_episode(
        &self,
        name: impl Into<String>,
        task: impl Into<String>,
    ) -> Result<(), EpisodeError> {
        let (name, task) = (name.into(), task.into());
        Episode::check(&name, &task)?;
        let begin = EventKind::EpisodeStart { name, task };
        self.entries.tell(None, &begin);
        Ok(())
    }

    /// Records that the episode ends, and whether the task was done, if that is known.
    pub fn end_episode(&self, success: Option<bool>) {
        self.entries.tell(None, &EventKind::EpisodeEnd { success });
    }

    /// Returns how much was recorded so far, and the failures.
    pub fn status(&self) -> RecordStatus {
        let mut status = self.inner.status();
        status.events_dropped += self.entries.lost();
        status
    }

    /// Ends the recording and waits until everything that happened before the call is on the disk,
    /// at most 10 s. This call blocks: in async code, use [`tokio::task::spawn_blocking`].
    ///
    /// # Errors
    /// Returns [`RecordError`] if the files could not be written completely. The part that was
    /// written is readable.
    pub fn finish(self) -> Result<RecordStatus, RecordError> {
        let Self { entries, inner, .. } = self;
        let lost = entries.finish();
        let mut status = inner.finish()?;
        status.events_dropped += lost;
        Ok(status)
    }
}

fn metadata(robot: &Robot, track: &Track) -> BTreeMap<String, String> {
    let granted = robot.granted();
    let refusals: Vec<_> = granted.refusals.iter().map(ToString::to_string).collect();
    let priority = granted.priority.map(|priority| priority.to_string());
    let mut metadata = BTreeMap::from([
        ("driver".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
        ("protocol".to_owned(), robot.version().number().to_string()),
        ("priority".to_owned(), priority.unwrap_or("none".to_owned())),
        ("realtime_refused".to_owned(), refusals.join("; ")),
    ]);
    if track.with_address {
        metadata.insert("address".to_owned(), robot.address().to_string());
    }
    metadata
}

//! Recordings of robots: every cycle, the requests and their results, in files that viewers open.
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
//! No task of a runtime handles a cycle on its way into the file, and the recorder cannot delay a
//! cycle. Cycles without room are dropped and counted, and the count is recorded.

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

/// Records robots to files, or the last seconds before an incident, or both.
///
/// A recorder records the robots that are [attached](Self::attach), until it is finished or dropped
/// or the robots are gone. It records a supervised robot after a reconnect, too. Dropping the
/// recorder ends the recording in the background, perhaps without the newest events. A motion under
/// way continues.
#[derive(Debug)]
pub struct Recorder {
    entries: EntryQueue,
    inner: recorder::Recorder,
    next: AtomicUsize,
}

/// Options for the recording of a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Track {
    /// Name of the robot in the recording: letters, digits, `-` and `_`. Empty by default, which is
    /// enough for the only robot of a recording.
    pub name: String,
    /// True if the metadata has the robot's network address; off by default, because recordings are
    /// often passed on.
    pub with_address: bool,
    /// Number of cycles that may wait for the recorder; 4 s of cycles by default.
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

/// Caller or host: a robot or an end effector is not recorded.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrackError {
    /// The control thread provides no cycles.
    #[error(transparent)]
    Cycles(#[from] AttachError),
    /// The recorder does not accept the robot or the end effector.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// An end effector belongs to a robot that is not attached.
    #[error("no robot named {name:?} is attached to the recorder: attach the robot first")]
    Unknown {
        /// The name that was given.
        name: String,
    },
    /// The robot has a recorded end effector of this kind already.
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
    /// [`RecordError`]: the file exists already, its folder is missing or read-only, an option is
    /// out of range, or no thread can be started.
    pub fn to_file(path: impl AsRef<Path>, options: RecordOptions) -> Result<Self, RecordError> {
        Self::around(recorder::Recorder::to_file(path, options)?)
    }

    /// Keeps the last seconds in memory only, and writes them to a file when a motion ends by a
    /// reflex, by a lost link or by a guard.
    ///
    /// # Errors
    /// As [`Self::to_file`].
    pub fn black_box(black_box: BlackBox) -> Result<Self, RecordError> {
        Self::around(recorder::Recorder::black_box(black_box)?)
    }

    /// Returns a recorder that writes no file and serves the content of a recording to Foxglove:
    /// see [`Self::serve`]. Also returns the address of the server.
    ///
    /// # Errors
    /// As [`Self::serve`].
    #[cfg(feature = "foxglove")]
    pub fn live(live: &Live) -> Result<(Self, SocketAddr), RecordError> {
        let (inner, address) = recorder::Recorder::live(live)?;
        Ok((Self::around(inner)?, address))
    }

    /// Serves the channels of the recording from now on, until it ends, to Foxglove ("Open
    /// connection", "Foxglove WebSocket"). Returns the address of the server. A viewer that is too
    /// slow loses messages; the recording loses none because of it. Blocks until the server
    /// listens.
    ///
    /// # Errors
    /// [`RecordError::Live`] if the server cannot listen there, [`RecordError::Option`] for an
    /// option out of range, [`RecordError::Ended`].
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

    /// Records this robot from now on. The recording has every cycle, goals and their ends, with
    /// the diagnosis of a reflex, events of the supervision, and requests from all of the robot's
    /// handles. The description of a Franka Research 3 is requested and attached to the file.
    ///
    /// # Errors
    /// [`TrackError`]: the recording has a robot of that name, the recording has ended, or the
    /// robot has no connection or its full number of readers.
    ///
    /// # Cancel safety
    /// Nothing is recorded if the future is dropped.
    pub async fn attach(&self, robot: &Robot, track: Track) -> Result<(), TrackError> {
        // Without a description the recording lacks only the arm in viewers.
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
            // Entries of this id wait until the lock is free. An entry announces each connection
            // that is made after this line.
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

    /// Records the arms of a team, each as [`Self::attach`] does, and the member number of each.
    ///
    /// # Errors
    /// As [`Self::attach`]. Members before the failed one are attached.
    ///
    /// # Cancel safety
    /// Dropping the future leaves members attached.
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

    /// Records a Franka Hand with the robot of this name: its states, the newest one at once, and
    /// actions when they have ended.
    ///
    /// # Errors
    /// [`TrackError::Unknown`], [`TrackError::Attached`].
    pub fn attach_gripper(&self, gripper: &Gripper, robot: &str) -> Result<(), TrackError> {
        let state = What::HandState(gripper.state());
        self.attach_device(gripper.journal(), state, robot)
    }

    /// Records a vacuum gripper with the robot of this name, as [`Self::attach_gripper`] does.
    ///
    /// # Errors
    /// [`TrackError::Unknown`], [`TrackError::Attached`].
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

    /// Records a remark, for all robots.
    pub fn note(&self, text: impl Into<String>) {
        let note = words::note(Level::Info, "program", text.into());
        self.entries.tell(None, &note);
    }

    /// Records that an episode begins: its name, and its task.
    ///
    /// # Errors
    /// [`EpisodeError`], by [`Episode::check`]: nothing is recorded then.
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

    /// Records that the episode ends, and whether the task was done, if known.
    pub fn end_episode(&self, success: Option<bool>) {
        self.entries.tell(None, &EventKind::EpisodeEnd { success });
    }

    /// Returns the amount recorded so far, and failures.
    pub fn status(&self) -> RecordStatus {
        let mut status = self.inner.status();
        status.events_dropped += self.entries.lost();
        status
    }

    /// Ends the recording and waits, 10 s at most, until everything that happened before the call
    /// is on the disk. Blocks: in async code, call it by [`tokio::task::spawn_blocking`] where
    /// other tasks must not wait.
    ///
    /// # Errors
    /// [`RecordError`] if the files could not be written to their end. The written part is
    /// readable.
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

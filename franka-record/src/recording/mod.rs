//! Reads recordings.
//!
//! ```no_run
//! use franka_record::Recording;
//!
//! let recording = Recording::open("run.mcap")?;
//! if let Some(damage) = recording.damage() {
//!     println!("{damage}");
//! }
//! let (begin, _) = recording.span().unwrap_or_default();
//! let robot = recording.robot("")?;
//! for cycle in robot.from(begin + std::time::Duration::from_secs(60)).cycles() {
//!     let cycle = cycle?;
//!     println!("{} {:.3?}", cycle.time, cycle.state.q);
//! }
//! for event in robot.events() {
//!     let event = event?;
//!     println!("{} {}", event.time, event.kind);
//! }
//! # Ok::<(), franka_record::recording::RecordingError>(())
//! ```
//!
//! The index at the end of the file contains the position of each part of a recording, so the
//! reader reads only the requested parts. If the end of the file is missing, the reader scans the
//! file once, from chunk to chunk.

mod bytes;
mod chunk;
mod error;
mod index;
mod messages;
mod records;
mod recover;
mod resample;
mod wire;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;

use franka_model::RobotKind;
use mcap::MAGIC;
use mcap::records::Record;

use self::bytes::Bytes;
use self::chunk::Chunk;
pub use self::error::RecordingError;
use self::index::{Channels, Entry, Index};
pub use self::messages::{Cycles, Events, GripperStates};
pub(crate) use self::records::each_record;
pub use self::recover::Recovery;
pub use self::resample::Resampled;
use crate::HostTime;
use crate::recorded_model::{self, RecordedModel};
use crate::schema::{CASSETTE_METADATA, METADATA, ROBOT_METADATA, Topic};

/// An open recording.
#[derive(Clone, Debug)]
pub struct Recording {
    bytes: Bytes,
    index: Index,
    channels: Channels,
    metadata: BTreeMap<String, String>,
    robots: Vec<RecordedRobot>,
    damage: Option<String>,
}

/// A robot in a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct RecordedRobot {
    /// Name of the robot; empty if the recording has a single robot without a name.
    pub name: String,
    /// Kind of the robot; `None` if the file does not contain the kind, or if this version does not
    /// know it.
    pub kind: Option<RobotKind>,
    /// Other facts about the robot, as written by the recorder.
    pub metadata: BTreeMap<String, String>,
}

impl Recording {
    /// Opens a recording. If the end of the file is missing, the recording contains all whole
    /// chunks (see [`Recording::damage`]).
    ///
    /// # Errors
    /// Returns [`RecordingError::File`] if the file cannot be opened, and [`RecordingError::Read`]
    /// if it cannot be read. Returns [`RecordingError::NotMcap`] if it is not an MCAP file, and
    /// [`RecordingError::Foreign`] if it is not a recording.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, RecordingError> {
        let path = path.as_ref();
        let bytes = File::open(path).and_then(Bytes::of_file);
        Self::read(bytes.map_err(|source| RecordingError::File {
            path: path.to_owned(),
            source: source.into(),
        })?)
    }

    /// Opens a recording from the bytes of a file in memory, like [`Recording::open`].
    ///
    /// # Errors
    /// Returns [`RecordingError::NotMcap`] if the bytes are not an MCAP file, and
    /// [`RecordingError::Foreign`] if they are not a recording.
    pub fn from_bytes(bytes: Vec<u8>) -> Result<Self, RecordingError> {
        Self::read(Bytes::of_memory(bytes))
    }

    fn read(bytes: Bytes) -> Result<Self, RecordingError> {
        let index = Index::of(&bytes)?;
        let mut recording = Self {
            bytes,
            channels: Channels::default(),
            metadata: BTreeMap::new(),
            robots: Vec::new(),
            damage: index.damage.clone(),
            index,
        };
        let others = recording.read_metadata()?;
        if recording.metadata.is_empty()
            && recording.robots.is_empty()
            && let Some(content) = recording.foreign(&others)?
        {
            return Err(RecordingError::Foreign { content });
        }
        recording.read_channels()?;
        Ok(recording)
    }

    /// Describes a file that lacks the metadata of a recording. `None` for a recording that was cut
    /// off before its metadata. `others` are the names of the file's metadata records.
    fn foreign(&self, others: &[String]) -> Result<Option<String>, RecordingError> {
        if others.iter().any(|name| name == CASSETTE_METADATA) {
            return Ok(Some("a cassette, which `franka cassette` reads".to_owned()));
        }
        let start = MAGIC.len() as u64;
        let length = self.bytes.length().saturating_sub(start).min(HEADER_MAX);
        let record = self.bytes.read(start, length)?;
        let header = match record.as_deref().and_then(wire::first) {
            Some(Record::Header(header)) => Some((header.profile, header.library)),
            _ => None,
        };
        let written = header
            .as_ref()
            .map(|(profile, library)| (&**profile, &**library));
        let is_whole = self.damage.is_none();
        Ok(match written {
            Some((_, library)) if library.starts_with(env!("CARGO_PKG_NAME")) => {
                is_whole.then(|| "it has no description of a robot".to_owned())
            }
            Some(("", library)) if !library.is_empty() => {
                Some(format!("the file was written by {library:?}"))
            }
            Some((profile, library)) if !library.is_empty() => Some(format!(
                "the file was written by {library:?} with the profile {profile:?}"
            )),
            _ => is_whole.then(|| "the file does not name the program that wrote it".to_owned()),
        })
    }

    /// Returns the names of the metadata records that do not belong to a recording.
    fn read_metadata(&mut self) -> Result<Vec<String>, RecordingError> {
        let mut others = Vec::new();
        for entry in &self.index.metadata {
            let record = self.bytes.read(entry.offset, entry.length)?;
            let Some(Record::Metadata(record)) = record.as_deref().and_then(wire::first) else {
                continue;
            };
            let (name, metadata) = (record.name, record.metadata);
            if name == METADATA {
                self.metadata = metadata;
            } else if let Some(robot) = name.strip_prefix(ROBOT_METADATA) {
                let kind = metadata.get("kind").and_then(|kind| {
                    let mut kinds = RobotKind::ALL.into_iter();
                    kinds.find(|known| format!("{known:?}") == *kind)
                });
                self.robots.push(RecordedRobot {
                    name: robot.to_owned(),
                    kind,
                    metadata,
                });
            } else {
                others.push(name);
            }
        }
        Ok(others)
    }

    /// Finds the channels in the summary. Without a summary, finds them in the first chunks.
    fn read_channels(&mut self) -> Result<(), RecordingError> {
        for (kind, body) in &self.index.described {
            self.channels.take(*kind, body);
        }
        // Without a summary, the channels of a robot are described in the chunk in which the robot
        // was attached.
        for entry in &self.index.chunks {
            if self.knows_channels() {
                break;
            }
            match Chunk::read(&self.bytes, entry) {
                Ok(mut chunk) => {
                    while let Some((kind, body)) = chunk.next() {
                        self.channels.take(kind, body);
                    }
                }
                // The error is reported again when the chunk is read.
                Err(RecordingError::Chunk { .. } | RecordingError::Compression { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    fn knows_channels(&self) -> bool {
        let schema = Topic::Gripper.schema();
        self.robots.iter().all(|robot| {
            // The channel of the gripper is described last.
            let name = Topic::Gripper.channel(&robot.name);
            self.channels.find(&name, &schema).is_some()
        })
    }

    /// Returns a description of the damage if the file is damaged. The end of the file is missing
    /// after a power failure, after a crash, or if the disk was full. The index can also be
    /// damaged. Data that was flushed before remains readable.
    pub fn damage(&self) -> Option<&str> {
        self.damage.as_deref()
    }

    /// Returns the times of the first and the last message; `None` if the recording contains no
    /// messages.
    pub fn span(&self) -> Option<(HostTime, HostTime)> {
        let chunks = || self.index.chunks.iter().filter(|chunk| chunk.end > 0);
        let begin = chunks().map(|chunk| chunk.begin).min()?;
        let end = chunks().map(|chunk| chunk.end).max()?;
        Some((HostTime::from_nanos(begin), HostTime::from_nanos(end)))
    }

    /// Returns the metadata of the whole recording: versions, host, kernel and options.
    pub fn metadata(&self) -> &BTreeMap<String, String> {
        &self.metadata
    }

    /// Returns the robots of the recording.
    pub fn robots(&self) -> &[RecordedRobot] {
        &self.robots
    }

    /// Returns the recording of the robot `name`. The name of a single robot is empty unless the
    /// program set a name.
    ///
    /// # Errors
    /// Returns [`RecordingError::NoRobot`] if the recording has no robot with this name.
    pub fn robot(&self, name: &str) -> Result<RobotRecording<'_>, RecordingError> {
        if self.robots.iter().any(|robot| robot.name == name) {
            Ok(RobotRecording {
                recording: self,
                name: name.to_owned(),
                from: HostTime::default(),
                to: HostTime::from_nanos(u64::MAX),
            })
        } else {
            Err(RecordingError::NoRobot {
                name: name.to_owned(),
                robots: self.robots.iter().map(|robot| robot.name.clone()).collect(),
            })
        }
    }

    /// Returns the names of the attached files.
    ///
    /// # Errors
    /// Returns [`RecordingError::Read`] if the file cannot be read.
    pub fn attachments(&self) -> Result<Vec<String>, RecordingError> {
        let mut names = Vec::new();
        for entry in &self.index.attachments {
            if let Some(record) = self.bytes.read(entry.offset, entry.length)?
                && let Some((name, _)) = attachment(&record)
            {
                names.push(name);
            }
        }
        Ok(names)
    }

    /// Returns the bytes of the attached file `name`; `None` if the attachment does not exist or is
    /// damaged.
    ///
    /// # Errors
    /// Returns [`RecordingError::Read`] if the file cannot be read.
    pub fn attachment(&self, name: &str) -> Result<Option<Vec<u8>>, RecordingError> {
        self.attachment_in(self.index.attachments.iter(), name)
    }

    fn attachment_in<'a>(
        &self,
        entries: impl Iterator<Item = &'a Entry>,
        name: &str,
    ) -> Result<Option<Vec<u8>>, RecordingError> {
        for entry in entries {
            if let Some(record) = self.bytes.read(entry.offset, entry.length)?
                && let Some((found, data)) = attachment(&record)
                && found == name
            {
                return Ok(Some(data.into_owned()));
            }
        }
        Ok(None)
    }

    /// Returns the description of a robot. If the program attached a file under the same name, the
    /// description is the newer attachment.
    fn description(&self, name: &str) -> Option<String> {
        let newest_first = self.index.attachments.iter().rev();
        let data = self.attachment_in(newest_first, name).ok()??;
        String::from_utf8(data).ok()
    }
}

fn attachment(record: &[u8]) -> Option<(String, Cow<'_, [u8]>)> {
    match wire::first(record)? {
        Record::Attachment { header, data, .. } => Some((header.name, data)),
        _ => None,
    }
}

/// Largest number of bytes that the reader reads from the first record. Longer texts are not shown.
const HEADER_MAX: u64 = 1024;

/// The recording of one robot in a time range, which is initially the whole recording.
#[derive(Clone, Debug)]
pub struct RobotRecording<'a> {
    recording: &'a Recording,
    name: String,
    from: HostTime,
    to: HostTime,
}

impl RobotRecording<'_> {
    /// Returns the model of the robot with the limits of the attached description; `None` if the
    /// file does not contain a known kind of robot.
    pub fn model(&self) -> Option<RecordedModel> {
        let mut robots = self.recording.robots.iter();
        let robot = robots.find(|robot| robot.name == self.name)?;
        let kind = robot.kind?;
        let name = recorded_model::description(&robot.name, kind);
        let urdf = self.recording.description(&name);
        let lengths = recorded_model::read_lengths(&robot.metadata);
        Some(RecordedModel::of(kind, urdf.as_deref(), lengths))
    }

    /// Returns the part of the recording that starts at `time`.
    #[must_use]
    pub fn from(&self, time: HostTime) -> Self {
        Self {
            from: self.from.max(time),
            ..self.clone()
        }
    }

    /// Returns the part of the recording that ends at `time`, including messages at `time`.
    #[must_use]
    pub fn to(&self, time: HostTime) -> Self {
        Self {
            to: self.to.min(time),
            ..self.clone()
        }
    }

    /// Returns the cycles, oldest first. After an error, the iterator continues with the data that
    /// follows the damage.
    pub fn cycles(&self) -> Cycles {
        Cycles::of(self)
    }

    /// Returns the events, oldest first. The iterator handles errors as [`RobotRecording::cycles`]
    /// does.
    pub fn events(&self) -> Events {
        Events::of(self)
    }

    /// Returns the states of the gripper, oldest first. The iterator handles errors as
    /// [`RobotRecording::cycles`] does.
    pub fn gripper_states(&self) -> GripperStates {
        GripperStates::of(self)
    }

    /// Returns `rate` cycles per second of the robot's clock. Each is the newest recorded cycle at
    /// its time. In a gap, this is the cycle before the gap.
    pub fn resampled(&self, rate: f64) -> Resampled {
        Resampled::of(self.cycles(), rate)
    }
}

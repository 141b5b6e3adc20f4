//! The options of a recorder.

use core::time::Duration;
use std::collections::BTreeMap;
use std::path::PathBuf;

use franka_model::RobotKind;
use franka_model::geometry::Lengths;

use super::error::RecordError;
use crate::recorded_model;

/// Options of a recording.
#[derive(Clone, Debug)]
pub struct RecordOptions {
    /// True to record at a reduced rate, except near notable events. The recording then keeps every
    /// tenth cycle, and every second message for viewers (`/tf`, `/target`, `/joints`, `/scene`).
    /// False by default.
    ///
    /// Notable events are reflexes and other errors, contacts, collisions, a lost link, failed
    /// motions, motions aborted by a guard, lost cycles, and remarks at level error. The recording
    /// keeps the full rate from 0.5 s before a notable event to 1 s after it. Therefore the
    /// recorder delays all messages by 0.5 s.
    pub thinned: bool,
    /// Longest time between two writes. The default and the maximum are 1 s. A crash loses at most
    /// the data of this time.
    pub flush: Duration,
    /// True to force each write to the disk, so that a power failure loses no more data than a
    /// crash. True by default. This option does not affect the robot, because a separate thread
    /// waits for the disk.
    pub sync: bool,
    /// Condition under which the recording continues in a new file. The file after `run.mcap` is
    /// `run-0002.mcap`, and so on. The recorder skips the numbers of existing files.
    pub rotation: Rotation,
    /// Facts about the recording, which the recorder writes to its metadata.
    pub metadata: BTreeMap<String, String>,
    /// Data that the recorder attaches to every file of the recording.
    pub attachments: Vec<Attachment>,
    /// Options of the black box, which writes the last seconds before an incident to a separate
    /// file; `None` for no black box.
    pub black_box: Option<BlackBox>,
}

impl Default for RecordOptions {
    fn default() -> Self {
        Self {
            thinned: false,
            flush: FLUSH_MAX,
            sync: true,
            rotation: Rotation::default(),
            metadata: BTreeMap::new(),
            attachments: Vec::new(),
            black_box: None,
        }
    }
}

impl RecordOptions {
    pub(super) fn check(&self) -> Result<(), RecordError> {
        let invalid = |what, got: String, expected| {
            Err(RecordError::Option {
                what,
                got,
                expected,
            })
        };
        if !(FLUSH_MIN..=FLUSH_MAX).contains(&self.flush) {
            let got = format!("{:?}", self.flush);
            return invalid("flush", got, "0.01 s to 1 s");
        }
        if let Some(bytes) = self.rotation.bytes
            && bytes < ROTATION_MIN
        {
            return invalid("rotation.bytes", bytes.to_string(), "1000000 or more");
        }
        if let Some(time) = self.rotation.time
            && time < FLUSH_MAX
        {
            return invalid("rotation.time", format!("{time:?}"), "1 s or more");
        }
        if let Some(black_box) = &self.black_box {
            let BlackBox {
                before,
                after,
                keep,
                ..
            } = black_box;
            if !(FLUSH_MAX..=BEFORE_MAX).contains(before) {
                let got = format!("{before:?}");
                return invalid("black_box.before", got, "1 s to 300 s");
            }
            if *after > AFTER_MAX {
                let got = format!("{after:?}");
                return invalid("black_box.after", got, "at most 60 s");
            }
            if *keep == 0 {
                return invalid("black_box.keep", keep.to_string(), "1 or more");
            }
        }
        Ok(())
    }

    /// Returns the options by name, except the metadata and the attachments.
    pub(super) fn described(&self) -> BTreeMap<String, String> {
        let Self {
            thinned,
            flush,
            sync,
            rotation,
            black_box,
            ..
        } = self;
        let black_box = black_box.as_ref().map(|black_box| {
            let BlackBox {
                before,
                after,
                keep,
                ..
            } = black_box;
            format!("{before:?} before, {after:?} after, {keep} files")
        });
        let options = [
            ("thinned", Some(thinned.to_string())),
            ("flush", Some(format!("{flush:?}"))),
            ("sync", Some(sync.to_string())),
            ("rotation_bytes", rotation.bytes.map(|it| it.to_string())),
            ("rotation_time", rotation.time.map(|it| format!("{it:?}"))),
            ("black_box", black_box),
        ];
        let given = options
            .into_iter()
            .filter_map(|(name, value)| Some((name.to_owned(), value?)));
        given.collect()
    }
}

const FLUSH_MIN: Duration = Duration::from_millis(10);
pub(super) const FLUSH_MAX: Duration = Duration::from_secs(1);

/// Smallest permitted file size for rotation, `[bytes]`. One robot fills this size in less than two
/// seconds.
const ROTATION_MIN: u64 = 1_000_000;

/// Longest permitted time before an incident. This time needs some 200 MB of memory.
const BEFORE_MAX: Duration = Duration::from_secs(300);
const AFTER_MAX: Duration = Duration::from_secs(60);

/// Condition under which a recording continues in a new file. By default, a recording never does
/// so.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rotation {
    /// Size after which a new file begins, in bytes.
    pub bytes: Option<u64>,
    /// Recorded time after which a new file begins.
    pub time: Option<Duration>,
}

/// A file that is stored inside the recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// Name of the attachment, such as `options.json`.
    pub name: String,
    /// Media type of the attachment, such as `application/json`.
    pub media_type: String,
    /// Contents of the attachment.
    pub data: Vec<u8>,
}

/// Options of a black box. A black box keeps the last seconds in memory. It writes them to a file
/// when a reflex, a lost link or a guard of the driver ends a motion
/// ([`Ending::is_incident`](crate::event::Ending::is_incident)).
#[derive(Clone, Debug)]
pub struct BlackBox {
    /// Directory of the black box files. The recorder creates the directory if necessary. Each file
    /// name contains the UTC time, the robot and the cause, for example
    /// `20260301T120000.123Z-fr3-reflex.mcap`.
    pub directory: PathBuf,
    /// Recorded time before the incident, 30 s by default. Each robot needs some 0.7 MB of memory
    /// per second of this time.
    pub before: Duration,
    /// Recorded time after the incident, 1 s by default. If another incident occurs in this time,
    /// the same file covers both incidents.
    pub after: Duration,
    /// Number of files to keep, 20 by default. The recorder deletes older files.
    pub keep: usize,
}

impl BlackBox {
    /// Creates the default options for black box files in `directory`.
    pub fn new(directory: impl Into<PathBuf>) -> Self {
        Self {
            directory: directory.into(),
            before: Duration::from_secs(30),
            after: Duration::from_secs(1),
            keep: 20,
        }
    }
}

/// Description of a robot to record.
#[derive(Clone, Debug)]
pub struct Robot {
    /// Name of the robot: letters, digits, `-` and `_`. The default is empty, which is enough for a
    /// single robot. Without a name, the channels are called `/cycle` and so on. With the name
    /// `left`, they are called `/left/cycle` and so on.
    pub name: String,
    /// The kind of robot.
    pub kind: RobotKind,
    /// Lengths of the robot's links, as used by the driver. The default comes from the vendor's
    /// description.
    pub lengths: Lengths,
    /// URDF of the robot; `None` if unknown. The recorder attaches it to the file.
    pub urdf: Option<String>,
    /// Other facts about the robot for the metadata, such as its address, version and options.
    pub metadata: BTreeMap<String, String>,
    /// Robot clock at the time when the robot is attached, `[ms]`; 0 if unknown. The recorder uses
    /// this value for events before the first cycle.
    pub robot_time: u64,
}

impl Robot {
    /// Creates a robot without a name.
    pub fn new(kind: RobotKind) -> Self {
        Self {
            name: String::new(),
            kind,
            lengths: Lengths::DESCRIBED,
            urdf: None,
            metadata: BTreeMap::new(),
            robot_time: 0,
        }
    }

    /// Sets the name.
    #[must_use]
    pub fn named(self, name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..self
        }
    }

    pub(super) fn check(&self) -> Result<(), RecordError> {
        let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if self.name.len() <= NAME_MAX && self.name.chars().all(allowed) {
            Ok(())
        } else {
            Err(RecordError::Option {
                what: "the name of a robot",
                got: format!("{:?}", self.name),
                expected: "at most 64 letters, digits, - and _",
            })
        }
    }

    /// Returns the robot's name for metadata and file names.
    pub(super) fn label(&self) -> &str {
        recorded_model::label(&self.name, self.kind)
    }

    /// Returns the name of the robot's arm in `franka_description`.
    pub(super) fn arm(&self) -> &'static str {
        recorded_model::arm(self.kind)
    }
}

const NAME_MAX: usize = 64;

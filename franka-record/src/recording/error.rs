//! Errors of reading a recording.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

/// The reason why a recording, or a part of it, cannot be read.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The file cannot be opened, or cannot be written in a recovery.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: Arc<io::Error>,
    },
    /// The file is not an MCAP file.
    #[error("not an MCAP file: got {got:02x?} at the begin, expected the magic bytes of MCAP")]
    NotMcap {
        /// The bytes at its beginning.
        got: Vec<u8>,
    },
    /// The file is an MCAP file, but not a recording: it describes neither a recording nor a robot.
    #[error("not a recording of this program: {content}")]
    Foreign {
        /// The actual content, with the program that wrote it if the file names one.
        content: String,
    },
    /// The system cannot continue to read.
    #[error("cannot read the recording: {source}")]
    Read {
        /// The system's error.
        source: Arc<io::Error>,
    },
    /// A chunk is damaged. Later chunks can be read.
    #[error(
        "the chunk at byte {offset} is damaged: {reason}; `Recording::recover` writes a copy without it"
    )]
    Chunk {
        /// Offset of its beginning.
        offset: u64,
        /// The error.
        reason: String,
    },
    /// A chunk has an unsupported compression, because another tool rewrote the file. Use the
    /// tool's option `lz4` or no compression.
    #[error(
        "the chunk at byte {offset} is compressed with {got:?}; expected \"lz4\" or no compression"
    )]
    Compression {
        /// Offset of its beginning.
        offset: u64,
        /// The compression named by the file.
        got: String,
    },
    /// A message does not match its kind. Later messages can be read.
    #[error("a message of {topic} in the chunk at byte {offset} is damaged: {reason}")]
    Message {
        /// Its channel.
        topic: String,
        /// Offset of its chunk.
        offset: u64,
        /// The error.
        reason: String,
    },
    /// The recording contains no robot with this name.
    #[error(
        "got the robot name {name:?}, expected one of {robots:?}, the robots of this recording"
    )]
    NoRobot {
        /// The requested name.
        name: String,
        /// The existing names.
        robots: Vec<String>,
    },
}

impl From<io::Error> for RecordingError {
    fn from(source: io::Error) -> Self {
        Self::Read {
            source: source.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `franka recover` is the recovery of a robot from a reflex, so the advice must not name it.
    #[test]
    fn advice_about_a_damaged_file_acts_on_no_robot() {
        let error = RecordingError::Chunk {
            offset: 8,
            reason: "cut".to_owned(),
        };
        let text = error.to_string();
        assert!(text.contains("Recording::recover"), "{text}");
        assert!(!text.contains("franka recover"), "{text}");
    }
}

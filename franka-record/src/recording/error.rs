//! Errors of reading a recording.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

/// Reason why a recording, or a part of it, cannot be read.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The file cannot be opened, or a recovery cannot write the new file.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: Arc<io::Error>,
    },
    /// The file is not an MCAP file.
    #[error("not an MCAP file: it starts with {got:02x?}, expected the magic bytes of MCAP")]
    NotMcap {
        /// The bytes at the beginning of the file.
        got: Vec<u8>,
    },
    /// The file is an MCAP file but not a recording, because it describes neither a recording nor a
    /// robot.
    #[error("not a recording of this program: {content}")]
    Foreign {
        /// Description of the file's actual content. It includes the program that wrote the file,
        /// if the file contains its name.
        content: String,
    },
    /// The system reported an error while the file was read.
    #[error("cannot read the recording: {source}")]
    Read {
        /// The system's error.
        source: Arc<io::Error>,
    },
    /// A chunk is damaged. Chunks after it can still be read.
    #[error(
        "the chunk at byte {offset} is damaged: {reason}; `Recording::recover` writes a copy without it"
    )]
    Chunk {
        /// Position of the chunk's first byte in the file.
        offset: u64,
        /// Description of the damage.
        reason: String,
    },
    /// The compression of a chunk is not supported, because another tool rewrote the file. Rewrite
    /// the file with `lz4` or without compression.
    #[error(
        "the chunk at byte {offset} is compressed with {got:?}; expected \"lz4\" or no compression"
    )]
    Compression {
        /// Position of the chunk's first byte in the file.
        offset: u64,
        /// Name of the compression in the file.
        got: String,
    },
    /// A message does not have the type of its channel. Messages after it can still be read.
    #[error("a message of {topic} in the chunk at byte {offset} is damaged: {reason}")]
    Message {
        /// Channel of the message.
        topic: String,
        /// Position of the chunk that contains the message.
        offset: u64,
        /// Description of the decoding error.
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

    /// Advice must not name `franka recover`, because this command recovers a robot from a reflex.
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

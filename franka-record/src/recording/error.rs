//! Why a recording cannot be read.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

/// Why a recording, or a part of it, cannot be read.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The file cannot be opened, or written in a recovery.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: Arc<io::Error>,
    },
    /// It is no MCAP file.
    #[error("not an MCAP file: it begins with {got:02x?}")]
    NotMcap {
        /// The bytes at its beginning.
        got: Vec<u8>,
    },
    /// It is an MCAP file, but not a recording: it describes neither a recording nor a robot.
    #[error("not a recording of this program: {content}")]
    Foreign {
        /// What it is instead, with the program that wrote it if the file names one.
        content: String,
    },
    /// The system cannot read on.
    #[error("cannot read the recording: {source}")]
    Read {
        /// What the system says.
        source: Arc<io::Error>,
    },
    /// A chunk is damaged. Those after it can be read.
    #[error(
        "the chunk at byte {offset} is damaged: {reason}; `Recording::recover` writes a copy without it"
    )]
    Chunk {
        /// Where it begins.
        offset: u64,
        /// What is wrong.
        reason: String,
    },
    /// A chunk is compressed in another way than recordings are: another tool has written the file
    /// anew. The tool's option for it is `lz4` or none.
    #[error(
        "the chunk at byte {offset} is compressed with {got:?}; expected \"lz4\" or no compression"
    )]
    Compression {
        /// Where it begins.
        offset: u64,
        /// What the file says.
        got: String,
    },
    /// A message is none of its kind. Those after it can be read.
    #[error("a message of {topic} in the chunk at byte {offset} is damaged: {reason}")]
    Message {
        /// Its channel.
        topic: String,
        /// Where its chunk begins.
        offset: u64,
        /// What is wrong.
        reason: String,
    },
    /// There is no robot of that name in the recording.
    #[error("no robot is called {name:?} in this recording; there are {robots:?}")]
    NoRobot {
        /// What was asked for.
        name: String,
        /// Those that there are.
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

    /// `franka recover` is the recovery of a robot from a reflex.
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

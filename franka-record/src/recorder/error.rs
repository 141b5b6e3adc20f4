//! Errors of recording.

use core::time::Duration;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;

/// Reason why the recorder could not record data. The robot's motion is not affected.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// A file with this name exists. A recording never overwrites a file, so choose another name.
    #[error("{} exists, and a recording never overwrites a file: choose another name", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A file cannot be created.
    #[error("cannot create {}: {source}", path.display())]
    Create {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: Arc<io::Error>,
    },
    /// A file can no longer be written, for example because the disk is full or was removed. The
    /// data written so far is readable; the rest of the recording is lost.
    #[error("cannot write {} beyond {bytes} bytes: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Number of bytes in the file, all of which are readable.
        bytes: u64,
        /// The system's error.
        source: Arc<io::Error>,
    },
    /// The recorder could not write a black box file.
    #[error("cannot write the black box {}: {source}", path.display())]
    BlackBox {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: Arc<io::Error>,
    },
    /// The disk did not store everything within the time limit. The recorder writes the remaining
    /// data in the background.
    #[error("the recording is not completely written after {limit:?}: the disk is too slow")]
    Unfinished {
        /// The time limit.
        limit: Duration,
    },
    /// An option is out of its range.
    #[error("{what} is {got}, expected {expected}")]
    Option {
        /// Name of the option.
        what: &'static str,
        /// The given value.
        got: String,
        /// The valid range.
        expected: &'static str,
    },
    /// A robot with this name is already recorded.
    #[error("a robot named {name:?} is already recorded, expected a different name for each robot")]
    SameName {
        /// The name.
        name: String,
    },
    /// The recording has ended, or the recorder accepts no more orders.
    #[error("the recorder has ended")]
    Ended,
    /// A thread cannot be started.
    #[error("cannot start the thread of the recorder: {source}")]
    Thread {
        /// The system's error.
        source: Arc<io::Error>,
    },
    /// The server for viewers cannot listen at its address.
    #[cfg(feature = "foxglove")]
    #[error("cannot serve viewers at {address}: {reason}")]
    Live {
        /// The requested address.
        address: core::net::SocketAddr,
        /// The server's error.
        reason: String,
    },
    /// The recorder could not encode data. This is a bug; please report it.
    #[error("cannot encode the recording: {reason}")]
    Encode {
        /// The encoder's error.
        reason: String,
    },
}

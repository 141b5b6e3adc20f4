//! Why something was not recorded.

use core::time::Duration;
use std::io;
use std::path::PathBuf;
use std::sync::Arc;

/// Why something was not recorded. The robot is not concerned: its motion goes on.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// There is a file of that name. A recording never overwrites one: choose another name.
    #[error("{} exists; a recording never overwrites a file", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A file cannot be made.
    #[error("cannot make {}: {source}", path.display())]
    Create {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: Arc<io::Error>,
    },
    /// A file cannot be written any more: disk full, device gone. What was written before is
    /// readable; the rest of the recording is lost.
    #[error("cannot write {} beyond {bytes} bytes: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The bytes in it, all of them readable.
        bytes: u64,
        /// What the system says.
        source: Arc<io::Error>,
    },
    /// The last seconds of a black box could not be written.
    #[error("cannot write the black box {}: {source}", path.display())]
    BlackBox {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: Arc<io::Error>,
    },
    /// The disk took no more within the time limit. What is still to be written goes on in the
    /// background.
    #[error("the recording was not complete on the disk within {limit:?}")]
    Unfinished {
        /// The time limit.
        limit: Duration,
    },
    /// An option is out of its range.
    #[error("{what} is {got}; expected {expected}")]
    Option {
        /// Which option.
        what: &'static str,
        /// What it is.
        got: String,
        /// What it may be.
        expected: &'static str,
    },
    /// A robot of that name is recorded already.
    #[error("a robot called {name:?} is recorded already; give each a name of its own")]
    SameName {
        /// The name.
        name: String,
    },
    /// The recorder has ended or takes no more orders.
    #[error("the recorder has ended")]
    Ended,
    /// A thread cannot be started.
    #[error("cannot start the thread of the recorder: {source}")]
    Thread {
        /// What the system says.
        source: Arc<io::Error>,
    },
    /// The server for viewers cannot listen.
    #[cfg(feature = "foxglove")]
    #[error("cannot serve viewers at {address}: {reason}")]
    Live {
        /// The address that was asked for.
        address: core::net::SocketAddr,
        /// What the server says.
        reason: String,
    },
    /// The bytes of the file could not be put together. Please report it.
    #[error("cannot encode the recording: {reason}")]
    Encode {
        /// What the encoder says.
        reason: String,
    },
}

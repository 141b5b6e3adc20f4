//! Errors of exports.

use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

/// Reason why an export failed or is incomplete.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// A file with this name exists, and an export never replaces a file. Choose a different name,
    /// or delete the file first.
    #[error("{} exists, and an export never replaces a file: choose another name", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A file or folder cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The stream cannot be written.
    #[error(transparent)]
    Write(#[from] io::Error),
    /// The recording cannot be read.
    #[error(transparent)]
    Cycles(Box<dyn Error + Send + Sync>),
    /// The rows cannot be written or read as a table.
    #[cfg(feature = "export")]
    #[error("{}: {source}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// The error.
        source: ::parquet::errors::ParquetError,
    },
    /// The samples of an episode are invalid.
    #[error("episode {index} of the dataset, with the task {task:?}: {why}")]
    Episode {
        /// Number of the episode in the dataset, from 0.
        index: u64,
        /// Task of the episode.
        task: String,
        /// Description of the error.
        why: String,
    },
    /// The folder is not a dataset that can be written to.
    #[error("the dataset {}: {why}", path.display())]
    Dataset {
        /// Folder of the dataset.
        path: PathBuf,
        /// The value found and the expected value.
        why: String,
    },
    /// An option has an invalid value.
    #[error("{option}: got {got}, expected {expected}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// The value.
        got: String,
        /// The valid values.
        expected: &'static str,
    },
}

impl ExportError {
    /// Converts a system error to an error about `path`.
    pub(super) fn at(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, source }
    }
}

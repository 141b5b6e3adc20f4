//! Errors of exports.

use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

/// Reason why an export failed or is incomplete.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// A file with this name exists. An export never replaces a file, so choose another name or
    /// delete the file.
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
    /// The output stream cannot be written.
    #[error(transparent)]
    Write(#[from] io::Error),
    /// The recording cannot be read.
    #[error(transparent)]
    Cycles(Box<dyn Error + Send + Sync>),
    /// The rows of a table cannot be written or read.
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
    /// The folder is not a dataset to which episodes can be added.
    #[error("the dataset {}: {why}", path.display())]
    Dataset {
        /// Folder of the dataset.
        path: PathBuf,
        /// Description of the value found and the value expected.
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
    pub(super) fn at(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, source }
    }
}

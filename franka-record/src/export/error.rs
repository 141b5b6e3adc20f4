//! Why an export fails.

use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

/// Why nothing, or not everything, was exported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// There is a file of that name. An export never replaces one: choose another name, or delete
    /// the file first.
    #[error("{} exists, and an export never replaces a file; choose another name", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A file or folder cannot be read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A stream cannot be written to.
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
        /// What is wrong with it.
        source: ::parquet::errors::ParquetError,
    },
    /// The samples of an episode do not make one.
    #[error("episode {index} of the dataset, with the task {task:?}: {why}")]
    Episode {
        /// Its number in the dataset, from 0.
        index: u64,
        /// Its task.
        task: String,
        /// What is wrong with it.
        why: String,
    },
    /// A dataset is not one that can be written to.
    #[error("the dataset {}: {why}", path.display())]
    Dataset {
        /// Its folder.
        path: PathBuf,
        /// What was found and what was expected.
        why: String,
    },
    /// An option has a value that is not accepted.
    #[error("{option}: got {got}, expected {expected}")]
    Option {
        /// Its name.
        option: &'static str,
        /// The value.
        got: String,
        /// What is accepted.
        expected: &'static str,
    },
}

impl ExportError {
    /// Makes a system's error one about `path`.
    pub(super) fn at(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, source }
    }
}

//! An export as one atomic step: either all of its files become part of the dataset, or none.
//!
//! ```text
//! .export.partial/{data, meta}  --renamed: it counts-->  .export.complete/{data, meta}  --moved-->  {data, meta}
//! ```
//!
//! If an export was interrupted before it was complete, the next export deletes its files. If it
//! was interrupted afterwards, the next export moves its remaining files.

use std::fs::{self, File, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::export::error::ExportError;
use crate::export::new_file::sync_folder_of;

/// An active export to the dataset in `root`. Only one export can be active at a time. Dropping
/// this value deletes the files of the export.
#[derive(Debug)]
pub(super) struct Staging {
    root: PathBuf,
    /// Folder of the export's files.
    pub(super) folder: PathBuf,
    /// Lock that is held until this value is dropped; `None` if folders cannot be locked.
    _lock: Option<File>,
}

impl Staging {
    /// Completes an interrupted export in the folder `root` or deletes its files, and then begins
    /// another export.
    ///
    /// # Errors
    /// Returns [`ExportError::Dataset`] if another export is active, and [`ExportError::Io`] if a
    /// file cannot be changed.
    pub(super) fn begin(root: &Path) -> Result<Self, ExportError> {
        let lock = File::open(root).map_err(ExportError::at(root))?;
        let lock = match lock.try_lock() {
            Ok(()) => Some(lock),
            Err(TryLockError::WouldBlock) => {
                let why = "another export to this folder is running".to_owned();
                let path = root.to_owned();
                return Err(ExportError::Dataset { path, why });
            }
            Err(TryLockError::Error(_)) => None,
        };
        publish(root)?;
        let folder = root.join(PARTIAL);
        match fs::remove_dir_all(&folder) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                return Err(ExportError::at(&folder)(error));
            }
            _ => {}
        }
        Ok(Self {
            root: root.to_owned(),
            folder,
            _lock: lock,
        })
    }

    pub(super) fn commit(self) -> Result<(), ExportError> {
        for file in files(&self.folder)? {
            let to = self.root.join(&file);
            if !REPLACED.iter().any(|it| file == Path::new(it)) && to.exists() {
                return Err(ExportError::Exists { path: to });
            }
        }
        let complete = self.root.join(COMPLETE);
        fs::rename(&self.folder, &complete).map_err(ExportError::at(&self.folder))?;
        sync_folder_of(&complete);
        publish(&self.root)
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // If this fails, the next export deletes the folder.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Moves the files of a complete export to their places in the dataset `root`. Does nothing if no
/// complete export exists.
fn publish(root: &Path) -> Result<(), ExportError> {
    let complete = root.join(COMPLETE);
    if !complete.exists() {
        return Ok(());
    }
    let mut files = files(&complete)?;
    // The file with the totals is moved last, because readers rely on the totals.
    files.sort_by_key(|file| file == Path::new(INFO));
    for file in files {
        let to = root.join(&file);
        super::make_folder_of(&to)?;
        fs::rename(complete.join(&file), &to).map_err(ExportError::at(&to))?;
        sync_folder_of(&to);
    }
    fs::remove_dir_all(&complete).map_err(ExportError::at(&complete))
}

/// Returns the files below a folder, with paths relative to the folder.
fn files(folder: &Path) -> Result<Vec<PathBuf>, ExportError> {
    let (mut found, mut folders) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next).map_err(ExportError::at(&next))? {
            let path = entry.map_err(ExportError::at(&next))?.path();
            match path.strip_prefix(folder) {
                _ if path.is_dir() => folders.push(path),
                Ok(relative) => found.push(relative.to_owned()),
                Err(_) => unreachable!("it is below the folder"),
            }
        }
    }
    Ok(found)
}

const PARTIAL: &str = ".export.partial";
const COMPLETE: &str = ".export.complete";
const INFO: &str = "meta/info.json";

/// Files of the whole dataset, which every export rewrites.
const REPLACED: [&str; 3] = [INFO, "meta/stats.json", "meta/tasks.parquet"];

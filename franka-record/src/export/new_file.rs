//! Files that appear under their names once they are complete, and never replace another file.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use super::error::ExportError;

/// A file that is being written. [`finish`](Self::finish) gives the file its final name. If this
/// value is dropped earlier, the file is deleted.
///
/// Until then, the file has a temporary name in the same folder, which ends in `.partial`. If the
/// process is killed, the temporary file remains. It does not affect other exports.
#[derive(Debug)]
pub struct NewFile {
    path: PathBuf,
    file: NamedTempFile,
}

impl NewFile {
    /// Creates a temporary file that will later be renamed to `path`.
    ///
    /// # Errors
    /// Returns [`ExportError::Exists`] if `path` exists, and [`ExportError::Io`] if the file cannot
    /// be created.
    pub fn create(path: impl Into<PathBuf>) -> Result<Self, ExportError> {
        let path = path.into();
        if fs::symlink_metadata(&path).is_ok() {
            return Err(ExportError::Exists { path });
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let prefix = format!(".{name}.");
        let mut builder = Builder::new();
        builder.prefix(&prefix).suffix(".partial");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            // Normal permissions, minus the user's mask.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let folder = folder_of(&path);
        let file = builder.tempfile_in(folder).map_err(|error| {
            // The system's error names the temporary file, but the user knows only the final name.
            let of_folder = fs::metadata(folder).err();
            ExportError::at(&path)(of_folder.unwrap_or(error.kind().into()))
        })?;
        Ok(Self { path, file })
    }

    /// Returns the final name of the file.
    #[cfg(feature = "export")]
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Waits until the disk has stored the whole file, and renames it to its final name.
    ///
    /// # Errors
    /// Returns [`ExportError::Exists`] if another file has this name by now, and
    /// [`ExportError::Io`] if the file cannot be completed.
    pub fn finish(self) -> Result<(), ExportError> {
        let Self { path, file } = self;
        let synced = file.as_file().sync_all();
        synced.map_err(ExportError::at(&path))?;
        file.persist_noclobber(&path)
            .map_err(|error| match error.error.kind() {
                io::ErrorKind::AlreadyExists => ExportError::Exists { path: path.clone() },
                _ => ExportError::at(&path)(error.error),
            })?;
        sync_folder_of(&path);
        Ok(())
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.as_file_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.as_file_mut().flush()
    }
}

fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|it| !it.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

/// Ensures that the name of a file survives a power failure. Some file systems cannot synchronise
/// folders, and do not need this step.
pub(super) fn sync_folder_of(path: &Path) {
    if let Ok(folder) = File::open(folder_of(path)) {
        let _ = folder.sync_all();
    }
}

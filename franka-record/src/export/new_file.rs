//! Files that appear once they are complete, and never replace another file.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use super::error::ExportError;

/// A file that is being written. It gets its name with [`finish`](Self::finish). If this value is
/// dropped earlier, the file is deleted.
///
/// Until then the file has a temporary name in the same folder, which ends in `.partial`. If the
/// process is killed, this temporary file remains; it does not affect other exports.
#[derive(Debug)]
pub struct NewFile {
    path: PathBuf,
    file: NamedTempFile,
}

impl NewFile {
    /// Creates a file that will be at `path`.
    ///
    /// # Errors
    /// [`ExportError::Exists`] if `path` exists, and [`ExportError::Io`].
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
            // The text of the error contains the name of the partial file, but the user knows only
            // the final name.
            let of_folder = fs::metadata(folder).err();
            ExportError::at(&path)(of_folder.unwrap_or(error.kind().into()))
        })?;
        Ok(Self { path, file })
    }

    /// The final name of the file.
    #[cfg(feature = "export")]
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Waits until the disk has stored the whole file, and gives it its name.
    ///
    /// # Errors
    /// [`ExportError::Exists`] if another file now has this name, and [`ExportError::Io`].
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

/// Makes the name of a file survive a power failure. File systems whose folders cannot be
/// synchronised do not need this.
pub(super) fn sync_folder_of(path: &Path) {
    if let Ok(folder) = File::open(folder_of(path)) {
        let _ = folder.sync_all();
    }
}

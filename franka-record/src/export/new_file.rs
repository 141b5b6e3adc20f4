//! Files that appear once they are complete, and never replace another file.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use super::error::ExportError;

/// A file that is being written. It gets its name when it is [finished](Self::finish), and is
/// deleted if it is dropped before.
///
/// Until then it has a name of its own in the same folder, which ends in `.partial`. A process that
/// is killed leaves that file behind; it is in the way of no other export.
#[derive(Debug)]
pub struct NewFile {
    path: PathBuf,
    file: NamedTempFile,
}

impl NewFile {
    /// Begins a file at `path`.
    ///
    /// # Errors
    /// [`ExportError::Exists`] if there is anything at `path`, and [`ExportError::Io`].
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
            // Like any other file, less what the user's mask takes away.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let folder = folder_of(&path);
        let file = builder.tempfile_in(folder).map_err(|error| {
            // Its text has the name of the partial file, and the user knows the other one.
            let of_folder = fs::metadata(folder).err();
            ExportError::at(&path)(of_folder.unwrap_or(error.kind().into()))
        })?;
        Ok(Self { path, file })
    }

    /// The name that the file is to have.
    #[cfg(feature = "export")]
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Waits until the disk has all of the file, and gives it its name.
    ///
    /// # Errors
    /// [`ExportError::Exists`] if another file has got the name since, and [`ExportError::Io`].
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

/// Makes the name of a file outlast a power cut. Where folders cannot be synchronised, their file
/// systems need no such thing.
pub(super) fn sync_folder_of(path: &Path) {
    if let Ok(folder) = File::open(folder_of(path)) {
        let _ = folder.sync_all();
    }
}

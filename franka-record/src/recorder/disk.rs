//! The thread that writes to the disk, so that no other thread waits for it.

use core::mem;
use core::time::Duration;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, Sender, TryRecvError};
use std::sync::{Arc, Mutex};
use std::thread;

use super::black_box;
use super::error::RecordError;
use super::lock;

/// State of the recording's files.
#[derive(Clone, Debug, Default)]
pub(super) struct DiskStatus {
    /// Number of bytes that wait for the disk.
    pub(super) backlog: u64,
    /// Number of bytes in files.
    pub(super) written: u64,
    /// Number of cycles that were lost because they could not be written.
    pub(super) cycles_lost: u64,
    pub(super) black_box_waits: bool,
    /// The files of the recording, oldest first.
    pub(super) files: Vec<PathBuf>,
    pub(super) black_boxes: Vec<PathBuf>,
    /// Error that ended the recording early; `None` if none did.
    pub(super) error: Option<RecordError>,
    pub(super) black_box_error: Option<RecordError>,
}

/// The handle that sends jobs to the disk thread.
#[derive(Debug)]
pub(super) struct Disk {
    jobs: Sender<Job>,
    status: Arc<Mutex<DiskStatus>>,
}

#[derive(Debug)]
enum Job {
    /// Opens the first file of the recording.
    Open(PathBuf, File),
    /// Ends the open file and begins the next file of the recording whose first file has this path.
    Follow(PathBuf),
    /// Appends whole chunks that contain this number of cycles.
    Append(Vec<u8>, u64),
    /// Writes a black box file immediately, and then keeps only the newest `keep` files.
    BlackBox {
        directory: PathBuf,
        name: String,
        bytes: Vec<u8>,
        keep: usize,
    },
}

impl Disk {
    /// Starts the thread. The thread ends after this value is dropped and all data is written. It
    /// then drops `done`.
    pub(super) fn start(sync: bool, done: Sender<()>) -> Result<Self, RecordError> {
        let (jobs, receiver) = mpsc::channel();
        let status = Arc::<Mutex<DiskStatus>>::default();
        let mut thread = DiskThread {
            jobs: receiver,
            status: status.clone(),
            open: None,
            number: 1,
            sync,
        };
        thread::Builder::new()
            .name("franka-disk".to_owned())
            .spawn(move || {
                thread.run();
                drop(done);
            })
            .map_err(|source| RecordError::Thread {
                source: source.into(),
            })?;
        Ok(Self { jobs, status })
    }

    pub(super) fn status(&self) -> Arc<Mutex<DiskStatus>> {
        self.status.clone()
    }

    pub(super) fn backlog(&self) -> u64 {
        lock(&self.status).backlog
    }

    /// Returns true if no error has ended the recording.
    pub(super) fn is_well(&self) -> bool {
        lock(&self.status).error.is_none()
    }

    pub(super) fn fail(&self, error: RecordError) {
        fail(&self.status, error);
    }

    pub(super) fn fail_black_box(&self, error: RecordError) {
        fail_black_box(&self.status, error);
    }

    pub(super) fn open(&self, path: PathBuf, file: File) {
        self.order(Job::Open(path, file), 0);
    }

    /// Begins the next file of the recording whose first file is `first`.
    pub(super) fn follow(&self, first: PathBuf) {
        self.order(Job::Follow(first), 0);
    }

    pub(super) fn append(&self, bytes: Vec<u8>, cycles: u64) {
        let length = bytes.len();
        self.order(Job::Append(bytes, cycles), length);
    }

    /// Counts cycles that could not be written.
    pub(super) fn lose(&self, cycles: u64) {
        lock(&self.status).cycles_lost += cycles;
    }

    /// Writes a file of the black box. At most one file waits for the disk.
    pub(super) fn black_box(&self, directory: PathBuf, dump: black_box::Dump, keep: usize) {
        let length = dump.bytes.len();
        if mem::replace(&mut lock(&self.status).black_box_waits, true) {
            let source = io::Error::other(
                "the previous block is not written yet: the disk is too \
                slow",
            );
            return self.fail_black_box(RecordError::BlackBox {
                path: directory.join(dump.name),
                source: source.into(),
            });
        }
        let job = Job::BlackBox {
            directory,
            name: dump.name,
            bytes: dump.bytes,
            keep,
        };
        self.order(job, length);
    }

    fn order(&self, job: Job, length: usize) {
        lock(&self.status).backlog += length as u64;
        // The thread runs until `self` is dropped.
        let _ = self.jobs.send(job);
    }
}

/// Records and logs the reason why the recording cannot continue. Only the first reason is kept.
fn fail(status: &Mutex<DiskStatus>, error: RecordError) {
    let mut status = lock(status);
    if status.error.is_none() {
        status.error = Some(error.clone());
        drop(status);
        tracing::error!(%error, "the recording ends here; the robots continue");
    }
}

/// Records and logs the reason why a black box could not be written. Only the newest reason is
/// kept.
fn fail_black_box(status: &Mutex<DiskStatus>, error: RecordError) {
    tracing::error!(%error, "no black-box file was written for this incident");
    lock(status).black_box_error = Some(error);
}

pub(super) fn create(path: &Path) -> Result<File, RecordError> {
    let file = OpenOptions::new().write(true).create_new(true).open(path);
    let file = file.map_err(|source| match source.kind() {
        io::ErrorKind::AlreadyExists => RecordError::Exists {
            path: path.to_owned(),
        },
        _ => RecordError::Create {
            path: path.to_owned(),
            source: source.into(),
        },
    })?;
    sync_directory(path);
    Ok(file)
}

/// Ensures that the name of a file survives a power failure. Some file systems cannot synchronise
/// directories, and do not need this step.
fn sync_directory(path: &Path) {
    let directory = path
        .parent()
        .filter(|parent| !parent.as_os_str().is_empty());
    if let Ok(directory) = File::open(directory.unwrap_or(Path::new("."))) {
        let _ = directory.sync_all();
    }
}

struct DiskThread {
    jobs: Receiver<Job>,
    status: Arc<Mutex<DiskStatus>>,
    open: Option<Open>,
    /// Number of the newest file of the recording.
    number: u32,
    sync: bool,
}

/// The current file.
struct Open {
    path: PathBuf,
    file: File,
    /// Length of the file. It consists of whole chunks.
    length: u64,
    /// True if part of the file may not have reached the disk.
    dirty: bool,
}

impl DiskThread {
    fn run(&mut self) {
        loop {
            let job = match self.jobs.try_recv() {
                Ok(job) => job,
                Err(TryRecvError::Disconnected) => break,
                Err(TryRecvError::Empty) => {
                    self.synchronise();
                    match self.jobs.recv() {
                        Ok(job) => job,
                        Err(mpsc::RecvError) => break,
                    }
                }
            };
            self.work(job);
        }
        self.synchronise();
    }

    fn work(&mut self, job: Job) {
        match job {
            Job::Open(path, file) => self.begin(path, file),
            Job::Follow(first) => {
                self.synchronise();
                self.open = None;
                match self.create_next(&first) {
                    Ok((path, file)) => self.begin(path, file),
                    Err(error) => self.fail(error),
                }
            }
            Job::Append(bytes, cycles) => {
                let length = bytes.len() as u64;
                let appended = self.open.as_mut().map(|open| open.append(&bytes));
                let mut status = lock(&self.status);
                status.backlog -= length;
                if let Some(Ok(())) = appended {
                    status.written += length;
                } else {
                    status.cycles_lost += cycles;
                }
                drop(status);
                if let Some(Err(error)) = appended {
                    self.open = None;
                    self.fail(error);
                }
            }
            Job::BlackBox {
                directory,
                name,
                bytes,
                keep,
            } => {
                let path = directory.join(&name);
                let written = write_whole(&directory, &path, &bytes);
                let mut status = lock(&self.status);
                status.backlog -= bytes.len() as u64;
                status.black_box_waits = false;
                drop(status);
                match written {
                    Ok(path) => lock(&self.status).black_boxes.push(path),
                    Err(source) => {
                        let source = source.into();
                        fail_black_box(&self.status, RecordError::BlackBox { path, source });
                    }
                }
                delete_oldest(&directory, keep);
            }
        }
    }

    fn begin(&mut self, path: PathBuf, file: File) {
        lock(&self.status).files.push(path.clone());
        self.open = Some(Open {
            path,
            file,
            length: 0,
            dirty: false,
        });
    }

    /// Creates the next file of a recording, with the first unused number.
    fn create_next(&mut self, first: &Path) -> Result<(PathBuf, File), RecordError> {
        loop {
            self.number += 1;
            let path = numbered(first, self.number);
            match create(&path) {
                Err(RecordError::Exists { .. }) if self.number < NUMBER_MAX => {}
                made => return made.map(|file| (path, file)),
            }
        }
    }

    fn fail(&self, error: RecordError) {
        fail(&self.status, error);
    }

    /// Waits until the disk has stored the written data, if the option `sync` is set.
    fn synchronise(&mut self) {
        let Some(open) = &mut self.open else { return };
        if !(self.sync && open.dirty) {
            return;
        }
        open.dirty = false;
        if let Err(source) = open.file.sync_data() {
            let error = open.error(source);
            self.open = None;
            self.fail(error);
        }
    }
}

impl Open {
    /// Appends `bytes`. If the write fails, the file stays unchanged.
    fn append(&mut self, bytes: &[u8]) -> Result<(), RecordError> {
        self.dirty = true;
        match self.file.write_all(bytes) {
            Ok(()) => {
                self.length += bytes.len() as u64;
                Ok(())
            }
            Err(source) => {
                // Readers ignore a partial chunk at the end. Without it, no reader reports an
                // error.
                let _ = self.file.set_len(self.length);
                Err(self.error(source))
            }
        }
    }

    fn error(&self, source: io::Error) -> RecordError {
        RecordError::Write {
            path: self.path.clone(),
            bytes: self.length,
            source: source.into(),
        }
    }
}

/// Returns a name such as `run-0002.mcap` for the second file of `run.mcap`.
fn numbered(first: &Path, number: u32) -> PathBuf {
    let stem = first.file_stem().unwrap_or_default().to_string_lossy();
    let name = match first.extension() {
        Some(extension) => format!("{stem}-{number:04}.{}", extension.to_string_lossy()),
        None => format!("{stem}-{number:04}"),
    };
    first.with_file_name(name)
}

/// Largest number of files of a recording, including files of other recordings with the same name.
const NUMBER_MAX: u32 = 1_000_000;

/// Writes a file under a temporary name, and renames the file once it is complete. Replaces no
/// file: if `path` exists, the file gets the first unused number. Returns the path of the file.
fn write_whole(directory: &Path, path: &Path, bytes: &[u8]) -> io::Result<PathBuf> {
    fs::create_dir_all(directory)?;
    let prefix = path.with_extension("");
    let mut builder = tempfile::Builder::new();
    builder
        .prefix(prefix.file_name().unwrap_or_default())
        .suffix(".mcap.part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // Normal permissions, minus the user's mask.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(directory)?;
    file.write_all(bytes)?;
    file.as_file().sync_data()?;
    let (mut name, mut number) = (path.to_owned(), 1);
    loop {
        match file.persist_noclobber(&name) {
            Ok(_) => break,
            Err(refused)
                if refused.error.kind() == io::ErrorKind::AlreadyExists && number < NUMBER_MAX =>
            {
                file = refused.file;
                number += 1;
                name = numbered(path, number);
            }
            Err(refused) => return Err(refused.error),
        }
    }
    sync_directory(&name);
    Ok(name)
}

/// Deletes all black box files except the newest `keep`, and the incomplete files that crashes
/// left. Files that cannot be deleted are ignored.
fn delete_oldest(directory: &Path, keep: usize) {
    let Ok(entries) = fs::read_dir(directory) else {
        return;
    };
    let (mut whole, mut parts) = (Vec::new(), Vec::new());
    for entry in entries.filter_map(Result::ok) {
        let name = entry.file_name();
        match name.to_str().and_then(black_box::file_of_name) {
            Some(black_box::NamedFile::Whole) => whole.push(name),
            Some(black_box::NamedFile::Part) => parts.push(entry),
            None => {}
        }
    }
    // Another process may still be writing a more recent file.
    let is_left = |entry: &fs::DirEntry| {
        let modified = entry.metadata().and_then(|it| it.modified());
        modified.is_ok_and(|time| time.elapsed().is_ok_and(|age| age > PART_AGE))
    };
    for part in parts.iter().filter(|entry| is_left(entry)) {
        let _ = fs::remove_file(part.path());
    }
    // By stem: a numbered file is newer than the file without a number.
    whole.sort_unstable_by(|a, b| Path::new(a).file_stem().cmp(&Path::new(b).file_stem()));
    let surplus = whole.len().saturating_sub(keep);
    for name in &whole[..surplus] {
        let _ = fs::remove_file(directory.join(name));
    }
}

/// Age at which an incomplete file counts as left by a crash.
const PART_AGE: Duration = Duration::from_secs(3600);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_follow_are_numbered() {
        for (first, second) in [
            ("run.mcap", "run-0002.mcap"),
            ("a.b/run.of.today.mcap", "a.b/run.of.today-0002.mcap"),
            ("run", "run-0002"),
        ] {
            assert_eq!(numbered(Path::new(first), 2), Path::new(second));
        }
    }

    #[test]
    fn a_black_box_replaces_no_file_and_takes_the_next_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let first = path("20260301T120000.123Z-left-reflex.mcap");
        // Another process may be writing an incident of the same millisecond.
        fs::write(first.with_extension("mcap.part"), "part").unwrap();
        let names = ["one", "two", "three"].map(|bytes| {
            let written = write_whole(folder.path(), &first, bytes.as_bytes());
            written.unwrap()
        });
        let second = path("20260301T120000.123Z-left-reflex-0002.mcap");
        let third = path("20260301T120000.123Z-left-reflex-0003.mcap");
        assert_eq!(names, [&first, &second, &third].map(PathBuf::clone));
        for (path, bytes) in names.iter().zip(["one", "two", "three"]) {
            assert_eq!(fs::read_to_string(path).unwrap(), bytes);
        }
        delete_oldest(folder.path(), 1);
        let left = names.map(|path| path.exists());
        assert_eq!(left, [false, false, true], "the newest");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn black_boxes_of_other_processes_are_left_until_they_are_old() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let names = [
            "20260301T120000.123Z-left-reflex.mcap",
            "20260301T130000.123Z-left-reflex.mcap",
            "20260301T110000.123Z-left-reflex.mcap.part",
            "20260301T100000.123Z-left-reflex.mcap.part",
            "notes.part",
        ];
        for name in names {
            fs::write(path(name), "x").unwrap();
        }
        for name in [names[3], names[4]] {
            let old = std::time::SystemTime::now() - 2 * PART_AGE;
            let file = File::options().write(true).open(path(name)).unwrap();
            file.set_modified(old).unwrap();
        }
        delete_oldest(folder.path(), 1);
        let left = names.map(|name| path(name).exists());
        assert_eq!(left, [false, true, true, false, true]);
    }
}

//! The thread that waits for the disk, so that nothing else has to.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, Sender, TryRecvError};
use std::sync::{Arc, Mutex};
use std::thread;

use super::black_box;
use super::error::RecordError;
use super::lock;

/// What has become of the files so far.
#[derive(Clone, Debug, Default)]
pub(super) struct DiskStatus {
    /// Bytes that wait for the disk.
    pub(super) backlog: u64,
    /// Bytes in files.
    pub(super) written: u64,
    /// Cycles in what could not be written.
    pub(super) cycles_lost: u64,
    /// The files of the recording, oldest first.
    pub(super) files: Vec<PathBuf>,
    /// The files of the black box.
    pub(super) black_boxes: Vec<PathBuf>,
    /// Why the recording ended early.
    pub(super) error: Option<RecordError>,
    /// Why the newest black box could not be written.
    pub(super) black_box_error: Option<RecordError>,
}

/// The end of the disk's thread that gives it work.
#[derive(Debug)]
pub(super) struct Disk {
    jobs: Sender<Job>,
    status: Arc<Mutex<DiskStatus>>,
}

#[derive(Debug)]
enum Job {
    /// Ends the file that is open and begins this one.
    Open(PathBuf, Option<File>),
    /// Appends whole chunks with this many cycles.
    Append(Vec<u8>, u64),
    /// Writes a file of the black box at once and deletes the oldest beyond `keep`.
    BlackBox {
        directory: PathBuf,
        name: String,
        bytes: Vec<u8>,
        keep: usize,
    },
}

impl Disk {
    /// Starts the thread. It ends once this is dropped and all is written; `done` is then dropped.
    pub(super) fn start(sync: bool, done: Sender<()>) -> Result<Self, RecordError> {
        let (jobs, receiver) = mpsc::channel();
        let status = Arc::<Mutex<DiskStatus>>::default();
        let mut thread = DiskThread {
            jobs: receiver,
            status: status.clone(),
            open: None,
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

    /// Whether the recording can go on.
    pub(super) fn is_well(&self) -> bool {
        lock(&self.status).error.is_none()
    }

    /// Notes why the recording cannot go on.
    pub(super) fn fail(&self, error: RecordError) {
        fail(&self.status, error);
    }

    /// Notes why a black box could not be written.
    pub(super) fn fail_black_box(&self, error: RecordError) {
        fail_black_box(&self.status, error);
    }

    /// Begins a file, which may be open already.
    pub(super) fn open(&self, path: PathBuf, file: Option<File>) {
        self.order(Job::Open(path, file), 0);
    }

    /// Appends whole chunks, in which there are this many cycles.
    pub(super) fn append(&self, bytes: Vec<u8>, cycles: u64) {
        let length = bytes.len();
        self.order(Job::Append(bytes, cycles), length);
    }

    /// Counts cycles that were to be written and are not.
    pub(super) fn lose(&self, cycles: u64) {
        lock(&self.status).cycles_lost += cycles;
    }

    pub(super) fn black_box(&self, directory: PathBuf, dump: black_box::Dump, keep: usize) {
        let length = dump.bytes.len();
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
        // The thread is there as long as this is.
        let _ = self.jobs.send(job);
    }
}

/// Notes and logs why the recording cannot go on; the first reason stays.
fn fail(status: &Mutex<DiskStatus>, error: RecordError) {
    let mut status = lock(status);
    if status.error.is_none() {
        status.error = Some(error.clone());
        drop(status);
        tracing::error!(%error, "the recording ends here; robots go on");
    }
}

/// Notes and logs why a black box could not be written; the newest reason stays.
fn fail_black_box(status: &Mutex<DiskStatus>, error: RecordError) {
    tracing::error!(%error, "no black box of the incident");
    lock(status).black_box_error = Some(error);
}

/// Makes a file that is not there yet.
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

/// Makes the name of a file outlast a power cut. Where directories cannot be synchronised, their
/// file systems need no such thing.
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
    sync: bool,
}

/// The file that grows.
struct Open {
    path: PathBuf,
    file: File,
    /// Its length: all of it whole chunks.
    length: u64,
    /// Whether some of it may not have reached the disk.
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
            Job::Open(path, file) => {
                self.synchronise();
                self.open = None;
                match file.map_or_else(|| create(&path), Ok) {
                    Ok(file) => {
                        lock(&self.status).files.push(path.clone());
                        self.open = Some(Open {
                            path,
                            file,
                            length: 0,
                            dirty: false,
                        });
                    }
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
                lock(&self.status).backlog -= bytes.len() as u64;
                match written {
                    Ok(()) => lock(&self.status).black_boxes.push(path),
                    Err(source) => {
                        let source = source.into();
                        fail_black_box(&self.status, RecordError::BlackBox { path, source });
                    }
                }
                delete_oldest(&directory, keep);
            }
        }
    }

    fn fail(&self, error: RecordError) {
        fail(&self.status, error);
    }

    /// Waits until the disk has what was written, if that is wanted.
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
    /// Appends `bytes`, or leaves the file as it was.
    fn append(&mut self, bytes: &[u8]) -> Result<(), RecordError> {
        self.dirty = true;
        match self.file.write_all(bytes) {
            Ok(()) => {
                self.length += bytes.len() as u64;
                Ok(())
            }
            Err(source) => {
                // Part of a chunk at the end is left out by readers; without it, none complains.
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

/// Writes a file that has its name only once it is complete.
fn write_whole(directory: &Path, path: &Path, bytes: &[u8]) -> io::Result<()> {
    fs::create_dir_all(directory)?;
    let part = path.with_extension("mcap.part");
    let mut file = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&part)?;
    let written = file
        .write_all(bytes)
        .and_then(|()| file.sync_data())
        .and_then(|()| fs::rename(&part, path));
    if written.is_err() {
        let _ = fs::remove_file(&part);
    }
    sync_directory(path);
    written
}

/// Deletes the oldest files of black boxes, so that `keep` are left. A file that cannot be deleted
/// stays.
fn delete_oldest(directory: &Path, keep: usize) {
    let Ok(entries) = fs::read_dir(directory) else {
        return;
    };
    let mut names: Vec<_> = entries
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| black_box::is_file_name(name))
        .collect();
    names.sort_unstable();
    let surplus = names.len().saturating_sub(keep);
    for name in &names[..surplus] {
        let _ = fs::remove_file(directory.join(name));
    }
}

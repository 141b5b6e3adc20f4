//! Recordings of robots in files, and the black box.

mod episode;
mod options;
mod status;

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use franka_async::recording::{self, Episode, RecordError, RecordStatus, Track};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyDict};
use tokio::sync::RwLock;

use crate::errors::Raise;
use crate::gripper::Gripper;
use crate::operation::Operation;
use crate::options::Keywords;
use crate::robot::Robot;
use crate::runtime::{self, Threaded};
use crate::team::{Members, Team};
use crate::vacuum_gripper::VacuumGripper;
pub(crate) use episode::EpisodeUnderWay;
use status::Status;

/// Records robots to a file, with every cycle and every request: `async with
/// Recorder.to_file("run.mcap") as recorder:`, and in it `await recorder.attach(robot)`. The end of
/// the block ends the recording and waits until it is on the disk.
///
/// Separate threads write the file, without the interpreter. The recorder cannot delay a cycle:
/// data without space is dropped and counted. Without a block, `await recorder.finish()` ends it.
/// When its last reference is dropped it ends in the background, possibly without the newest
/// events; after the exit of the interpreter, the data written by then is readable.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Recorder {
    shared: Threaded<Arc<Shared>>,
    to: PathBuf,
}

struct Shared {
    stage: RwLock<Stage>,
    /// The last known status, for calls while the recording is being finished.
    newest: Mutex<RecordStatus>,
    /// True if an episode has begun and not ended.
    in_episode: AtomicBool,
}

enum Stage {
    Recording(recording::Recorder),
    Ended(RecordStatus),
}

#[pymethods]
impl Recorder {
    /// Begins a recording in a new MCAP file at `path`, whose folder must exist.
    ///
    /// Options: `thinned`, true to keep the full rate only around notable cycles (reflexes,
    /// contacts, failures), and otherwise every tenth cycle. `flush`, the longest time between two
    /// writes, 0.01 to 1 s (1): the largest loss in a crash. `sync`, true to force each write to
    /// the disk, against power failures (`True`). `rotate_bytes` and `rotate_time`, s: when to
    /// begin a new file, `run-0002.mcap` after `run.mcap`. `metadata`, a `dict` of texts, and
    /// `attachments`, a `dict` of file names and bytes, are stored in the file. `black_box`, a
    /// `recording.BlackBox`, also writes the last seconds before an incident to a separate file.
    ///
    /// Raises `RecordError` if the file exists or cannot be created, `ValueError`.
    #[staticmethod]
    #[pyo3(signature = (path, **options))]
    fn to_file(
        py: Python<'_>,
        path: PathBuf,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut keywords = Keywords::new("Recorder.to_file", options)?;
        let options = options::of_file(py, &mut keywords)?;
        keywords.end()?;
        Self::begin(py, path, |path| recording::Recorder::to_file(path, options))
    }

    /// Keeps only the last `before` seconds, 1 to 300, in memory. When a motion ends because of a
    /// reflex, a lost link or a guard, it writes them to a file in `directory`, together with the
    /// following `after` seconds, at most 60. The file is named by time, robot and cause. The
    /// newest `keep` files are kept.
    ///
    /// Raises `RecordError`, `ValueError`.
    #[staticmethod]
    #[pyo3(signature = (directory, *, before = 30.0, after = 1.0, keep = 20))]
    fn black_box(
        py: Python<'_>,
        directory: PathBuf,
        before: f64,
        after: f64,
        keep: usize,
    ) -> PyResult<Self> {
        let black_box = options::black_box(directory.clone(), before, after, keep)?;
        Self::begin(py, directory, |_| recording::Recorder::black_box(black_box))
    }

    /// Records a connected robot from now on: every cycle, goals and their outcomes, diagnoses,
    /// events and requests; if the robot is supervised, also after a reconnect. `name`, of letters,
    /// digits, `-` and `_`, distinguishes the robots of a recording. `with_address` stores the
    /// network address. `capacity` is the number of cycles that may wait for the recorder, 4096 by
    /// default. Raises `RecordError`, `ValueError`. Cancelling aborts it.
    #[pyo3(signature = (robot, name = "", *, with_address = false, capacity = None))]
    fn attach(
        &self,
        robot: &Bound<'_, Robot>,
        name: &str,
        with_address: bool,
        capacity: Option<usize>,
    ) -> PyResult<Operation> {
        let robot = robot.get().connected()?;
        let track = track(name, with_address, capacity);
        let shared = self.shared.clone();
        Ok(Operation::new("Recorder.attach", async move {
            match &*shared.stage.read().await {
                Stage::Recording(recorder) => recorder.attach(&robot, track).await,
                Stage::Ended(_) => Err(RecordError::Ended.into()),
            }
        }))
    }

    /// Records the robots of a team, each with its name and its member number; otherwise like
    /// `attach`. If an error concerns one robot, the previous ones are recorded.
    #[pyo3(signature = (team, names, *, with_address = false, capacity = None))]
    fn attach_team(
        &self,
        team: &Bound<'_, Team>,
        names: Vec<String>,
        with_address: bool,
        capacity: Option<usize>,
    ) -> PyResult<Operation> {
        team.get().check_count("names", names.len())?;
        let named = names.iter().map(|name| track(name, with_address, capacity));
        let tracks: Vec<Track> = named.collect();
        let members = team.get().members.clone();
        let shared = self.shared.clone();
        Ok(Operation::new("Recorder.attach_team", async move {
            let stage = shared.stage.read().await;
            let Stage::Recording(recorder) = &*stage else {
                return Err(RecordError::Ended.into());
            };
            match &*members {
                Members::Two(team) => recorder.attach_team(team, sized(tracks)).await,
                Members::Three(team) => recorder.attach_team(team, sized(tracks)).await,
                Members::Four(team) => recorder.attach_team(team, sized(tracks)).await,
            }
        }))
    }

    /// Records an end effector, a connected `Gripper` or `VacuumGripper`, with the robot of this
    /// name: its states, and completed actions. Raises `RecordError` unless that robot is attached.
    #[pyo3(signature = (gripper, robot = ""))]
    fn attach_gripper(
        &self,
        py: Python<'_>,
        gripper: &Bound<'_, PyAny>,
        robot: &str,
    ) -> PyResult<()> {
        let attached = if let Ok(hand) = gripper.cast::<Gripper>() {
            let hand = hand.get().0.connected()?;
            self.with(py, |recorder| recorder.attach_gripper(&hand, robot))?
        } else if let Ok(vacuum) = gripper.cast::<VacuumGripper>() {
            let vacuum = vacuum.get().0.connected()?;
            self.with(py, |recorder| {
                recorder.attach_vacuum_gripper(&vacuum, robot)
            })?
        } else {
            let text = format!(
                "gripper is {}, expected a Gripper or a VacuumGripper",
                gripper.get_type().name()?
            );
            return Err(PyTypeError::new_err(text));
        };
        attached.map_err(|error| error.raise(py))
    }

    /// Records a remark, for all robots. Raises `RecordError` if the recording has ended.
    fn note(&self, py: Python<'_>, text: String) -> PyResult<()> {
        self.with(py, |recorder| recorder.note(text))
    }

    /// An episode, an attempt at a task, while a `with` block runs: `with
    /// recorder.episode("pick-1", task="pick the cube") as episode:`. The block sets
    /// `episode.success` to `True` or `False`. Otherwise it is `None`, not judged, or `False` if
    /// the block raises. One episode runs at a time. `name` has letters, digits, `-` and `_`;
    /// raises `ValueError`.
    #[pyo3(signature = (name, *, task))]
    fn episode(&self, name: String, task: String) -> PyResult<EpisodeUnderWay> {
        Episode::check(&name, &task).map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(EpisodeUnderWay::new(self.shared.clone(), name, task))
    }

    /// Progress and failures of the recording, a `recording.RecordStatus`.
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let status = py.detach(|| self.shared.status());
        Status(status).into_pyobject(py)
    }

    /// Ends the recording and waits, at most 10 s, until all of it is on the disk, including the
    /// events before the call. Returns the `recording.RecordStatus`, also if it has already ended.
    /// Raises `RecordError` if the files could not be completed; the written data is readable. Once
    /// begun, it continues even if it is cancelled.
    fn finish(&self) -> Operation {
        Operation::new("Recorder.finish", finish(self.shared.clone()))
    }

    fn __aenter__(this: Py<Self>) -> Operation {
        Operation::infallible("Recorder", async move { this })
    }

    #[pyo3(signature = (kind = None, *_rest))]
    fn __aexit__(&self, kind: Option<&Bound<'_, PyAny>>, _rest: &Bound<'_, PyAny>) -> Operation {
        // The block's exception is not replaced.
        let raised = kind.is_some_and(|kind| !kind.is_none());
        let finished = finish(self.shared.clone());
        Operation::new("Recorder.finish", async move {
            match finished.await {
                Err(error) if !raised => Err(error),
                _ => Ok(()),
            }
        })
    }

    fn __repr__(&self) -> String {
        let RecordStatus {
            cycles, dropped, ..
        } = self.shared.status();
        let to = self.to.display();
        format!("<Recorder to {to}, {cycles} cycles, {dropped} dropped>")
    }
}

impl Recorder {
    fn begin(
        py: Python<'_>,
        to: PathBuf,
        begin: impl FnOnce(&PathBuf) -> Result<recording::Recorder, RecordError> + Send,
    ) -> PyResult<Self> {
        // In a forked child it is dropped without waiting for threads that do not exist.
        runtime::runtime()?;
        let recorder = py.detach(|| begin(&to)).map_err(|error| error.raise(py))?;
        let newest = recorder.status();
        Ok(Self {
            shared: Threaded::new(Arc::new(Shared {
                stage: RwLock::new(Stage::Recording(recorder)),
                newest: Mutex::new(newest),
                in_episode: AtomicBool::new(false),
            })),
            to,
        })
    }

    /// Runs a function with the recorder, with the interpreter released.
    fn with<T: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&recording::Recorder) -> T + Send,
    ) -> PyResult<T> {
        runtime::runtime()?;
        let done = py.detach(|| self.shared.with(act));
        done.map_err(|error| error.raise(py))
    }
}

impl Shared {
    /// Runs a function with the recorder.
    ///
    /// # Errors
    /// [`RecordError::Ended`] also while it is being finished.
    fn with<T>(&self, act: impl FnOnce(&recording::Recorder) -> T) -> Result<T, RecordError> {
        match self.stage.try_read().as_deref() {
            Ok(Stage::Recording(recorder)) => Ok(act(recorder)),
            Ok(Stage::Ended(_)) | Err(_) => Err(RecordError::Ended),
        }
    }

    fn status(&self) -> RecordStatus {
        let status = match self.stage.try_read().as_deref() {
            Ok(Stage::Recording(recorder)) => recorder.status(),
            Ok(Stage::Ended(status)) => status.clone(),
            Err(_) => return self.newest().clone(),
        };
        self.newest().clone_from(&status);
        status
    }

    fn newest(&self) -> MutexGuard<'_, RecordStatus> {
        self.newest.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Ends the recording, and waits for that on a thread that may block.
async fn finish(shared: Arc<Shared>) -> Result<Status, RecordError> {
    let finished = tokio::task::spawn_blocking(move || {
        shared.status();
        let mut stage = shared.stage.blocking_write();
        let ended = Stage::Ended(shared.newest().clone());
        match std::mem::replace(&mut *stage, ended) {
            Stage::Recording(recorder) => {
                let finished = recorder.finish();
                let mut status = shared.newest().clone();
                match finished {
                    Ok(finished) => status = finished,
                    Err(error) => status.error = Some(error),
                }
                *stage = Stage::Ended(status);
            }
            ended => *stage = ended,
        }
        match &*stage {
            Stage::Ended(status) => match &status.error {
                None => Ok(Status(status.clone())),
                Some(error) => Err(error.clone()),
            },
            Stage::Recording(_) => unreachable!("it has just been ended"),
        }
    });
    finished.await.expect("it does not panic")
}

fn track(name: &str, with_address: bool, capacity: Option<usize>) -> Track {
    let default = Track::named(name);
    Track {
        with_address,
        capacity: capacity.unwrap_or(default.capacity),
        ..default
    }
}

fn sized<const N: usize>(tracks: Vec<Track>) -> [Track; N] {
    tracks.try_into().expect("as many as members: checked")
}

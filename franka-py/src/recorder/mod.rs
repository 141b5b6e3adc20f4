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

/// Records robots in a file, every cycle and what was asked of them: `async with
/// Recorder.to_file("run.mcap") as recorder:`, and in it `await recorder.attach(robot)`. The end of
/// the block ends the recording and waits until it is on the disk.
///
/// Threads of its own write the file, beside the interpreter. Nothing that it does delays a cycle:
/// what there is no room for is dropped and counted. Without a block, `await recorder.finish()`
/// ends it. When the last reference goes it ends in the background, perhaps without the newest
/// events; at the exit of the interpreter, what was written by then is readable.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Recorder {
    shared: Threaded<Arc<Shared>>,
    to: PathBuf,
}

struct Shared {
    stage: RwLock<Stage>,
    /// As it was read last: for those who ask while the recording is being finished.
    newest: Mutex<RecordStatus>,
    /// Whether an episode has begun and not ended.
    in_episode: AtomicBool,
}

enum Stage {
    Recording(recording::Recorder),
    Ended(RecordStatus),
}

#[pymethods]
impl Recorder {
    /// Begins a recording in a new MCAP file at `path`, whose folder has to be there.
    ///
    /// Options: `thinned`, whether cycles are kept at the full rate only around what is notable
    /// (reflexes, contacts, failures), else every tenth. `flush`, the longest time between two
    /// writes, 0.01 to 1 s (1): what a crash can lose. `sync`, whether each write is forced to the
    /// disk, against power cuts (`True`). `rotate_bytes` and `rotate_time`, s: after which a new
    /// file is begun, `run-0002.mcap` after `run.mcap`. `metadata`, a `dict` of texts, and
    /// `attachments`, a `dict` of file names and bytes, go into the file. `black_box`, a
    /// `recording.BlackBox`, also writes the last seconds before an incident to a file of their
    /// own.
    ///
    /// Raises `RecordError` if there is such a file or it cannot be made, `ValueError`.
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

    /// Keeps the last `before` seconds, 1 to 300, in memory only. When a motion ends by a reflex, a
    /// lost link or a guard, it writes them and the `after` seconds that follow, 60 at most, to a
    /// file in `directory`, named by time, robot and cause. The newest `keep` files are kept.
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

    /// Records a robot, which is connected, from now on: every cycle, goals and how they end,
    /// diagnoses, events and requests; of a supervised robot also after it was connected to again.
    /// `name`, of letters, digits, `-` and `_`, tells several robots of a recording apart.
    /// `with_address` writes the network address down. `capacity` is how many cycles may wait for
    /// the recorder, 4096 by default. Raises `RecordError`, `ValueError`. Cancelling gives it up.
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

    /// Records the robots of a team, each under its name, and which member each is; otherwise like
    /// `attach`. Robots before the one that an error is about are recorded.
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
    /// name: its states, and actions when they have ended. Raises `RecordError` unless that robot
    /// is attached.
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

    /// An episode, an attempt at a task, while a `with` block runs:
    /// `with recorder.episode("pick-1", task="pick the cube") as episode:`. The block sets
    /// `episode.success` to `True` or `False`; it is `None`, not judged, unless that was done, and
    /// `False` if the block raises. One episode runs at a time. `name` has letters, digits, `-` and
    /// `_`; raises `ValueError`.
    #[pyo3(signature = (name, *, task))]
    fn episode(&self, name: String, task: String) -> PyResult<EpisodeUnderWay> {
        Episode::check(&name, &task).map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(EpisodeUnderWay::new(self.shared.clone(), name, task))
    }

    /// What was recorded so far and what has failed, a `recording.RecordStatus`.
    fn status<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let status = py.detach(|| self.shared.status());
        Status(status).into_pyobject(py)
    }

    /// Ends the recording and waits, 10 s at most, until all of it is on the disk: what has
    /// happened before the call is in it. Returns the `recording.RecordStatus`, again if it has
    /// ended. Raises `RecordError` if the files could not be written to their end; what was written
    /// is readable. Once it has begun, it goes on even if it is cancelled.
    fn finish(&self) -> Operation {
        Operation::new("Recorder.finish", finish(self.shared.clone()))
    }

    fn __aenter__(this: Py<Self>) -> Operation {
        Operation::infallible("Recorder", async move { this })
    }

    #[pyo3(signature = (kind = None, *_rest))]
    fn __aexit__(&self, kind: Option<&Bound<'_, PyAny>>, _rest: &Bound<'_, PyAny>) -> Operation {
        // What the block raised is not replaced.
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
        // In a forked child it is dropped without waiting for threads that are not there.
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

    /// Does something with the recorder, with the interpreter released.
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
    /// Does something with the recorder.
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

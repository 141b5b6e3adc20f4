//! Reads recordings: columns as arrays, cycles, events, episodes.

mod cycles;
mod export;

use std::path::PathBuf;
use std::sync::Arc;

use franka_async::connection::Version;
use franka_async::model::RobotKind;
use franka_async::recording::event::{Event, EventKind};
use franka_async::recording::{
    Cycle, Episode, GripperState, HostTime, RecordedRobot, Recording, RecordingError,
    RobotRecording, Sample, Samples,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyTuple};

use crate::errors::{Raise, made};
use crate::gripper;
use crate::model::Model;
use crate::names::Named;
use crate::vacuum_gripper::VacuumGripperState;
use cycles::Rows;
pub(crate) use cycles::{Cycles, RecordedCycle, recording_columns};

/// Text of the error for a recording without a kind of robot.
pub(crate) const NO_KIND: &str = "the recording does not name the kind of its robot";

type EachCycle = Box<dyn Iterator<Item = Result<Cycle, RecordingError>> + Send>;

/// The recording of a robot in a file, or a part of its time, as returned by
/// `RecordingFile.open("run.mcap")`.
///
/// Data is read on request only, and only the requested part. Reading releases the interpreter.
/// `column("q")` is an array with a row for each cycle; `for cycle in recording:` provides the
/// whole state of each. A damaged part raises `RecordingError`.
///
/// Times in the file are this computer's clock, whole nanoseconds since 1970.
#[pyclass(frozen, module = "franka_async", name = "RecordingFile")]
#[derive(Clone)]
pub(crate) struct RecordingFile {
    recording: Arc<Recording>,
    /// Name of the robot; `None` until one of several was chosen.
    robot: Option<String>,
    from: HostTime,
    to: HostTime,
    rate: Option<f64>,
}

#[pymethods]
impl RecordingFile {
    /// Opens a recording. A recording without an end is read up to the last whole part: see
    /// `damage`. Raises `RecordingError`.
    #[staticmethod]
    fn open(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let opened = py.detach(|| Recording::open(path));
        let recording = opened.map_err(|error| error.raise(py))?;
        let robot = match recording.robots() {
            [only] => Some(only.name.clone()),
            _ => None,
        };
        Ok(Self {
            recording: Arc::new(recording),
            robot,
            from: HostTime::default(),
            to: HostTime::from_nanos(u64::MAX),
            rate: None,
        })
    }

    /// Writes the intact parts of the file `damaged` to a new file, with the missing index. Returns
    /// a `recording.Recovery`. Raises `RecordingError`.
    #[staticmethod]
    fn recover<'py>(
        py: Python<'py>,
        damaged: PathBuf,
        whole: PathBuf,
    ) -> PyResult<Bound<'py, PyAny>> {
        let recovered = py.detach(|| Recording::recover(damaged, whole));
        let recovery = recovered.map_err(|error| error.raise(py))?;
        value(
            py,
            "Recovery",
            (
                recovery.messages,
                recovery.chunks,
                recovery.lost,
                recovery.damage,
            ),
        )
    }

    /// Damage of the file, after a crash, a power failure or on a full disk; `None` if it is
    /// complete. The flushed data can still be read.
    #[getter]
    fn damage(&self) -> Option<&str> {
        self.recording.damage()
    }

    /// Times of the first and the last message of the file; `None` if it has no messages.
    #[getter]
    fn span(&self) -> Option<(u64, u64)> {
        let (begin, end) = self.recording.span()?;
        Some((begin.as_nanos(), end.as_nanos()))
    }

    /// Metadata of the whole recording: versions, host, kernel, options.
    #[getter]
    fn metadata<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.recording.metadata().into_pyobject(py)
    }

    /// The robots of the file, each a `recording.RecordedRobot`.
    #[getter]
    fn robots<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let robots = self.recording.robots().iter();
        let made = robots.map(|robot| {
            let kind = robot.kind.map(|kind| kind.python_name());
            value(
                py,
                "RecordedRobot",
                (&*robot.name, kind, robot.metadata.clone()),
            )
        });
        made.collect()
    }

    /// The model of the robot, with the limits of its attached description. Raises `ValueError` if
    /// the file does not name the kind of robot.
    fn model(&self, py: Python<'_>) -> PyResult<Model> {
        match self.view(py, |view| view.model())? {
            Some(recorded) => Ok(Model::of(&recorded.model)),
            None => Err(PyValueError::new_err(NO_KIND)),
        }
    }

    /// Names of the attached files.
    fn attachments(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let names = py.detach(|| self.recording.attachments());
        names.map_err(|error| error.raise(py))
    }

    /// Returns the bytes of an attached file; `None` if no file has this name, or it is damaged.
    fn attachment<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<Option<Bound<'py, PyBytes>>> {
        let data = py.detach(|| self.recording.attachment(name));
        let data = data.map_err(|error| error.raise(py))?;
        Ok(data.map(|data| PyBytes::new(py, &data)))
    }

    /// The recording of the robot with this name, if there are several. Raises `RecordingError`.
    fn robot(&self, py: Python<'_>, name: String) -> PyResult<Self> {
        self.recording
            .robot(&name)
            .map_err(|error| error.raise(py))?;
        Ok(Self {
            robot: Some(name),
            ..self.clone()
        })
    }

    /// The part from one time to another, both included; `None` means no bound.
    #[pyo3(signature = (begin = None, end = None))]
    fn between(&self, begin: Option<u64>, end: Option<u64>) -> Self {
        let begin = HostTime::from_nanos(begin.unwrap_or(0));
        let end = HostTime::from_nanos(end.unwrap_or(u64::MAX));
        Self {
            from: self.from.max(begin),
            to: self.to.min(end),
            ..self.clone()
        }
    }

    /// The recording at `rate` cycles per second of the robot's clock, at most 1000: at each time
    /// the newest cycle before it. Events and grippers are unchanged.
    fn resampled(&self, rate: f64) -> PyResult<Self> {
        if !(rate > 0.0 && rate <= 1000.0) {
            let text = format!("rate is {rate}, expected more than 0 and at most 1000 per second");
            return Err(PyValueError::new_err(text));
        }
        Ok(Self {
            rate: Some(rate),
            ..self.clone()
        })
    }

    /// Every cycle: `for cycle in recording:`.
    fn __iter__(&self, py: Python<'_>) -> PyResult<Cycles> {
        Ok(Cycles::new(self.cycles(py)?, self.version()))
    }

    /// Returns a column as a new array with a row for each cycle: one of `recording_columns()`, or
    /// `time`, the robot's clock, s, or `host_time`. Raises `ValueError`.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        self.rows(py, &[name])?.column(py, name)
    }

    /// Returns columns as new arrays, in one pass: a `dict` by name, `time` and `host_time`
    /// included.
    fn columns<'py>(&self, py: Python<'py>, names: Vec<String>) -> PyResult<Bound<'py, PyDict>> {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let rows = self.rows(py, &names)?;
        let all = PyDict::new(py);
        for name in ["time", "host_time"].iter().chain(&names) {
            all.set_item(name, rows.column(py, name)?)?;
        }
        Ok(all)
    }

    /// The events, oldest first: a list of `recording.RecordedEvent`.
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let events = self.read_events(py)?;
        events.iter().map(|event| event_object(py, event)).collect()
    }

    /// The episodes, in their order: a list of `recording.Episode`. An episode without an end is
    /// left out.
    fn episodes<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let episodes = self.read_episodes(py)?.into_iter();
        let made = episodes.map(|episode| {
            let (begin, end) = (episode.begin.as_nanos(), episode.end.as_nanos());
            let fields = (episode.name, episode.task, episode.success, begin, end);
            value(py, "Episode", fields)
        });
        made.collect()
    }

    /// The gripper's states, oldest first: a list of tuples of time and `GripperState` or
    /// `VacuumGripperState`.
    fn gripper_states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let states = self.view(py, |view| {
            view.gripper_states().collect::<Result<Vec<_>, _>>()
        })?;
        let states = states.map_err(|error| error.raise(py))?;
        let all = PyList::empty(py);
        for (time, state) in states {
            let time = time.as_nanos();
            match state {
                GripperState::Hand(state) => all.append((time, gripper::GripperState(state)))?,
                GripperState::Vacuum(state) => all.append((time, VacuumGripperState(state)))?,
            }
        }
        Ok(all)
    }

    fn __repr__(&self) -> String {
        let robots = self.recording.robots().iter().map(|robot| match robot {
            RecordedRobot {
                kind: Some(kind),
                name,
                ..
            } if name.is_empty() => kind.python_name().to_owned(),
            robot => robot.name.clone(),
        });
        let robots: Vec<String> = match &self.robot {
            Some(name) if !name.is_empty() => vec![name.clone()],
            _ => robots.collect(),
        };
        let lasts = match self.recording.span() {
            None => "empty".to_owned(),
            Some((begin, end)) => {
                let (begin, end) = (begin.max(self.from), end.min(self.to));
                format!("{:.1} s", end.since(begin).as_secs_f64())
            }
        };
        let damaged = self.recording.damage().map_or("", |_| ", damaged");
        format!("<RecordingFile of {}, {lasts}{damaged}>", robots.join(", "))
    }
}

impl RecordingFile {
    /// Returns the name of the robot to read.
    ///
    /// # Errors
    /// `ValueError` if the file contains no robot, or several and none was chosen.
    pub(super) fn chosen(&self) -> PyResult<&str> {
        self.robot.as_deref().ok_or_else(|| {
            let robots = self.recording.robots().iter();
            let names: Vec<&str> = robots.map(|robot| &*robot.name).collect();
            PyValueError::new_err(match names.len() {
                0 => "the recording has no robot".to_owned(),
                count => format!(
                    "the recording has {count} robots, {names:?}: choose one with robot(name)"
                ),
            })
        })
    }

    /// Reads from the recording of the robot, with the interpreter released.
    ///
    /// # Errors
    /// The errors of [`RecordingFile::chosen`].
    pub(crate) fn view<T: Send>(
        &self,
        py: Python<'_>,
        read: impl FnOnce(&RobotRecording<'_>) -> T + Send,
    ) -> PyResult<T> {
        let robot = self.chosen()?;
        let view = self
            .recording
            .robot(robot)
            .map_err(|error| error.raise(py))?;
        Ok(py.detach(|| read(&view.from(self.from).to(self.to))))
    }

    /// Returns the samples of the chosen robot.
    pub(crate) fn samples(&self) -> Result<Vec<Sample>, RecordingError> {
        let robot = self.robot.as_deref().unwrap_or_default();
        let view = self.recording.robot(robot)?.from(self.from).to(self.to);
        Samples::new(view.cycles(), view.gripper_states()).collect()
    }

    fn cycles(&self, py: Python<'_>) -> PyResult<EachCycle> {
        let rate = self.rate;
        self.view(py, |view| match rate {
            Some(rate) => Box::new(view.resampled(rate)) as EachCycle,
            None => Box::new(view.cycles()),
        })
    }

    fn rows(&self, py: Python<'_>, names: &[&str]) -> PyResult<Rows> {
        let columns = cycles::chosen(names)?;
        let cycles = self.cycles(py)?;
        py.detach(|| Rows::read(cycles, columns))
            .map_err(|error| error.raise(py))
    }

    fn read_events(&self, py: Python<'_>) -> PyResult<Vec<Event>> {
        let events = self.view(py, |view| view.events().collect::<Result<_, _>>())?;
        events.map_err(|error: RecordingError| error.raise(py))
    }

    fn read_episodes(&self, py: Python<'_>) -> PyResult<Vec<Episode>> {
        let episodes = self.view(py, |view| Episode::of(view.events()))?;
        episodes.map_err(|error| error.raise(py))
    }

    /// Returns the kind of the robot, if the file names it.
    pub(crate) fn kind(&self) -> Option<RobotKind> {
        let mut robots = self.recording.robots().iter();
        let robot = robots.find(|robot| Some(&robot.name) == self.robot.as_ref());
        robot.and_then(|robot| robot.kind)
    }

    fn version(&self) -> Version {
        match self.kind() {
            Some(RobotKind::Fer) => Version::V5,
            _ => Version::V10,
        }
    }
}

/// Returns an event as a `recording.RecordedEvent`.
fn event_object<'py>(py: Python<'py>, event: &Event) -> PyResult<Bound<'py, PyAny>> {
    let kind = &event.kind;
    let goal = match kind {
        EventKind::Goal(goal) => Some(goal.number),
        EventKind::Outcome(outcome) => Some(outcome.goal),
        EventKind::Diagnosis(diagnosis) => Some(diagnosis.goal),
        _ => None,
    };
    let ending = match kind {
        EventKind::Outcome(outcome) => Some(outcome.ending.python_name()),
        _ => None,
    };
    let fields = (
        event.time.as_nanos(),
        event.robot_time,
        kind.python_name(),
        kind.level().python_name(),
        kind.source(),
        kind.to_string(),
        goal,
        ending,
    );
    value(py, "RecordedEvent", fields)
}

/// Returns an object of a class of `recording.py`.
pub(crate) fn value<'py>(
    py: Python<'py>,
    class: &str,
    fields: impl IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error = PyErr>,
) -> PyResult<Bound<'py, PyAny>> {
    let class = py.import("franka_async.recording")?.getattr(class)?;
    class.call1(fields.into_pyobject(py)?)
}

impl Raise for RecordingError {
    fn raise(self, py: Python<'_>) -> PyErr {
        let party = match &self {
            Self::NoRobot { .. } | Self::NotMcap { .. } | Self::Foreign { .. } => "caller",
            _ => "host",
        };
        let text = self.to_string();
        made(py, "RecordingError", self.python_name(), party, &text)
    }
}

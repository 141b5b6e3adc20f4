//! Replays of recorded motions by an arm.

use franka_async::Error;
use franka_async::model::{Model, RobotKind};
use franka_async::recording::RecordingError;
use franka_async::replay::{
    ReplayError, ReplayFailure, ReplayOptions, ReplayPlan, ReplayReport, ReplaySource,
    ReplayTargets, Spread,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::arm::Arm;
use crate::errors::{Raise, made};
use crate::names::Named;
use crate::operation::Operation;
use crate::recording::{NO_KIND, RecordingFile, value};
use crate::robot::Robot;
use crate::told::Telling;

#[pymethods]
impl Robot {
    /// Moves to the beginning of a recorded motion, repeats it, and releases the arm. This is
    /// `Arm.replay` in a session with default options.
    #[pyo3(signature = (recording, *, speed = 1.0, source = "reference", targets = "joints"))]
    fn replay(
        &self,
        py: Python<'_>,
        recording: &Bound<'_, RecordingFile>,
        speed: f64,
        source: &str,
        targets: &str,
    ) -> PyResult<Operation> {
        let robot = self.connected()?;
        let motion = Motion::new(py, recording, speed, source, targets)?;
        Ok(Operation::new("Robot.replay", async move {
            let plan = motion.plan(robot.model()).await?;
            Ok::<_, Failure>(Report(robot.replay(&plan).await?))
        }))
    }
}

#[pymethods]
impl Arm {
    /// Moves to the beginning of the recorded motion, like `move_joints`, and then follows the
    /// motion of a `RecordingFile`, or of a part from `between`, with all guards of the session.
    /// Returns a `recording.ReplayReport` once the arm is at rest.
    ///
    /// `speed` is 0.01 to 1, as a share of the recorded speed. `source` is `reference`, the
    /// commanded positions, or `measured`, the measured positions: for arms that were moved by
    /// hand. `targets` is `joints`, or `poses`: the hand moves as recorded, but the elbow can
    /// differ.
    ///
    /// Raises `ReplayError` for a motion that is invalid for this arm, before the arm moves, and of
    /// the kind `off` if the arm is far from its recorded position; `MotionError`,
    /// `RecordingError`, `ValueError`. Cancelling brakes the arm.
    #[pyo3(signature = (recording, *, speed = 1.0, source = "reference", targets = "joints"))]
    fn replay(
        &self,
        py: Python<'_>,
        recording: &Bound<'_, RecordingFile>,
        speed: f64,
        source: &str,
        targets: &str,
    ) -> PyResult<Operation> {
        let (told, arm) = self.told_session()?;
        let motion = Motion::new(py, recording, speed, source, targets)?;
        Ok(Operation::new("Arm.replay", async move {
            let plan = motion.plan(arm.robot().model()).await?;
            let replayed = arm.replay(&plan).await;
            replayed.map(Report).map_err(|failure| match failure {
                ReplayFailure::Motion(error) => Failure::Motion(Telling {
                    error,
                    of: Some((told, arm)),
                }),
                failure => Failure::Replay(failure),
            })
        }))
    }
}

/// A recorded motion to be repeated.
struct Motion {
    recording: RecordingFile,
    kind: RobotKind,
    options: ReplayOptions,
}

impl Motion {
    fn new(
        py: Python<'_>,
        recording: &Bound<'_, RecordingFile>,
        speed: f64,
        source: &str,
        targets: &str,
    ) -> PyResult<Self> {
        let refused = |text: String| Err(PyValueError::new_err(text));
        let source = match source {
            "reference" => ReplaySource::Reference,
            "measured" => ReplaySource::Measured,
            _ => {
                return refused(format!(
                    "source is {source:?}, expected 'reference' or 'measured'"
                ));
            }
        };
        let targets = match targets {
            "joints" => ReplayTargets::Joints,
            "poses" => ReplayTargets::Poses,
            _ => {
                return refused(format!(
                    "targets is {targets:?}, expected 'joints' or 'poses'"
                ));
            }
        };
        // The kind of robot must be known.
        recording.get().view(py, |_| ())?;
        let Some(kind) = recording.get().kind() else {
            return refused(NO_KIND.to_owned());
        };
        let options = ReplayOptions::default().speed(speed);
        Ok(Self {
            recording: recording.get().clone(),
            kind,
            options: options.source(source).targets(targets),
        })
    }

    /// Reads it, on a thread that may block, and prepares it for an arm.
    async fn plan(self, model: &Model) -> Result<ReplayPlan, Failure> {
        let Self {
            recording,
            kind,
            options,
        } = self;
        let samples = tokio::task::spawn_blocking(move || recording.samples());
        let samples = samples.await.expect("it does not panic")?;
        let plan = ReplayPlan::new(kind, &samples, options, model);
        Ok(plan.map_err(ReplayFailure::Refused)?)
    }
}

enum Failure {
    Recording(RecordingError),
    Replay(ReplayFailure),
    /// An error of a session.
    Motion(Telling),
}

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Self {
        Self::Recording(error)
    }
}

impl From<ReplayFailure> for Failure {
    fn from(failure: ReplayFailure) -> Self {
        Self::Replay(failure)
    }
}

impl Raise for Failure {
    fn raise(self, py: Python<'_>) -> PyErr {
        let failure = match self {
            Self::Recording(error) => return error.raise(py),
            Self::Motion(error) => return error.raise(py),
            Self::Replay(failure) => failure,
        };
        let text = failure.to_string();
        let (kind, party) = match failure {
            ReplayFailure::Motion(error) => return Error::from(error).raise(py),
            ReplayFailure::Refused(ReplayError::Speed { .. }) => {
                return PyValueError::new_err(text);
            }
            ReplayFailure::Refused(error) => (error.python_name(), "caller"),
            failure => (failure.python_name(), "robot"),
        };
        made(py, "ReplayError", kind, party, &text)
    }
}

/// A [`ReplayReport`] for Python.
struct Report(ReplayReport);

impl<'py> IntoPyObject<'py> for Report {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let report = self.0;
        let spread = |spread: Spread| value(py, "Spread", (spread.median, spread.p95, spread.max));
        let (joints, position) = (spread(report.joints)?, spread(report.position)?);
        let fields = (
            report.duration.as_secs_f64(),
            joints,
            position,
            report.states,
        );
        value(py, "ReplayReport", fields)
    }
}

//! Errors of the driver as exceptions. Their classes are in `errors.py`.

use franka_async::Error;
use franka_async::MotionError;
use franka_async::connection::Version;
use franka_async::diagnosis::{Diagnose, Diagnosis};
use franka_async::error::{
    ActionError, ActionFailure, ActiveError, CommandError, ConnectError, ControlError,
    GripperError, IdentifyError, ReadError, Status, TareError, VacuumGripperError,
};
use franka_async::model::RobotKind;
use pyo3::prelude::*;

use crate::log::ControlLog;
use crate::names::Named;
use crate::state::names;

/// Conversion to an exception, for code that holds the interpreter.
pub(crate) trait Raise: Send + 'static {
    /// Returns the exception.
    fn raise(self, py: Python<'_>) -> PyErr;
}

impl Raise for PyErr {
    fn raise(self, _: Python<'_>) -> PyErr {
        self
    }
}

macro_rules! raise {
    ($($error:ty),*) => {$(
        impl Raise for $error {
            fn raise(self, py: Python<'_>) -> PyErr {
                Error::from(self).raise(py)
            }
        }
    )*};
}

raise!(
    MotionError,
    CommandError,
    ConnectError,
    ReadError,
    ActiveError,
    IdentifyError,
    TareError,
    GripperError,
    VacuumGripperError
);

impl Raise for Error {
    fn raise(self, py: Python<'_>) -> PyErr {
        exception(py, &self).unwrap_or_else(|broken| broken)
    }
}

/// Returns a `FrankaError` of this `kind` caused by the program itself, raised before the driver is
/// called.
pub(crate) fn misuse(py: Python<'_>, kind: &str, message: &str) -> PyErr {
    made(py, "FrankaError", kind, "caller", message)
}

/// Returns an exception of the class `class` of `errors.py`; `party` can act on it.
pub(crate) fn made(py: Python<'_>, class: &str, kind: &str, party: &str, message: &str) -> PyErr {
    let made = || {
        let class = py.import("franka_async.errors")?.getattr(class)?;
        let exception = class.call1((message,))?;
        exception.setattr("kind", kind)?;
        exception.setattr("party", party)?;
        Ok(PyErr::from_value(exception))
    };
    made().unwrap_or_else(|broken| broken)
}

fn exception(py: Python<'_>, error: &Error) -> PyResult<PyErr> {
    let class = match error {
        Error::Connect(_) | Error::ConnectGripper(_) | Error::ConnectVacuumGripper(_) => {
            "ConnectError"
        }
        Error::Command(CommandError::LinkLost { .. } | CommandError::ConnectionClosed { .. }) => {
            "CommandConnectionLostError"
        }
        Error::Command(_) => "CommandError",
        Error::Control(_) => "ControlError",
        Error::Motion(error) => motion_class(error),
        Error::Active(_) => "ActiveError",
        Error::Identify(_) => "IdentifyError",
        Error::Read(ReadError::LinkLost { .. } | ReadError::ConnectionClosed { .. }) => {
            "ReadConnectionLostError"
        }
        Error::Read(_) => "ReadError",
        Error::Tare(_) => "TareError",
        Error::Gripper(ActionError::ConnectionClosed { .. })
        | Error::VacuumGripper(ActionError::ConnectionClosed { .. }) => "ActionConnectionLostError",
        Error::Gripper(_) | Error::VacuumGripper(_) => "ActionError",
        _ => "FrankaError",
    };
    let class = py.import("franka_async.errors")?.getattr(class)?;
    let exception = class.call1((error.to_string(),))?;
    exception.setattr("kind", kind(error))?;
    exception.setattr("party", error.party().python_name())?;
    exception.setattr("entry", error.entry())?;
    // Shown in a traceback below the text, from Python 3.11 on.
    if exception.hasattr("add_note")? {
        let note = format!("In the book: errors.md#{}", error.entry());
        exception.call_method1("add_note", (note,))?;
    }
    match error {
        Error::Motion(motion) => {
            exception.setattr("is_ready_for_more", motion.is_ready_for_more())?;
            if let MotionError::GivenUp { code } = motion {
                exception.setattr("code", code)?;
            }
        }
        Error::Control(control) => {
            exception.setattr("is_ready_for_more", !control.is_reflex())?;
            set_control(&exception, control)?;
        }
        Error::Active(ActiveError::Ended(error)) => {
            exception.setattr("is_ready_for_more", error.is_ready_for_more())?;
        }
        Error::Active(_) => exception.setattr("is_ready_for_more", true)?,
        _ => {}
    }
    Ok(PyErr::from_value(exception))
}

/// Returns the subclass of `MotionError`, for errors that programs distinguish.
fn motion_class(error: &MotionError) -> &'static str {
    match error {
        MotionError::Goal(_) | MotionError::Path(_) => "GoalError",
        MotionError::Superseded => "SupersededError",
        MotionError::Stopped => "StoppedError",
        MotionError::Held(_) | MotionError::Braked(_) => "GuardError",
        MotionError::Busy => "BusyError",
        MotionError::NotReady { .. } => "NotReadyError",
        MotionError::TargetNotReached(_) => "TargetNotReachedError",
        MotionError::LinkLost { .. } | MotionError::ConnectionClosed { .. } => {
            "MotionConnectionLostError"
        }
        MotionError::AfterReaction { error, .. } => motion_class(error),
        _ => "MotionError",
    }
}

fn set_control(exception: &Bound<'_, PyAny>, control: &ControlError) -> PyResult<()> {
    exception.setattr("errors", names(control.failure.reflex_reason))?;
    exception.setattr("move_status", status(control))?;
    let version = match control.model.kind() {
        RobotKind::Fer => Version::V5,
        _ => Version::V10,
    };
    exception.setattr("log", ControlLog::new(control.clone(), version))?;
    let diagnosis = control.diagnose();
    let text = diagnosis.as_ref().map(ToString::to_string);
    exception.setattr("diagnosis", text)?;
    let fields = diagnosis.map(|diagnosis| findings(exception.py(), &diagnosis));
    exception.setattr("findings", fields.transpose()?)
}

/// Returns a diagnosis as data.
pub(crate) fn findings<'py>(py: Python<'py>, diagnosis: &Diagnosis) -> PyResult<Bound<'py, PyAny>> {
    let json = serde_json::to_string(diagnosis).expect("numbers and names become JSON");
    py.import("json")?.call_method1("loads", (json,))
}

/// Returns the name of the error.
fn kind(error: &Error) -> &'static str {
    match error {
        Error::Connect(error) => error.python_name(),
        Error::Command(error) => error.python_name(),
        Error::Control(error) => status(error),
        Error::Motion(error) => error.python_name(),
        Error::Active(error) => error.python_name(),
        Error::Identify(error) => error.python_name(),
        Error::Read(error) => error.python_name(),
        Error::Tare(TareError::Refused(error)) => error.python_name(),
        Error::ConnectGripper(error) => error.python_name(),
        Error::Gripper(ActionError::Failure(ActionFailure::Aborted { .. }))
        | Error::VacuumGripper(ActionError::Failure(ActionFailure::Aborted { .. })) => "aborted",
        Error::Gripper(error) => error.python_name(),
        Error::ConnectVacuumGripper(error) => error.python_name(),
        Error::VacuumGripper(error) => error.python_name(),
        _ => "other",
    }
}

/// Returns the name of the robot's answer to a motion: `reflex_aborted`.
fn status(control: &ControlError) -> &'static str {
    match control.refusal().status() {
        Status::Move(status) => status.python_name(),
        _ => "other",
    }
}

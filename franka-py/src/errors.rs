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
use crate::state::names;

/// Becomes an exception, where the interpreter is at hand.
pub(crate) trait Raise: Send + 'static {
    /// The exception.
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

/// A `FrankaError` of this `kind` by the program itself, which this package raises before the
/// driver is asked.
pub(crate) fn misuse(py: Python<'_>, kind: &str, message: &str) -> PyErr {
    made(py, "FrankaError", kind, "caller", message)
}

/// An exception of the class of `errors.py` that is called `class`, for `party` to act on.
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
        Error::Command(_) => "CommandError",
        Error::Control(_) => "ControlError",
        Error::Motion(_) => "MotionError",
        Error::Active(_) => "ActiveError",
        Error::Identify(_) => "IdentifyError",
        Error::Read(_) => "ReadError",
        Error::Tare(_) => "TareError",
        Error::Gripper(_) | Error::VacuumGripper(_) => "ActionError",
        _ => "FrankaError",
    };
    let class = py.import("franka_async.errors")?.getattr(class)?;
    let exception = class.call1((error.to_string(),))?;
    exception.setattr("kind", kind(error))?;
    exception.setattr("party", variant(&error.party()))?;
    exception.setattr("entry", error.entry())?;
    // What a traceback shows below the text, from Python 3.11 on.
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

fn set_control(exception: &Bound<'_, PyAny>, control: &ControlError) -> PyResult<()> {
    exception.setattr("errors", names(control.failure.reflex_reason))?;
    exception.setattr("move_status", status(control.refusal().status()))?;
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

/// A diagnosis as data.
pub(crate) fn findings<'py>(py: Python<'py>, diagnosis: &Diagnosis) -> PyResult<Bound<'py, PyAny>> {
    let json = serde_json::to_string(diagnosis).expect("numbers and names become JSON");
    py.import("json")?.call_method1("loads", (json,))
}

/// The name of what happened.
fn kind(error: &Error) -> String {
    match error {
        Error::Connect(error) => variant(error),
        Error::Command(error) => variant(error),
        Error::Control(error) => status(error.refusal().status()),
        Error::Motion(error) => variant(error),
        Error::Active(error) => variant(error),
        Error::Identify(error) => variant(error),
        Error::Read(error) => variant(error),
        Error::Tare(TareError::Refused(error)) => variant(error),
        Error::ConnectGripper(error) => variant(error),
        Error::Gripper(ActionError::Failure(ActionFailure::Aborted { .. }))
        | Error::VacuumGripper(ActionError::Failure(ActionFailure::Aborted { .. })) => {
            "aborted".to_owned()
        }
        Error::Gripper(error) => variant(error),
        Error::ConnectVacuumGripper(error) => variant(error),
        Error::VacuumGripper(error) => variant(error),
        _ => variant(error),
    }
}

/// The name of the robot's answer, without that of the command: `reflex_aborted`.
fn status(status: Status) -> String {
    let text = format!("{status:?}");
    let name = text.rsplit('(').next().unwrap_or_default();
    snake_case(name.trim_end_matches(')'))
}

/// The name of an enum's variant, which a derived `Debug` begins with: `link_lost`.
pub(crate) fn variant(value: &impl std::fmt::Debug) -> String {
    let text = format!("{value:?}");
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    snake_case(text.split(|c| !is_name(c)).next().unwrap_or_default())
}

fn snake_case(name: &str) -> String {
    let mut snake = String::with_capacity(name.len() + 4);
    for (i, letter) in name.char_indices() {
        if letter.is_uppercase() && i > 0 {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
    }
    snake
}

//! Supervised robots: the policy, events and health.

use franka_async::connection::Builder;
use franka_async::error::CloseReason;
use franka_async::state::RobotError;
use franka_async::supervision::{
    Backoff, Condition, Event, EventKind, Health, Notification, Policy, Reflex,
};
use franka_async::{Error, MotionError};
use futures::StreamExt;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict};

use crate::arrays::{array, columns};
use crate::errors::Raise;
use crate::exit;
use crate::names::Named;
use crate::operation::{Operation, seconds};
use crate::robot::Robot;
use crate::state::names;
use crate::stream::stream;

/// `franka_async.supervision.Policy`.
#[derive(FromPyObject)]
struct PolicyFields {
    recover: Option<(u32, f64)>,
    only: Option<Vec<String>>,
    ask_first: bool,
    reconnect: Option<BackoffFields>,
    give_up_after: Option<f64>,
    silence: f64,
    motions_wait: Option<f64>,
    seed: Option<u64>,
}

/// `franka_async.supervision.Backoff`.
#[derive(FromPyObject)]
struct BackoffFields {
    first: f64,
    most: f64,
    jitter: f64,
}

/// Reads a `franka_async.supervision.Policy`.
///
/// # Errors
/// `TypeError` for another object, `ValueError` for invalid values.
pub(crate) fn policy(policy: &Bound<'_, PyAny>) -> PyResult<Policy> {
    let fields: PolicyFields = policy.extract()?;
    let mut policy = Policy::default().silence(seconds("silence", fields.silence)?);
    match (fields.recover, &fields.only) {
        (Some((times, window)), _) => {
            policy = policy.recover(times, seconds("the window of recover", window)?);
        }
        (None, Some(_)) => {
            let text = "got `only` (the errors to recover from) without `recover`, expected both: \
                 add recover=(times, seconds)";
            return Err(PyValueError::new_err(text));
        }
        (None, None) => {}
    }
    if let Some(only) = fields.only {
        let errors: PyResult<Vec<_>> = only.iter().map(|name| error_called("only", name)).collect();
        policy = policy.only(errors?);
    }
    if fields.ask_first {
        policy = policy.ask_first();
    }
    policy = match fields.reconnect {
        None => policy.without_reconnecting(),
        Some(BackoffFields {
            first,
            most,
            jitter,
        }) => {
            if !(0.0..=1.0).contains(&jitter) {
                let text = format!("jitter is {jitter}, expected a number from 0 to 1");
                return Err(PyValueError::new_err(text));
            }
            policy.reconnect(Backoff {
                first: seconds("first", first)?,
                most: seconds("most", most)?,
                jitter,
            })
        }
    };
    if let Some(time) = fields.give_up_after {
        policy = policy.give_up_after(seconds("give_up_after", time)?);
    }
    if let Some(most) = fields.motions_wait {
        policy = policy.motions_wait(seconds("motions_wait", most)?);
    }
    if let Some(seed) = fields.seed {
        policy = policy.seed(seed);
    }
    Ok(policy)
}

/// Returns the robot's error named by the argument `argument`.
///
/// # Errors
/// `ValueError` with all names.
pub(crate) fn error_called(argument: &str, name: &str) -> PyResult<RobotError> {
    let all = RobotError::ALL.into_iter();
    let found = all.clone().find(|error| error.to_string() == name);
    found.ok_or_else(|| {
        let known: Vec<String> = all.map(|error| error.to_string()).collect();
        let known = known.join(", ");
        PyValueError::new_err(format!(
            "{argument} names {name:?}, expected one of {known}"
        ))
    })
}

/// Raises `ValueError` for an invalid policy.
#[pyfunction]
pub(crate) fn _check_policy(policy: &Bound<'_, PyAny>) -> PyResult<()> {
    self::policy(policy).map(drop)
}

/// Supervises a robot by `policy`, or `True` for the default one; `ask` is called with the reflex
/// before each recovery.
///
/// # Errors
/// The errors of [`policy`]; `ValueError` for a function without a policy.
pub(crate) fn supervise_by(
    builder: Builder,
    policy: Option<&Bound<'_, PyAny>>,
    ask: Option<Py<PyAny>>,
) -> PyResult<Builder> {
    let flag = |policy: &Bound<'_, PyAny>| policy.cast::<PyBool>().ok().map(|flag| flag.is_true());
    let policy = match policy.map(|policy| (policy, flag(policy))) {
        None | Some((_, Some(false))) if ask.is_some() => {
            let text = "got ask_before_recovery without supervision, expected a Policy as well";
            return Err(PyValueError::new_err(text));
        }
        None | Some((_, Some(false))) => return Ok(builder),
        Some((_, Some(true))) => Policy::default(),
        Some((policy, None)) => self::policy(policy)?,
    };
    let builder = builder.supervise(policy);
    let Some(ask) = ask else {
        return Ok(builder);
    };
    Ok(builder.ask_before_recovery(move |reflex| {
        // Runs on a thread that may block. No answer if the interpreter exits.
        let agreed = exit::in_python(|py| {
            let answer = self::reflex(py, reflex)
                .and_then(|reflex| ask.bind(py).call1((reflex,)))
                .and_then(|answer| answer.is_truthy());
            answer.unwrap_or_else(|error| {
                error.write_unraisable(py, Some(ask.bind(py)));
                false
            })
        });
        agreed.unwrap_or(false)
    }))
}

#[pymethods]
impl Robot {
    /// Events of the robot from now on, for `async for`: connections lost and made, reflexes,
    /// recoveries, user stop, guiding, brakes, motions, loads; see `Event`. Also available for a
    /// robot without supervision. Ends when the connection has ended permanently.
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        stream(py, self.connected()?.events(), |py, notification| {
            Ok(event(py, notification)?.unbind())
        })
    }

    /// Current health of the robot: readiness for motions, the reason if it is not ready, and
    /// counts of reconnects and recoveries.
    fn health<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        health(py, self.connected()?.health().newest())
    }

    /// Health of the robot, now and as it changes, for `async for`. Ends like `events()`.
    fn health_changes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let changes = self.connected()?.health();
        let now = futures::stream::iter([changes.newest()]);
        stream(py, now.chain(changes), |py, newest| {
            Ok(health(py, newest)?.unbind())
        })
    }

    /// Approves or rejects the recovery from the reflex with this number, for a `Policy` that asks
    /// first. Returns `True` if the policy was waiting for the answer. The number is in the event
    /// and in `health().reflex`.
    #[pyo3(signature = (reflex, yes = true))]
    fn agree(&self, reflex: u64, yes: bool) -> PyResult<bool> {
        Ok(self.connected()?.agree(reflex, yes))
    }

    /// Waits until the connection has ended permanently, and returns the reason: a `CloseReason`.
    /// Cancelling has no effect on the robot.
    fn closed(&self) -> PyResult<Operation> {
        let robot = self.connected()?;
        Ok(Operation::infallible("Robot.closed", async move {
            Closed(robot.closed().await)
        }))
    }
}

/// A reason, converted to a `franka_async.supervision.CloseReason`.
struct Closed(CloseReason);

impl<'py> IntoPyObject<'py> for Closed {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Self(reason) = &self;
        let fields = (
            reason.python_name(),
            reason.to_string(),
            reason.party().python_name(),
        );
        class(py, "CloseReason")?.call1(fields)
    }
}

fn class<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("franka_async.supervision")?.getattr(name)
}

fn health(py: Python<'_>, health: Health) -> PyResult<Bound<'_, PyAny>> {
    let condition = match &health.condition {
        Condition::Unready(why) => why.python_name(),
        condition => condition.python_name(),
    };
    class(py, "Health")?.call1((
        condition,
        health.since.as_secs_f64(),
        health.reflex,
        health.attempts,
        health.reconnects,
        health.recoveries,
        health.last_reconnect.map(|time| time.as_secs_f64()),
        health.last_recovery.map(|time| time.as_secs_f64()),
    ))
}

fn reflex<'py>(py: Python<'py>, reflex: &Reflex) -> PyResult<Bound<'py, PyAny>> {
    let error = reflex.error.as_ref().map(|error| {
        let error = Error::Control(Box::new((**error).clone()));
        error.raise(py).into_value(py)
    });
    let differences = reflex.differences.map(|what| what.to_string());
    class(py, "Reflex")?.call1((reflex.number, names(reflex.errors), error, differences))
}

fn event(py: Python<'_>, notification: Notification) -> PyResult<Bound<'_, PyAny>> {
    let Notification { event, missed, .. } = notification;
    let Event {
        at,
        robot_time,
        kind,
        ..
    } = event;
    let fields = PyDict::new(py);
    let set_reason = |reason: CloseReason| fields.set_item("reason", Closed(reason));
    match &kind {
        EventKind::Connected { attempts, after } => {
            fields.set_item("attempts", attempts)?;
            fields.set_item("after", after.map(|after| after.as_secs_f64()))?;
        }
        EventKind::RealtimeRefused { refusals } => {
            let texts: Vec<String> = refusals.iter().map(ToString::to_string).collect();
            fields.set_item("refusals", texts)?;
        }
        EventKind::Unrecognised { differences } => {
            fields.set_item("differences", differences.to_string())?;
        }
        EventKind::NotConfigured { command, text } => {
            fields.set_item("command", command.to_string())?;
            fields.set_item("text", text)?;
        }
        EventKind::Lost { reason } | EventKind::Closed { reason } => set_reason(reason.clone())?,
        EventKind::Silent { silence } => fields.set_item("silence", silence.as_secs_f64())?,
        EventKind::Resumed { after } => fields.set_item("after", after.as_secs_f64())?,
        EventKind::Reflex(reflex) => fields.set_item("reflex", self::reflex(py, reflex)?)?,
        EventKind::NotRecovered { reflex, why } => {
            fields.set_item("number", reflex)?;
            fields.set_item("why", why.python_name())?;
        }
        EventKind::Recovered {
            reflex,
            after,
            by_supervisor,
        } => {
            fields.set_item("number", reflex)?;
            fields.set_item("after", after.as_secs_f64())?;
            fields.set_item("by_supervisor", by_supervisor)?;
        }
        EventKind::UserStop { pressed } => fields.set_item("pressed", pressed)?,
        EventKind::Guiding { active } => fields.set_item("active", active)?,
        EventKind::Brakes { closed } => fields.set_item("closed", closed)?,
        EventKind::StopLatch { latched } => fields.set_item("latched", latched)?,
        EventKind::MotionBegun { goal } => fields.set_item("goal", goal)?,
        EventKind::MotionEnded { goal, outcome } => {
            fields.set_item("goal", goal)?;
            let error: Option<&MotionError> = outcome.as_ref().as_ref().err();
            let error = error.map(|error| error.clone().raise(py).into_value(py));
            fields.set_item("error", error)?;
        }
        EventKind::LoadChanged { load } => {
            fields.set_item("mass", load.m_load)?;
            fields.set_item("center", array(py, &load.F_x_Cload))?;
            fields.set_item("inertia", columns::<3, 3>(py, &load.I_load))?;
        }
        // Kinds unknown to this package have no fields.
        _ => {}
    }
    let robot_time = robot_time.map(|time| time as f64 / 1000.0);
    class(py, "Event")?.call1((
        kind.python_name(),
        at.as_secs_f64(),
        robot_time,
        missed,
        fields,
        kind.to_string(),
    ))
}

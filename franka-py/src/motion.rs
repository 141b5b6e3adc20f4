//! Motions: awaitables with a handle, and their reports.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use franka_async::condition::Reacted;
use franka_async::motion::{MotionHandle as Handle, Outcome, Progress, Reference};
use franka_async::realtime::{CycleTimes, Phases, Quantiles};
use franka_async::team::MemberMotion;
use franka_async::{Arm, MotionError, MotionReport};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyAny, PyTuple};

use crate::arrays::{array, pose_array};
use crate::names::Named;
use crate::operation::Operation;
use crate::stats;
use crate::told::{Telling, Told};

/// A motion: it begins when it is awaited, and then arrives, with a `MotionReport`, or raises
/// `MotionError`. Cancelling it brakes the arm.
#[pyclass(frozen, extends = Operation, module = "franka_async")]
pub(crate) struct Motion {
    handle: Handle,
    pub(crate) member: Member,
}

impl Motion {
    /// Creates the awaitable of `motion`, named `name`.
    pub(crate) fn new(
        py: Python<'_>,
        name: &'static str,
        motion: franka_async::Motion,
    ) -> PyResult<Py<Self>> {
        let handle = motion.handle();
        let (operation, member) = Member::new(name, motion);
        let motion = Self { handle, member };
        Py::new(py, PyClassInitializer::from(operation).add_subclass(motion))
    }
}

/// Following targets: it begins when it is awaited, and ends at the last target, with a
/// `MotionReport`, or raises `MotionError`. Cancelling it brakes the arm.
#[pyclass(frozen, extends = Operation, module = "franka_async")]
pub(crate) struct Follow {
    /// `None` if Python provides the targets.
    pub(crate) member: Option<Member>,
}

impl Follow {
    pub(crate) fn new(
        py: Python<'_>,
        operation: Operation,
        member: Option<Member>,
    ) -> PyResult<Py<Self>> {
        let follow = Self { member };
        Py::new(py, PyClassInitializer::from(operation).add_subclass(follow))
    }
}

/// A possible part of a joint motion, until it begins.
pub(crate) struct Member {
    take: Box<dyn Fn() -> Option<MemberMotion> + Send + Sync>,
    /// Its session, until it begins.
    of: Arc<Mutex<Option<(Told, Arm)>>>,
}

impl Member {
    /// Returns the operation `name` that awaits `motion`, and the handle that can take the motion
    /// out of it.
    pub(crate) fn new<M>(name: &'static str, motion: M) -> (Operation, Self)
    where
        M: IntoFuture<Output = Outcome, IntoFuture: Send> + Into<MemberMotion> + Send + 'static,
    {
        let waiting = Arc::new(Mutex::new(Some(motion)));
        let taken = waiting.clone();
        let of = Arc::new(Mutex::new(None::<(Told, Arm)>));
        let session = of.clone();
        let operation = Operation::new(name, async move {
            let of = take(&session);
            let outcome = match take(&taken) {
                Some(motion) => motion.await,
                // An operation whose motion was taken never begins.
                None => Err(MotionError::Stopped),
            };
            if let Some((told, _)) = &of {
                told.saw(&outcome);
            }
            outcome.map(Report).map_err(|error| Telling { error, of })
        });
        let member = Self {
            take: Box::new(move || take(&waiting).map(Into::into)),
            of,
        };
        (operation, member)
    }

    /// Sets its session.
    pub(crate) fn is_of(&self, session: (Told, Arm)) {
        *self.of.lock().unwrap_or_else(PoisonError::into_inner) = Some(session);
    }

    fn is_of_session(&self, told: &Told) -> bool {
        let of = self.of.lock().unwrap_or_else(PoisonError::into_inner);
        of.as_ref().is_some_and(|(own, _)| own.is(told))
    }

    /// Takes the driver's motions out of a `Motion` or `Follow` of each of `arms`, for a joint
    /// motion.
    ///
    /// # Errors
    /// `ValueError` for a motion of another arm, for a motion that has begun, and for targets that
    /// Python provides.
    pub(crate) fn take_all<'a>(
        motions: &[Bound<'_, PyAny>],
        arms: impl Iterator<Item = &'a Told>,
    ) -> PyResult<Vec<MemberMotion>> {
        for (number, (motion, told)) in motions.iter().zip(arms).enumerate() {
            let Some(member) = Self::of(motion)? else {
                let text = format!("motion {number} follows an iterator, expected a Latest");
                return Err(PyValueError::new_err(text));
            };
            if !member.is_of_session(told) {
                let text = format!(
                    "motion {number} belongs to another arm, expected a motion of \
                    arms[{number}] of this team"
                );
                return Err(PyValueError::new_err(text));
            }
        }
        let taken = motions.iter().map(|motion| {
            let taken = Self::of(motion)?.and_then(|member| {
                take(&member.of);
                (member.take)()
            });
            let begun =
                "got a motion that has already begun, expected a motion that was not awaited";
            let taken = taken.ok_or_else(|| PyValueError::new_err(begun))?;
            // It is awaited as a part of the joint motion.
            motion.call_method0("close")?;
            Ok(taken)
        });
        taken.collect()
    }

    fn of<'a>(motion: &'a Bound<'_, PyAny>) -> PyResult<Option<&'a Self>> {
        match motion.cast::<Follow>() {
            Ok(follow) => Ok(follow.get().member.as_ref()),
            Err(_) => Ok(Some(&motion.cast::<Motion>()?.get().member)),
        }
    }
}

fn take<T>(waiting: &Mutex<Option<T>>) -> Option<T> {
    waiting
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .take()
}

#[pymethods]
impl Motion {
    /// Handle for the progress of the motion, and to pause or brake it from elsewhere.
    fn handle(&self) -> MotionHandle {
        MotionHandle(self.handle.clone())
    }

    /// Progress of the motion: a `Progress`; `None` before it has begun and after its end.
    fn progress<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        progress(py, &self.handle)
    }

    /// Pauses the motion on its path, until `resume()`; the arm is held there. Without effect
    /// before it has begun and after its end.
    fn pause(&self) {
        self.handle.pause();
    }

    /// Resumes the motion.
    fn resume(&self) {
        self.handle.resume();
    }

    /// Brakes and ends the motion, from any thread; awaiting it raises `MotionError` of the kind
    /// `stopped`. A motion that has not begun never begins.
    fn cancel(&self) {
        self.handle.cancel();
    }
}

/// A handle of a motion: progress, pausing and braking. It does not keep the motion alive.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct MotionHandle(Handle);

#[pymethods]
impl MotionHandle {
    /// Like `Motion.progress`.
    fn progress<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        progress(py, &self.0)
    }

    /// Like `Motion.pause`.
    fn pause(&self) {
        self.0.pause();
    }

    /// Like `Motion.resume`.
    fn resume(&self) {
        self.0.resume();
    }

    /// Like `Motion.cancel`.
    fn cancel(&self) {
        self.0.cancel();
    }

    fn __repr__(&self) -> String {
        match self.0.progress() {
            Some(progress) => {
                let remaining = progress.remaining.as_secs_f64();
                format!("<MotionHandle under way, {remaining:.2} s remain>")
            }
            None => "<MotionHandle of a motion that is not under way>".into(),
        }
    }
}

fn class<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("franka_async.motion")?.getattr(name)
}

fn progress<'py>(py: Python<'py>, handle: &Handle) -> PyResult<Option<Bound<'py, PyAny>>> {
    let Some(Progress {
        elapsed, remaining, ..
    }) = handle.progress()
    else {
        return Ok(None);
    };
    let times = (elapsed.as_secs_f64(), remaining.as_secs_f64());
    Ok(Some(class(py, "Progress")?.call1(times)?))
}

/// Returns a `franka_async.motion.Reference`.
pub(crate) fn reference<'py>(
    py: Python<'py>,
    reference: &Reference,
) -> PyResult<Bound<'py, PyAny>> {
    let guards = reference.guards.iter().map(|guard| guard.python_name());
    let guards: Vec<_> = guards.collect();
    class(py, "Reference")?.call1((
        reference.time,
        array(py, &reference.q),
        array(py, &reference.dq),
        array(py, &reference.ddq),
        pose_array(py, &reference.pose),
        PyTuple::new(py, guards)?,
    ))
}

/// A report, converted to a `franka_async.motion.MotionReport`.
pub(crate) struct Report(pub(crate) MotionReport);

impl<'py> IntoPyObject<'py> for Report {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Self(report) = self;
        let error = |error: franka_async::error::PoseError| {
            class(py, "PoseError")?.call1((error.translation, error.rotation))
        };
        let quantiles = |times: Quantiles| {
            let times = [times.p50, times.p99, times.max].map(|time| time.as_secs_f64());
            class(py, "Quantiles")?.call1((times[0], times[1], times[2]))
        };
        let fields = (
            report.duration.as_secs_f64(),
            report.final_error.map(error).transpose()?,
            report.released_error.map(error).transpose()?,
            report.line_deviation,
            report.compensation.map(|torques| array(py, &torques)),
            report.reacted.map(|seen| reacted(py, &seen)).transpose()?,
            report.lost_states,
            report.skipped_states,
            report.success_rate_min,
            report.success_rate_avg,
            report.worst_turnaround.as_secs_f64(),
            report.slack_min.map(|slack| slack.as_nanos() as f64 * 1e-9),
        );
        let timing = (
            report.overruns,
            report
                .worst_cycle
                .map(|times| cycle(py, &times))
                .transpose()?,
            report.interval.map(quantiles).transpose()?,
            report.turnaround.map(quantiles).transpose()?,
        );
        // Tuples are converted up to twelve long.
        let fields = fields.into_pyobject(py)?.add(timing.into_pyobject(py)?)?;
        class(py, "MotionReport")?.call1(fields.cast_into::<PyTuple>()?)
    }
}

fn reacted<'py>(py: Python<'py>, seen: &Reacted) -> PyResult<Bound<'py, PyAny>> {
    class(py, "Reacted")?.call1((
        seen.after.as_secs_f64(),
        seen.time,
        array(py, &seen.wrench),
        pose_array(py, &seen.pose),
    ))
}

fn cycle<'py>(py: Python<'py>, times: &CycleTimes) -> PyResult<Bound<'py, PyAny>> {
    let seconds = |time: Duration| time.as_secs_f64();
    let phases = |times: Phases| {
        let fields = stats::phases(py, &times)?;
        class(py, "Phases")?.call((), Some(&fields))
    };
    class(py, "CycleTimes")?.call1((
        times.time,
        seconds(times.late),
        seconds(times.turnaround),
        times.slack.as_nanos() as f64 * 1e-9,
        times.phases.map(phases).transpose()?,
    ))
}

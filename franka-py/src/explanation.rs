//! Explanation of a recording or of the log of an error, with the reason for the end of a motion.

use franka_async::explain::Explanation as Explained;
use franka_async::recording::HostTime;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::array;
use crate::errors::findings;
use crate::log::ControlLog;
use crate::names::Named;
use crate::recording::{NO_KIND, RecordingFile};
use crate::state::names;

/// Explains why a motion ended, from a `RecordingFile` or a part of one, from a `ControlError`, or
/// from its log. It explains the last motion that the robot stopped, a guard aborted or a lost link
/// ended; without such an end, it covers the time up to the newest cycle. Raises `TypeError`, and
/// `ValueError` for a recording that does not name its kind of robot.
#[pyfunction]
pub(crate) fn explain(py: Python<'_>, of: &Bound<'_, PyAny>) -> PyResult<Explanation> {
    if let Ok(recording) = of.cast::<RecordingFile>() {
        let recording = recording.get();
        let explained = recording.view(py, |view| {
            let model = view.model()?;
            Some(Explained::of_recording(view, &model))
        });
        let Some(explained) = explained? else {
            return Err(PyValueError::new_err(NO_KIND));
        };
        return Ok(Explanation(Box::new(explained)));
    }
    let log = match of.getattr_opt("log")? {
        Some(log) => log,
        None => of.clone(),
    };
    let Ok(log) = log.cast::<ControlLog>() else {
        let got = of.get_type().name()?;
        let expected = "a RecordingFile, a ControlError or a ControlLog";
        let text = format!("got {got}, expected {expected}");
        return Err(PyTypeError::new_err(text));
    };
    let Some(error) = log.get().error() else {
        let text = "this log was pickled: explain it in the process that raised the error; here it has \
                    only its diagnosis and its findings";
        return Err(PyValueError::new_err(text));
    };
    let explained = py.detach(|| Explained::of_error(error));
    Ok(Explanation(Box::new(explained)))
}

/// The explanation of a series of cycles and of the end of a motion, returned by `explain`. `print`
/// shows a report of one page, a notebook also the figure. Times are the robot's clock, ms.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Explanation(Box<Explained>);

#[pymethods]
impl Explanation {
    /// The robot, `fr3` or `fer`.
    #[getter]
    fn robot(&self) -> &'static str {
        self.0.robot.python_name()
    }

    /// Reason why the limits are the constants for systems before 5.9; `None` if they are the
    /// robot's own.
    #[getter]
    fn fallback(&self) -> Option<String> {
        self.0.fallback.as_ref().map(ToString::to_string)
    }

    /// Number of cycles.
    #[getter]
    fn cycles(&self) -> u64 {
        self.0.cycles
    }

    /// The first cycle.
    #[getter]
    fn first_ms(&self) -> u64 {
        self.0.first
    }

    /// The last cycle.
    #[getter]
    fn last_ms(&self) -> u64 {
        self.0.last
    }

    /// The cycle that shows the end of the last motion that the robot stopped, a guard aborted or a
    /// lost link ended. For a guard, it is the cycle in which the arm was at rest. Without such an
    /// end, it is the last cycle.
    #[getter]
    fn end_ms(&self) -> u64 {
        self.0.end
    }

    /// Time at which this host received that cycle, ns since 1970:
    /// `recording.between(end=end_host_time - 1)` contains the part before it. `None` if unknown.
    #[getter]
    fn end_host_time(&self) -> Option<u64> {
        self.0.received.map(HostTime::as_nanos)
    }

    /// Number of earlier ends of this kind.
    #[getter]
    fn earlier(&self) -> u64 {
        self.0.earlier
    }

    /// The newest goal whose end was not recorded, if no end of a motion was found.
    #[getter]
    fn under_way(&self) -> Option<u64> {
        self.0.under_way
    }

    /// Text of the last goal if it failed on its own, for example after a user stop or at an
    /// obstacle; `None` if it did not fail.
    #[getter]
    fn failed(&self) -> Option<&str> {
        self.0.failed.as_deref()
    }

    /// Reason for the end of that motion, as text: the exceeded limit, its causes, and the
    /// recommended changes; `None` without such an end.
    #[getter]
    fn cause(&self) -> Option<&str> {
        self.0.cause.as_ref().map(|cause| &*cause.text)
    }

    /// The errors named by the robot; empty if a guard or a lost link ended the motion.
    #[getter]
    fn errors(&self) -> Vec<String> {
        let cause = self.0.cause.as_ref();
        cause.map_or_else(Vec::new, |cause| names(cause.errors))
    }

    /// The diagnosis as data, as in `ControlError`; `None` if unknown.
    #[getter]
    fn findings<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let diagnosis = self.0.cause.as_ref();
        let diagnosis = diagnosis.and_then(|cause| cause.diagnosis.as_ref());
        diagnosis
            .map(|diagnosis| findings(py, diagnosis))
            .transpose()
    }

    /// The changes, oldest first: a list of `explanation.Moment`.
    #[getter]
    fn timeline<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let class = class(py, "Moment")?;
        let moments = self.0.timeline.iter();
        moments
            .map(|moment| class.call1((moment.time, moment.kind.python_name(), &*moment.text)))
            .collect()
    }

    /// The smallest distance from each limit, an `explanation.Approach` by quantity: `position`,
    /// `velocity` and `torque` of joints, `translation` and `rotation` of the end effector.
    #[getter]
    fn margins<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let margins = &self.0.margins;
        let class = class(py, "Approach")?;
        let all = PyDict::new(py);
        for (name, approach) in [
            ("position", &margins.position),
            ("velocity", &margins.velocity),
            ("torque", &margins.torque),
            ("translation", &margins.translation),
            ("rotation", &margins.rotation),
        ] {
            if let Some(near) = approach {
                let fields = (near.joint, near.value, near.limit, near.margin, near.time);
                all.set_item(name, class.call1(fields)?)?;
            }
        }
        Ok(all)
    }

    /// The largest values, an `explanation.Peak` by quantity: `external_torque`, `force`,
    /// `following_error`.
    #[getter]
    fn peaks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let peaks = &self.0.peaks;
        let class = class(py, "Peak")?;
        let all = PyDict::new(py);
        for (name, peak) in [
            ("external_torque", &peaks.external_torque),
            ("force", &peaks.force),
            ("following_error", &peaks.following_error),
        ] {
            if let Some(peak) = peak {
                all.set_item(name, class.call1((peak.joint, peak.value, peak.time))?)?;
            }
        }
        Ok(all)
    }

    /// The contact at the end of the motion, an `explanation.Contact`; `None` if the torques do not
    /// determine it: `contact_unknown` contains the reason.
    #[getter]
    fn contact<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some((place, contact)) = self
            .0
            .contact
            .as_ref()
            .and_then(|place| place.contact.as_ref().map(|contact| (place, contact)))
        else {
            return Ok(None);
        };
        let next = contact.next.map(|(body, share)| (body.number(), share));
        let fields = (
            contact.body.number(),
            array(py, &contact.point),
            array(py, &contact.force),
            contact.spread,
            contact.probability,
            next,
            place.time,
        );
        class(py, "Contact")?.call1(fields).map(Some)
    }

    /// Reason why the contact is uncertain or unknown; `None` if it is known.
    #[getter]
    fn contact_unknown(&self) -> Option<&str> {
        self.0.contact.as_ref()?.unknown.as_deref()
    }

    /// Number of lost states.
    #[getter]
    fn lost(&self) -> u64 {
        self.0.lost.states
    }

    /// Number of commands that left after the next state was due.
    #[getter]
    fn late(&self) -> u64 {
        self.0.late.commands
    }

    /// The last second before the end as an SVG image: contact torques, velocities and torques
    /// relative to their limits, the events, and the place of the contact on the arm. It has no
    /// background, and its colours are distinguishable on white and on black.
    fn svg(&self, py: Python<'_>) -> String {
        py.detach(|| self.0.figure())
    }

    /// The content of a notebook cell: the figure and the report.
    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        let text = py
            .import("html")?
            .call_method1("escape", (self.__str__(),))?
            .extract::<String>()?;
        Ok(format!("{}<pre>{text}</pre>", self.svg(py)))
    }

    fn __str__(&self) -> String {
        self.0.to_string()
    }

    fn __repr__(&self) -> String {
        let stopped = match self.errors() {
            errors if !errors.is_empty() => format!("stopped by {}", errors.join(", ")),
            _ if self.0.cause.is_some() => "ended by a guard or a lost link".to_owned(),
            _ => "not stopped".to_owned(),
        };
        format!(
            "<Explanation of {} cycles of an {}, {stopped}>",
            self.0.cycles,
            self.robot()
        )
    }
}

/// Returns a class of `explanation.py`.
fn class<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("franka_async.explanation")?.getattr(name)
}

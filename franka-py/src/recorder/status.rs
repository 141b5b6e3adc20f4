//! The status of a recorder, and its errors.

use franka_async::record::AttachError;
use franka_async::recording::{RecordError, RecordStatus, TrackError};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::errors::{Raise, made};
use crate::names::Named;

/// A [`RecordStatus`] for Python.
pub(super) struct Status(pub(super) RecordStatus);

impl<'py> IntoPyObject<'py> for Status {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let RecordStatus {
            cycles,
            dropped,
            events_dropped,
            bytes,
            waiting,
            files,
            black_boxes,
            error,
            black_box_error,
            ..
        } = self.0;
        let raised = |error: Option<RecordError>| error.map(|error| error.raise(py).into_value(py));
        let class = py
            .import("franka_async.recording")?
            .getattr("RecordStatus")?;
        class.call1((
            cycles,
            dropped,
            events_dropped,
            bytes,
            waiting,
            files,
            black_boxes,
            raised(error),
            raised(black_box_error),
        ))
    }
}

impl Raise for RecordError {
    fn raise(self, py: Python<'_>) -> PyErr {
        let party = match &self {
            Self::Option { .. } => return PyValueError::new_err(self.to_string()),
            Self::Exists { .. } | Self::SameName { .. } | Self::Ended => "caller",
            _ => "host",
        };
        let text = self.to_string();
        made(py, "RecordError", self.python_name(), party, &text)
    }
}

impl Raise for TrackError {
    fn raise(self, py: Python<'_>) -> PyErr {
        let text = self.to_string();
        match self {
            Self::Record(error) => error.raise(py),
            Self::Cycles(AttachError::Capacity { .. }) => PyValueError::new_err(text),
            Self::Cycles(error) => made(py, "RecordError", error.python_name(), "caller", &text),
            other => made(py, "RecordError", other.python_name(), "caller", &text),
        }
    }
}

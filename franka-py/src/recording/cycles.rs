//! Cycles of a recording: individually, and columns of them as arrays.

use std::sync::{Mutex, PoisonError};

use franka_async::connection::Version;
use franka_async::export::Columns;
use franka_async::record::Column;
use franka_async::recording::{Cycle, RecordingError};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::EachCycle;
use crate::errors::Raise;
use crate::record::column_array;
use crate::state::RobotState;

/// The columns of recordings in files: a `dict` of each column's name to its unit and shape in one
/// cycle.
#[pyfunction]
pub(crate) fn recording_columns(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let all = PyDict::new(py);
    all.set_item("time", ("s", PyTuple::empty(py)))?;
    all.set_item("host_time", ("ns", PyTuple::empty(py)))?;
    let is_recorded = |column: &&Column| Columns::named([column.name]).is_ok();
    for column in Column::all().iter().filter(is_recorded) {
        all.set_item(column.name, (column.unit, PyTuple::new(py, column.shape)?))?;
    }
    Ok(all)
}

/// Returns the columns with these names, except the times.
///
/// # Errors
/// `ValueError` for a column that recordings do not have.
pub(super) fn chosen(names: &[&str]) -> PyResult<Vec<&'static Column>> {
    let names = names.iter().filter(|name| !TIMES.contains(name));
    Columns::named(names.clone().copied())
        .map_err(|unknown| PyValueError::new_err(unknown.to_string()))?;
    Ok(names.filter_map(|name| Column::find(name)).collect())
}

/// Columns that every table has.
const TIMES: [&str; 2] = ["time", "host_time"];

/// Columns of cycles.
pub(super) struct Rows {
    times: Vec<f64>,
    host_times: Vec<i64>,
    columns: Vec<(&'static Column, Vec<f64>)>,
}

impl Rows {
    pub(super) fn read(
        cycles: EachCycle,
        columns: Vec<&'static Column>,
    ) -> Result<Self, RecordingError> {
        let columns = columns.into_iter().map(|column| (column, Vec::new()));
        let mut rows = Self {
            times: Vec::new(),
            host_times: Vec::new(),
            columns: columns.collect(),
        };
        for cycle in cycles {
            let cycle = cycle?;
            rows.times.push(cycle.state.message_id as f64 / 1000.0);
            rows.host_times.push(cycle.time.as_nanos() as i64);
            for (column, values) in &mut rows.columns {
                column.append(&cycle.state, &cycle.record, values);
            }
        }
        Ok(rows)
    }

    /// Returns the column with this name, which must be one of them.
    pub(super) fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        match name {
            "time" => Ok(PyArray1::from_slice(py, &self.times).into_any()),
            "host_time" => Ok(PyArray1::from_slice(py, &self.host_times).into_any()),
            _ => {
                let mut columns = self.columns.iter();
                let (column, values) = columns
                    .find(|(column, _)| column.name == name)
                    .expect("one of those that were read");
                column_array(py, column, values, self.times.len())
            }
        }
    }
}

/// The cycles of a recording, one after the other. After an error `next()` continues behind the
/// damage.
#[pyclass(frozen, module = "franka_async", name = "_Cycles")]
pub(crate) struct Cycles {
    cycles: Mutex<EachCycle>,
    version: Version,
}

impl Cycles {
    pub(super) fn new(cycles: EachCycle, version: Version) -> Self {
        Self {
            cycles: Mutex::new(cycles),
            version,
        }
    }
}

#[pymethods]
impl Cycles {
    fn __iter__(this: Py<Self>) -> Py<Self> {
        this
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<RecordedCycle>> {
        let next = py.detach(|| {
            let mut cycles = self.cycles.lock().unwrap_or_else(PoisonError::into_inner);
            cycles.next().transpose()
        });
        let cycle = next.map_err(|error| error.raise(py))?;
        Ok(cycle.map(|cycle| RecordedCycle {
            cycle: Box::new(cycle),
            version: self.version,
        }))
    }
}

/// One cycle of a recording.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct RecordedCycle {
    cycle: Box<Cycle>,
    version: Version,
}

#[pymethods]
impl RecordedCycle {
    /// Time at which this computer received the state, ns since 1970.
    #[getter]
    fn host_time(&self) -> u64 {
        self.cycle.time.as_nanos()
    }

    /// The robot's state. Fields that are not recorded are zero.
    #[getter]
    fn state(&self) -> RobotState {
        RobotState::new(self.cycle.state, self.version)
    }

    /// Returns the column with this name in this cycle: a number, an array, or a name. Raises
    /// `ValueError`.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let rows = Rows {
            times: vec![self.cycle.state.message_id as f64 / 1000.0],
            host_times: vec![self.cycle.time.as_nanos() as i64],
            columns: chosen(&[name])?
                .into_iter()
                .map(|column| {
                    let mut values = Vec::with_capacity(column.width());
                    column.append(&self.cycle.state, &self.cycle.record, &mut values);
                    (column, values)
                })
                .collect(),
        };
        rows.column(py, name)?.get_item(0)
    }

    fn __repr__(&self) -> String {
        format!("<RecordedCycle at {} ms>", self.cycle.state.message_id)
    }
}

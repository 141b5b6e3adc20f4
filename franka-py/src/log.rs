//! The last cycles of a motion.

use std::sync::Arc;

use franka_async::connection::Version;
use franka_async::error::ControlError;
use franka_async::record::{ControlLog as Log, LogEntry};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyCFunction, PyDict, PyList, PySlice, PyTuple};

use crate::arrays::{array, columns};
use crate::state::RobotState;

/// The last cycles of a motion, oldest first: the robot's states, and the commands before them.
///
/// Every field of `RobotState` is here as one array over the cycles: `log.q` is `(N, 7)`,
/// `log.O_T_EE` is `(N, 4, 4)`, `log.time` is `(N,)`. The command sent before each state is
/// `log.sent("tau_J_d")`.
#[pyclass(frozen, sequence, module = "franka_async")]
pub(crate) struct ControlLog {
    log: Arc<Log>,
    /// The error of the log; `None` after pickling.
    error: Option<Box<ControlError>>,
    version: Version,
}

impl ControlLog {
    pub(crate) fn new(error: ControlError, version: Version) -> Self {
        Self {
            log: error.log.clone(),
            error: Some(Box::new(error)),
            version,
        }
    }

    /// Returns the error of the log; `None` after pickling.
    pub(crate) fn error(&self) -> Option<&ControlError> {
        self.error.as_deref()
    }

    /// Returns a field of the states, as one array over the cycles.
    fn field<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        // A default state, for the shape if there are no cycles.
        let shape = RobotState::new(Default::default(), self.version);
        let field = |state: RobotState| Bound::new(py, state)?.getattr(name);
        let values: PyResult<Vec<_>> = self.states().into_iter().map(field).collect();
        let (values, shape) = (values?, field(shape)?);
        // Names of errors have any number.
        if shape.is_instance_of::<PyList>() {
            return values.into_bound_py_any(py);
        }
        let numpy = py.import("numpy")?;
        let none = numpy.call_method1("array", (vec![shape],))?;
        match values.is_empty() {
            true => none.get_item(PySlice::new(py, 0, 0, 1)),
            false => numpy.call_method1("array", (values,)),
        }
    }
}

/// Adds a property to `ControlLog` for each field of `RobotState`.
pub(crate) fn add_fields(py: Python<'_>) -> PyResult<()> {
    let (log, state) = (py.get_type::<ControlLog>(), py.get_type::<RobotState>());
    let property = py.import("builtins")?.getattr("property")?;
    for name in state.dir()? {
        let name: String = name.extract()?;
        let there = state.getattr(&name)?;
        // Skips methods and constants.
        if there.get_type().name()? != "getset_descriptor" || name.starts_with('_') {
            continue;
        }
        let doc = format!("A row for each cycle: {}", there.getattr("__doc__")?);
        let attribute = name.clone();
        let get = PyCFunction::new_closure(
            py,
            None,
            None,
            move |arguments: &Bound<'_, PyTuple>, _: Option<&Bound<'_, PyDict>>| {
                let log = arguments.get_item(0)?;
                let log = log.cast::<ControlLog>()?.get();
                log.field(arguments.py(), &name).map(Bound::unbind)
            },
        )?;
        let none = py.None();
        log.setattr(&attribute, property.call1((get, &none, &none, doc))?)?;
    }
    Ok(())
}

/// The entries, and the protocol's version.
type Written = (Vec<String>, u16);

#[pymethods]
impl ControlLog {
    /// The states, oldest first.
    fn states(&self) -> Vec<RobotState> {
        let entries = self.log.iter();
        entries
            .map(|entry| RobotState::new(entry.state, self.version))
            .collect()
    }

    /// Command sent before each state, `(N, ...)`; zeros before the first. `name` is `tau_J_d`,
    /// `q_c`, `dq_c`, `O_T_EE_c` or `O_dP_EE_c`.
    fn sent<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let commands = self.log.iter().map(|entry| &entry.command);
        let values: Vec<Bound<'py, PyAny>> = match name {
            "tau_J_d" => commands
                .map(|sent| array(py, &sent.tau_J_d).into_any())
                .collect(),
            "q_c" => commands
                .map(|sent| array(py, &sent.q_c).into_any())
                .collect(),
            "dq_c" => commands
                .map(|sent| array(py, &sent.dq_c).into_any())
                .collect(),
            "O_dP_EE_c" => commands
                .map(|sent| array(py, &sent.O_dP_EE_c).into_any())
                .collect(),
            "O_T_EE_c" => commands
                .map(|sent| columns::<4, 4>(py, &sent.O_T_EE_c).into_any())
                .collect(),
            _ => {
                let expected = "'tau_J_d', 'q_c', 'dq_c', 'O_T_EE_c' or 'O_dP_EE_c'";
                let text = format!("name is {name:?}, expected {expected}");
                return Err(PyValueError::new_err(text));
            }
        };
        py.import("numpy")?.call_method1("array", (values,))
    }

    /// Comma-separated values, one line for each cycle, with libfranka's column names.
    fn to_csv(&self) -> String {
        self.log.to_csv()
    }

    fn __len__(&self) -> usize {
        self.log.len()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Written)> {
        let entries = self.log.iter().map(serde_json::to_string);
        let entries: Result<Vec<String>, _> = entries.collect();
        let entries = entries.map_err(|error| PyValueError::new_err(error.to_string()))?;
        let native = py.import("franka_async._native")?;
        let make = native.getattr("_log_of_json")?;
        Ok((make, (entries, self.version.number())))
    }

    fn __repr__(&self) -> String {
        format!("<ControlLog of {} cycles>", self.log.len())
    }
}

/// The log written by `pickle`. An entry with numbers that JSON cannot represent is left out.
#[pyfunction]
pub(crate) fn _log_of_json(entries: Vec<String>, version: u16) -> PyResult<ControlLog> {
    let version = Version::from_number(version)
        .ok_or_else(|| PyValueError::new_err(format!("got protocol version {version}")))?;
    let entries = entries.iter();
    let entries = entries.filter_map(|entry| serde_json::from_str::<LogEntry>(entry).ok());
    Ok(ControlLog {
        log: Arc::new(entries.collect()),
        error: None,
        version,
    })
}

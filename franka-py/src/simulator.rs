//! A simulated robot in the process.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use franka_sim::Running;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::runtime;

/// A simulated robot on a free port of this host, from the call on until `stop()` or the end of the
/// `with` block.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Sim {
    /// `None` once it has been stopped.
    running: Mutex<Option<Running>>,
    address: String,
}

#[pymethods]
impl Sim {
    /// Starts a Franka Research 3 with an arm that sticks and flexes like real ones, in the ready
    /// pose. With `virtual_time` its next millisecond begins with the command, however long that
    /// takes up to half a second: for tests, and for programs that learn.
    #[staticmethod]
    #[pyo3(signature = (*, ideal = false, virtual_time = false, seed = 0))]
    fn fr3(py: Python<'_>, ideal: bool, virtual_time: bool, seed: u64) -> PyResult<Self> {
        Self::start(py, franka_sim::Sim::fr3(), ideal, virtual_time, seed)
    }

    /// Starts a Franka Emika Robot (Panda); otherwise like `fr3`.
    #[staticmethod]
    #[pyo3(signature = (*, ideal = false, virtual_time = false, seed = 0))]
    fn fer(py: Python<'_>, ideal: bool, virtual_time: bool, seed: u64) -> PyResult<Self> {
        Self::start(py, franka_sim::Sim::fer(), ideal, virtual_time, seed)
    }

    /// Where to connect to: `host:port`.
    #[getter]
    fn address(&self) -> &str {
        &self.address
    }

    /// Stops the simulation. Connections to it are lost. Without effect if it has stopped.
    fn stop(&self, py: Python<'_>) -> PyResult<()> {
        let running = self
            .running
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        match running {
            Some(running) => runtime::blocking(py, running.stop()),
            None => Ok(()),
        }
    }

    fn __enter__(this: Py<Self>) -> Py<Self> {
        this
    }

    #[pyo3(signature = (*_exception))]
    fn __exit__(&self, py: Python<'_>, _exception: &Bound<'_, PyAny>) -> PyResult<()> {
        self.stop(py)
    }

    fn __repr__(&self) -> String {
        format!("<Sim at {}>", self.address)
    }
}

impl Sim {
    fn start(
        py: Python<'_>,
        sim: franka_sim::Sim,
        ideal: bool,
        virtual_time: bool,
        seed: u64,
    ) -> PyResult<Self> {
        let sim = if ideal { sim.ideal() } else { sim };
        let sim = if virtual_time {
            sim.virtual_time(PATIENCE)
        } else {
            sim
        };
        let sim = sim.configure(|config| config.seed = seed);
        let running = runtime::blocking(py, sim.start())?.map_err(PyOSError::new_err)?;
        let address = running.addr().to_string();
        let running = Mutex::new(Some(running));
        Ok(Self { running, address })
    }
}

/// How long a simulated robot in virtual time waits for a command.
const PATIENCE: Duration = Duration::from_millis(500);

//! Streams of states.

use std::sync::Arc;

use franka_async::state::{Reading, RobotState as Numbers};
use futures::{StreamExt, future};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::arrays::array;
use crate::robot::Robot;
use crate::state::RobotState;
use crate::stream::stream;
use crate::tare::PyWrenchTare;

#[pymethods]
impl Robot {
    /// Newest state as it changes, for `async for` or `for`. If `rate` is given, at most `rate`
    /// states per second, by the robot's clock. If several states arrive while the program is busy,
    /// only the newest is returned. Ends with the connection.
    #[pyo3(signature = (rate = None))]
    fn states<'py>(&self, py: Python<'py>, rate: Option<f64>) -> PyResult<Bound<'py, PyAny>> {
        let robot = self.connected()?;
        let version = robot.version();
        let mut is_due = due(rate)?;
        let states = robot.states();
        let states = states.filter(move |state| future::ready(is_due(state)));
        stream(py, states, move |py, state| {
            Ok(Py::new(py, RobotState::new(state, version))?.into_any())
        })
    }

    /// The stream of `states()` with each state's wrench minus `tare`, as `TaredState`s.
    #[pyo3(signature = (tare, rate = None))]
    fn tared_states<'py>(
        &self,
        py: Python<'py>,
        tare: &PyWrenchTare,
        rate: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let robot = self.connected()?;
        let version = robot.version();
        let class = named(py, "TaredState")?;
        let mut is_due = due(rate)?;
        let states = robot.tared_states(&tare.0);
        let states = states.filter(move |tared| future::ready(is_due(&tared.state)));
        stream(py, states, move |py, tared| {
            let wrench = tared.wrench.map(|wrench| array(py, &wrench));
            let state = RobotState::new(tared.state, version);
            class.call1(py, (state, wrench, tared.turned))
        })
    }

    /// Every state from now on, each once and in order, for `async for` or `for`: pairs of the
    /// state and the number of states `missed` before it. No state is missed unless the program is
    /// more than about a second behind. Ends with the connection.
    fn state_stream<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let robot = self.connected()?;
        let version = robot.version();
        let class = named(py, "Reading")?;
        stream(py, robot.state_stream(), move |py, reading| {
            let Reading { state, missed, .. } = reading;
            class.call1(py, (RobotState::new(state, version), missed))
        })
    }
}

/// Returns a class of the items of streams.
fn named(py: Python<'_>, name: &str) -> PyResult<Arc<Py<PyAny>>> {
    let class = py.import("franka_async.streams")?.getattr(name)?;
    Ok(Arc::new(class.unbind()))
}

/// Returns a function that selects at most `rate` states per second, by the robot's clock.
fn due(rate: Option<f64>) -> PyResult<impl FnMut(&Numbers) -> bool + Send + 'static> {
    let period = match rate {
        None => 0.0,
        Some(rate) if rate.is_finite() && rate > 0.0 => 1000.0 / rate,
        Some(rate) => {
            let text = format!("rate is {rate}, expected a number above 0, in 1/s");
            return Err(PyValueError::new_err(text));
        }
    };
    let mut due = 0.0;
    Ok(move |state: &Numbers| {
        let now = state.message_id as f64;
        let is_due = now >= due;
        if is_due {
            // Late states do not reduce the interval of later ones.
            due = f64::max(due + period, now + period - 1.0);
        }
        is_due
    })
}

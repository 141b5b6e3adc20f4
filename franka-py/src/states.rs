//! Streams of states.

use franka_async::state::Reading;
use futures::{StreamExt, future};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::robot::Robot;
use crate::state::RobotState;
use crate::stream::stream;

#[pymethods]
impl Robot {
    /// Newest state as it changes, for `async for` or `for`. If `rate` is given, at most `rate`
    /// states per second, by the robot's clock. If several states arrive while the program is busy,
    /// only the newest is returned. Ends with the connection.
    #[pyo3(signature = (rate = None))]
    fn states<'py>(&self, py: Python<'py>, rate: Option<f64>) -> PyResult<Bound<'py, PyAny>> {
        let robot = self.connected()?;
        let version = robot.version();
        let period = match rate {
            None => 0.0,
            Some(rate) if rate.is_finite() && rate > 0.0 => 1000.0 / rate,
            Some(rate) => {
                let text = format!("rate is {rate}, expected a number above 0, in 1/s");
                return Err(PyValueError::new_err(text));
            }
        };
        let mut due = 0.0;
        let states = robot.states().filter(move |state| {
            let now = state.message_id as f64;
            let is_due = now >= due;
            if is_due {
                // Late states do not reduce the interval of later ones.
                due = f64::max(due + period, now + period - 1.0);
            }
            future::ready(is_due)
        });
        stream(py, states, move |py, state| {
            Ok(Py::new(py, RobotState::new(state, version))?.into_any())
        })
    }

    /// Every state from now on, each once and in order, for `async for` or `for`: pairs of the
    /// state and the number of states `missed` before it. No state is missed unless the program is
    /// more than about a second behind. Ends with the connection.
    fn state_stream<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let robot = self.connected()?;
        let version = robot.version();
        let class = py
            .import("franka_async.streams")?
            .getattr("Reading")?
            .unbind();
        let class = std::sync::Arc::new(class);
        stream(py, robot.state_stream(), move |py, reading| {
            let Reading { state, missed, .. } = reading;
            class.call1(py, (RobotState::new(state, version), missed))
        })
    }
}

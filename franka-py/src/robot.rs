//! The robot.

use franka_async::Realtime;
use numpy::PyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::pose_array;
use crate::operation::Operation;
use crate::state::RobotState;

/// A connected robot. Made by awaiting `Robot.connect(address)`.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Robot {
    robot: franka_async::Robot,
}

#[pymethods]
impl Robot {
    /// Connects to the robot at `address`, `host` or `host:port`. `realtime` is `enforce` (the
    /// default) or `ignore`: whether a host without real-time scheduling is refused.
    #[staticmethod]
    #[pyo3(signature = (address, *, realtime = None))]
    fn connect(address: &str, realtime: Option<&str>) -> PyResult<Operation> {
        let builder = franka_async::Robot::builder(address).realtime(self::realtime(realtime)?);
        Ok(Operation::new("Robot.connect", async move {
            let robot = builder.connect().await?;
            Ok::<_, franka_async::Error>(Self { robot })
        }))
    }

    /// The newest state, without waiting.
    fn state(&self) -> RobotState {
        RobotState::new(self.robot.state(), self.robot.version())
    }

    /// The measured pose of the end effector in the base frame, `(4, 4)`.
    fn pose<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        pose_array(py, &self.robot.pose())
    }

    /// Brakes whatever moves, and closes the connection.
    fn shutdown(&self) -> Operation {
        let robot = self.robot.clone();
        Operation::infallible("shutdown", async move { robot.shutdown().await })
    }
}

fn realtime(choice: Option<&str>) -> PyResult<Realtime> {
    match choice {
        None | Some("enforce") => Ok(Realtime::Enforce),
        Some("ignore") => Ok(Realtime::Ignore),
        Some(other) => {
            let text = format!("realtime is {other:?}, expected 'enforce' or 'ignore'");
            Err(PyValueError::new_err(text))
        }
    }
}

//! Asynchronous joint positions: the robot itself moves from target to target.

use std::sync::{Arc, Mutex, PoisonError};

use franka_async::control::{AsynchronousControl as Control, AsynchronousOptions, TargetStatus};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::arrays::vector;
use crate::errors::Raise;
use crate::names::Named;
use crate::operation::Operation;
use crate::robot::Robot;

/// A motion between sparse joint targets that the robot itself plans. Any thread may set targets.
/// The robot stops if you call `stop()` or drop this object.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct AsynchronousControl {
    /// `None` once it was stopped or finished.
    control: Mutex<Option<Arc<Control>>>,
}

#[pymethods]
impl Robot {
    /// Begins a motion in which the robot itself moves to sparse joint targets. Returns an
    /// `AsynchronousControl`. Protocol 10 (Franka Research 3) only, and experimental there.
    ///
    /// `maximum_joint_velocities` are `(7,)` rad/s. A target counts as reached within
    /// `goal_tolerance`, in rad as Euclidean norm. Raises `MotionError`: `unsupported` with another
    /// protocol, `busy` while another motion controls the arm. Cancelling stops the robot.
    #[pyo3(signature = (maximum_joint_velocities = None, goal_tolerance = None))]
    fn asynchronous_joint_positions(
        &self,
        maximum_joint_velocities: Option<&Bound<'_, PyAny>>,
        goal_tolerance: Option<f64>,
    ) -> PyResult<Operation> {
        let mut options = AsynchronousOptions::default();
        if let Some(velocities) = maximum_joint_velocities {
            options.maximum_joint_velocities = vector("maximum_joint_velocities", velocities)?;
        }
        options.goal_tolerance = goal_tolerance.unwrap_or(options.goal_tolerance);
        let robot = self.connected()?;
        Ok(Operation::new(
            "Robot.asynchronous_joint_positions",
            async move {
                let control = robot.asynchronous_joint_positions(options).await?;
                Ok::<_, franka_async::MotionError>(AsynchronousControl {
                    control: Mutex::new(Some(Arc::new(control))),
                })
            },
        ))
    }
}

#[pymethods]
impl AsynchronousControl {
    /// Moves the robot to `q`, `(7,)` rad, replacing the previous target. Raises the reason if the
    /// motion has ended.
    fn set_target(&self, py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<()> {
        let q = vector("q", q)?;
        let set = self.control()?.set_target(q);
        set.map_err(|error| error.raise(py))
    }

    /// Status of the newest target: `idle`, `executing`, `target_reached` or `aborted`; and the
    /// reason if it was aborted.
    fn status(&self) -> PyResult<(&'static str, Option<String>)> {
        let status = self.control()?.status();
        let reason = match status {
            TargetStatus::Aborted(reason) => Some(reason.to_string()),
            _ => None,
        };
        Ok((status.python_name(), reason))
    }

    /// Waits until the newest target is reached. Raises the reason if the motion ends earlier.
    /// Cancelling does not stop the robot.
    fn reached(&self) -> PyResult<Operation> {
        let control = self.control()?;
        Ok(Operation::new("AsynchronousControl.reached", async move {
            control.reached().await
        }))
    }

    /// Stops the robot. A second call has no effect.
    fn stop(&self, py: Python<'_>) {
        let control = self.take();
        py.detach(|| drop(control));
    }

    fn __enter__(this: Py<Self>) -> Py<Self> {
        this
    }

    #[pyo3(signature = (*_exception))]
    fn __exit__(&self, py: Python<'_>, _exception: &Bound<'_, PyAny>) {
        self.stop(py);
    }
}

impl AsynchronousControl {
    fn control(&self) -> PyResult<Arc<Control>> {
        let control = self.control.lock().unwrap_or_else(PoisonError::into_inner);
        let stopped = || PyRuntimeError::new_err("asynchronous control was stopped");
        control.clone().ok_or_else(stopped)
    }

    fn take(&self) -> Option<Arc<Control>> {
        let mut control = self.control.lock().unwrap_or_else(PoisonError::into_inner);
        control.take()
    }
}

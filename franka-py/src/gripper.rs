//! The Franka Hand.

use franka_async::connection::Endpoint;
use franka_async::gripper::{self, Grasp};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use crate::device::{Device, at_least_zero, device_methods, given};
use crate::operation::Operation;
use crate::robot::Robot;
use crate::stream::stream;

/// A Franka Hand, with its own connection in addition to the robot's.
///
/// `async with Gripper(address) as gripper:` connects, and disconnects at the end; `await
/// gripper.connect()` does so without a block. On threads without an event loop, use `.wait()` in
/// place of `await`. A grasped object stays grasped when the connection ends.
///
/// One action runs at a time. A newer action, or `stop()` from any task or thread, aborts it; it
/// then raises `ActionError` of the kind `aborted`. Cancelling the task that awaits an action, or a
/// timeout around it, stops the fingers. An action has no deadline: a move that an obstacle blocks
/// takes minutes. Waiting for an action releases the interpreter.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct Gripper(pub(crate) Device<gripper::Gripper>);

impl Gripper {
    pub(crate) fn new(endpoint: impl Into<Endpoint>) -> Self {
        Self(Device::new("Gripper", endpoint.into()))
    }
}

device_methods!(Gripper, gripper::Gripper, "Gripper.connect");

#[pymethods]
impl Robot {
    /// The Franka Hand of this robot, at its host and the port after the robot's, not yet
    /// connected: `async with robot.gripper() as gripper:`. If a simulator listens on a free port,
    /// its Hand has a different port, and another program could listen at this one. Then use
    /// `Gripper(sim.hand_address)` of a `Sim` with `hand=True`.
    fn gripper(&self) -> Gripper {
        Gripper::new(self.beside(1))
    }
}

#[pymethods]
impl Gripper {
    /// Describes a connection to the Hand at `address`, `host` or `host:port`; it sends nothing
    /// yet. The port is 1338 unless given.
    #[new]
    #[pyo3(signature = (address))]
    fn python_new(address: Option<&str>) -> PyResult<Self> {
        Ok(Self::new(given(address, "Hand", "hand")?))
    }

    /// Newest state, without waiting.
    fn state(&self) -> PyResult<GripperState> {
        Ok(GripperState(self.0.connected()?.state()))
    }

    /// Newest state as it changes, for `async for`. Ends with the connection.
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        stream(py, self.0.connected()?.states(), |py, state| {
            GripperState(state).into_py_any(py)
        })
    }

    /// Determines the largest opening of the fingers, `max_width` of the state; returns `True` on
    /// success. Needed once after power-on and after a change of fingers. Raises `ActionError`;
    /// cancelling stops the fingers.
    fn homing(&self) -> PyResult<Operation> {
        let gripper = self.0.connected()?;
        Ok(Operation::new("Gripper.homing", async move {
            gripper.homing().await
        }))
    }

    /// Moves the fingers to `width`, m, at `speed`, m/s (the Hand's largest speed is 0.1, and
    /// higher values are not refused); returns `True` if they arrived. Raises `ActionError`;
    /// cancelling stops the fingers.
    #[pyo3(signature = (width, speed = 0.1))]
    fn move_to(&self, width: f64, speed: f64) -> PyResult<Operation> {
        let width = at_least_zero("width", width)?;
        let speed = at_least_zero("speed", speed)?;
        let gripper = self.0.connected()?;
        Ok(Operation::new("Gripper.move_to", async move {
            gripper.move_to(width, speed).await
        }))
    }

    /// Closes the fingers on an object of this `width`, m, at `speed`, m/s, and holds it with
    /// `force`, N. Returns `True` if they ended at most `epsilon_inner` narrower and
    /// `epsilon_outer` wider, m. The force stays applied in both cases, until the next action or
    /// `stop()`. Raises `ActionError`; cancelling stops the fingers and releases the object.
    #[pyo3(signature = (
        width, speed = 0.1, force = 20.0, epsilon_inner = 0.005, epsilon_outer = 0.005,
    ))]
    fn grasp(
        &self,
        width: f64,
        speed: f64,
        force: f64,
        epsilon_inner: f64,
        epsilon_outer: f64,
    ) -> PyResult<Operation> {
        let grasp = Grasp {
            width: at_least_zero("width", width)?,
            epsilon_inner: at_least_zero("epsilon_inner", epsilon_inner)?,
            epsilon_outer: at_least_zero("epsilon_outer", epsilon_outer)?,
            speed: at_least_zero("speed", speed)?,
            force: at_least_zero("force", force)?,
        };
        let gripper = self.0.connected()?;
        Ok(Operation::new("Gripper.grasp", async move {
            gripper.grasp(grasp).await
        }))
    }

    /// Stops the fingers and releases the object; returns `True` on success. The running action
    /// raises `ActionError`. Once begun, the stop continues even if it is cancelled.
    fn stop(&self) -> PyResult<Operation> {
        let gripper = self.0.connected()?;
        Ok(Operation::new("Gripper.stop", async move {
            gripper.stop().await
        }))
    }
}

/// The state of a Franka Hand. It is immutable.
#[pyclass(frozen, eq, module = "franka_async")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct GripperState(pub(crate) gripper::State);

#[pymethods]
impl GripperState {
    /// Distance of the fingers, m.
    #[getter]
    fn width(&self) -> f64 {
        self.0.width
    }

    /// Largest distance of the fingers, m, from the last homing.
    #[getter]
    fn max_width(&self) -> f64 {
        self.0.max_width
    }

    /// True if the Hand holds an object of the requested width.
    #[getter]
    fn is_grasped(&self) -> bool {
        self.0.is_grasped
    }

    /// Temperature of the Hand, degrees Celsius.
    #[getter]
    fn temperature(&self) -> u16 {
        self.0.temperature
    }

    /// The Hand's clock, s.
    #[getter]
    fn time(&self) -> f64 {
        f64::from(self.0.message_id) / 1000.0
    }

    fn __repr__(&self) -> String {
        let state = &self.0;
        let grasped = if state.is_grasped { ", grasped" } else { "" };
        format!(
            "<GripperState {:.3} s, {:.4} of {:.4} m{grasped}, {} C>",
            self.time(),
            state.width,
            state.max_width,
            state.temperature
        )
    }
}

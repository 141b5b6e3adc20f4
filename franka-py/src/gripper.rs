//! The Franka Hand.

use franka_async::connection::Endpoint;
use franka_async::gripper::{self, Grasp};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use crate::device::{Device, at_least_zero, device_methods, given};
use crate::operation::Operation;
use crate::robot::Robot;
use crate::stream::stream;

/// A Franka Hand, which has a connection of its own beside the robot's.
///
/// `async with Gripper(address) as gripper:` connects, and disconnects at the end; `await
/// gripper.connect()` does so without a block. On threads without an event loop, `.wait()`
/// stands in the place of `await`. What is grasped stays grasped when the connection ends.
///
/// One action runs at a time. A newer one aborts it, which then raises `ActionError` of the kind
/// `aborted`, and so does `stop()`, from any task or thread. Cancelling the task that awaits an
/// action stops the fingers, and so does a timeout around it. An action has no deadline of its own:
/// a move that an obstacle blocks takes minutes. None holds the interpreter while it is awaited or
/// waited for.
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
    /// The Franka Hand of this robot, at its host and the port after the robot's; it is yet to be
    /// connected: `async with robot.gripper() as gripper:`. That of a simulator on a free port has
    /// another one, and nothing or something else listens at this: `Gripper(sim.hand_address)`, of
    /// a `Sim` with `hand=True`.
    fn gripper(&self) -> Gripper {
        Gripper::new(self.beside(1))
    }
}

#[pymethods]
impl Gripper {
    /// Describes a connection to the Hand at `address`, `host` or `host:port`; nothing is sent yet.
    /// The port is 1338 unless given.
    #[new]
    #[pyo3(signature = (address))]
    fn python_new(address: Option<&str>) -> PyResult<Self> {
        Ok(Self::new(given(address, "Hand", "hand")?))
    }

    /// The newest state, without waiting.
    fn state(&self) -> PyResult<GripperState> {
        Ok(GripperState(self.0.connected()?.state()))
    }

    /// The newest state as it changes, for `async for`. Ends when the connection does.
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        stream(py, self.0.connected()?.states(), |py, state| {
            GripperState(state).into_py_any(py)
        })
    }

    /// Finds how wide the fingers open, `max_width` of the state; returns whether that succeeded.
    /// Needed once after power-on and after a change of fingers. Raises `ActionError`; cancelling
    /// stops the fingers.
    fn homing(&self) -> PyResult<Operation> {
        let gripper = self.0.connected()?;
        Ok(Operation::new("Gripper.homing", async move {
            gripper.homing().await
        }))
    }

    /// Moves the fingers to `width`, m, at `speed`, m/s (the Hand's most is 0.1, and more is not
    /// refused); returns whether they arrived. Raises `ActionError`; cancelling stops the fingers.
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
    /// `force`, N. Returns whether they ended at most `epsilon_inner` narrower and `epsilon_outer`
    /// wider, m; the force stays applied either way, until the next action or `stop()`. Raises
    /// `ActionError`; cancelling stops the fingers and lets go.
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

    /// Stops the fingers and lets go of what they hold; returns whether that succeeded. The action
    /// that runs raises `ActionError`. Once it has begun, it goes on even if it is cancelled.
    fn stop(&self) -> PyResult<Operation> {
        let gripper = self.0.connected()?;
        Ok(Operation::new("Gripper.stop", async move {
            gripper.stop().await
        }))
    }
}

/// What a Franka Hand says of itself. It does not change.
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

    /// Distance of the open fingers, m, as the last homing found it.
    #[getter]
    fn max_width(&self) -> f64 {
        self.0.max_width
    }

    /// Whether the Hand holds an object of the width that was asked for.
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

//! The vacuum gripper.

use franka_async::connection::Endpoint;
use franka_async::vacuum::{self, DeviceStatus, Profile, Vacuum};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::device::{Device, device_methods, given};
use crate::names::Named;
use crate::operation::{Operation, seconds};
use crate::robot::Robot;
use crate::stream::stream;

/// A vacuum gripper, with its own connection in addition to the robot's. Connection, actions and
/// their ends work as for `Gripper`; cancelling an action stops the pump.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct VacuumGripper(pub(crate) Device<vacuum::VacuumGripper>);

impl VacuumGripper {
    pub(crate) fn new(endpoint: impl Into<Endpoint>) -> Self {
        Self(Device::new("VacuumGripper", endpoint.into()))
    }
}

device_methods!(
    VacuumGripper,
    vacuum::VacuumGripper,
    "VacuumGripper.connect"
);

#[pymethods]
impl Robot {
    /// The vacuum gripper of this robot, at its host and the second port after the robot's, not yet
    /// connected, like `gripper()`.
    fn vacuum_gripper(&self) -> VacuumGripper {
        VacuumGripper::new(self.beside(2))
    }
}

#[pymethods]
impl VacuumGripper {
    /// Describes a connection to the gripper at `address`, `host` or `host:port`; it sends nothing
    /// yet. The port is 1339 unless given.
    #[new]
    #[pyo3(signature = (address))]
    fn python_new(address: Option<&str>) -> PyResult<Self> {
        Ok(Self::new(given(
            address,
            "vacuum gripper",
            "vacuum_gripper",
        )?))
    }

    /// Newest state, without waiting.
    fn state(&self) -> PyResult<VacuumGripperState> {
        Ok(VacuumGripperState(self.0.connected()?.state()))
    }

    /// Newest state as it changes, for `async for`. Ends with the connection.
    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        stream(py, self.0.connected()?.states(), |py, state| {
            VacuumGripperState(state).into_py_any(py)
        })
    }

    /// Picks up an object and holds it; returns `True` if the vacuum was reached within `timeout`
    /// seconds, which are sent in whole milliseconds. `vacuum` is in units of 10 mbar, 0 to 255;
    /// `profile` is a production set-up profile of the device, 0 to 3. Raises `ActionError`;
    /// cancelling stops the pump.
    #[pyo3(signature = (vacuum, timeout, profile = 0))]
    fn vacuum(&self, vacuum: u8, timeout: f64, profile: u8) -> PyResult<Operation> {
        let profile = Profile::from_byte(profile)
            .map_err(|_| PyValueError::new_err(format!("profile is {profile}, expected 0 to 3")))?;
        let timeout = seconds("timeout", timeout)?.as_millis();
        let vacuum = Vacuum {
            vacuum,
            profile,
            timeout: i64::try_from(timeout).unwrap_or(i64::MAX),
        };
        let gripper = self.0.connected()?;
        Ok(Operation::new("VacuumGripper.vacuum", async move {
            gripper.vacuum(vacuum).await
        }))
    }

    /// Drops the object; returns `True` if this succeeded within `timeout` seconds. Raises
    /// `ActionError`; cancelling stops the pump.
    fn drop_off(&self, timeout: f64) -> PyResult<Operation> {
        let timeout = seconds("timeout", timeout)?;
        let gripper = self.0.connected()?;
        Ok(Operation::new("VacuumGripper.drop_off", async move {
            gripper.drop_off(timeout).await
        }))
    }

    /// Stops the current action, which raises `ActionError`; returns `True` on success. Once begun,
    /// the stop continues even if it is cancelled.
    fn stop(&self) -> PyResult<Operation> {
        let gripper = self.0.connected()?;
        Ok(Operation::new("VacuumGripper.stop", async move {
            gripper.stop().await
        }))
    }
}

/// The state of a vacuum gripper. It is immutable.
#[pyclass(frozen, eq, hash, module = "franka_async")]
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct VacuumGripperState(pub(crate) vacuum::State);

#[pymethods]
impl VacuumGripperState {
    /// True if the vacuum is within its range.
    #[getter]
    fn in_control_range(&self) -> bool {
        self.0.in_control_range
    }

    /// True if the object has been dropped off.
    #[getter]
    fn part_detached(&self) -> bool {
        self.0.part_detached
    }

    /// True if the gripper holds an object.
    #[getter]
    fn part_present(&self) -> bool {
        self.0.part_present
    }

    /// The status light: `green`, `yellow` (warnings), `orange` (severe ones), `red` (does not
    /// work) or `unknown`.
    #[getter]
    fn device_status(&self) -> &'static str {
        self.0.device_status.python_name()
    }

    /// Power of the pump, per cent.
    #[getter]
    fn actual_power(&self) -> i32 {
        self.0.actual_power
    }

    /// Vacuum, mbar.
    #[getter]
    fn vacuum(&self) -> i32 {
        self.0.vacuum
    }

    /// The gripper's clock, s.
    #[getter]
    fn time(&self) -> f64 {
        f64::from(self.0.message_id) / 1000.0
    }

    fn __repr__(&self) -> String {
        let state = &self.0;
        let part = if state.part_present {
            ", part present"
        } else {
            ""
        };
        let status: DeviceStatus = state.device_status;
        format!(
            "<VacuumGripperState {:.3} s, {} mbar, {} % power{part}, {}>",
            self.time(),
            state.vacuum,
            state.actual_power,
            status.python_name()
        )
    }
}

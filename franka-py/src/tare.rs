//! The external wrench without its offset for an untouched arm.

use franka_async::state::WrenchTare;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::array;
use crate::operation::{Operation, seconds};
use crate::robot::Robot;
use crate::state::RobotState;

#[pymethods]
impl Robot {
    /// Averages the robot's estimates of external forces and torques over `duration` seconds of its
    /// clock (0.02 to 60), and returns a `WrenchTare`. The arm must be at rest and untouched:
    /// raises `TareError` otherwise, and `ReadError` if states stop arriving. A tare is valid near
    /// the posture in which it was taken. The arm does not move, and the robot's settings do not
    /// change; if cancelled, no tare is taken.
    #[pyo3(signature = (duration = 0.5))]
    fn tare(&self, duration: f64) -> PyResult<Operation> {
        let (robot, duration) = (self.connected()?, seconds("duration", duration)?);
        Ok(Operation::new("Robot.tare", async move {
            robot.tare_over(duration).await.map(PyWrenchTare)
        }))
    }
}

/// The robot's estimate for an untouched arm at rest, to be subtracted later. It is valid near the
/// posture in which it was taken.
#[pyclass(frozen, eq, name = "WrenchTare", module = "franka_async")]
#[derive(Clone, PartialEq)]
pub(crate) struct PyWrenchTare(pub(crate) WrenchTare);

#[pymethods]
impl PyWrenchTare {
    /// Largest distance from its posture at which a tare is valid, rad of any joint.
    #[classattr]
    const NEAR: f64 = WrenchTare::NEAR;

    /// Force, then moment about the origin of the stiffness frame, in axes of the base, `(6,)` N
    /// and N m.
    #[getter]
    fn wrench<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.wrench)
    }

    /// Standard deviation of `wrench` over the average, `(6,)` N and N m.
    #[getter]
    fn deviation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.deviation)
    }

    /// External joint torques, `(7,)` N m.
    #[getter]
    fn joint_torques<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.joint_torques)
    }

    /// Joint positions of the tare, `(7,)` rad.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.q)
    }

    /// Number of averaged states.
    #[getter]
    fn states(&self) -> u32 {
        self.0.states
    }

    /// The wrench of a state minus the tare: force, then moment about the origin of the stiffness
    /// frame, in axes of the base, `(6,)` N and N m, positive when the arm pushes. `None` if the
    /// robot has no estimate, near a singularity.
    fn compensate<'py>(
        &self,
        py: Python<'py>,
        state: &RobotState,
    ) -> Option<Bound<'py, PyArray1<f64>>> {
        let wrench = self.0.compensate(&state.state)?;
        Some(array(py, &wrench))
    }

    /// The external joint torques of a state minus the tare, `(7,)` N m.
    fn compensate_torques<'py>(
        &self,
        py: Python<'py>,
        state: &RobotState,
    ) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.compensate_torques(&state.state))
    }

    /// Largest change of a joint since the tare, rad: beyond `NEAR`, take a new tare.
    fn turned(&self, state: &RobotState) -> f64 {
        self.0.turned(&state.state)
    }

    pub(crate) fn __repr__(&self) -> String {
        let [x, y, z, ..] = self.0.wrench;
        format!(
            "<WrenchTare of {x:.2}, {y:.2}, {z:.2} N, {} states>",
            self.0.states
        )
    }
}

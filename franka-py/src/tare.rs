//! The external wrench without what the robot shows of it with nothing attached.

use franka_async::state::WrenchTare;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::array;
use crate::operation::{Operation, seconds};
use crate::robot::Robot;
use crate::state::RobotState;

#[pymethods]
impl Robot {
    /// Takes the average of what the robot estimates of external forces and torques, over
    /// `duration` seconds of its clock (0.02 to 60), and returns a `WrenchTare`. The arm has to
    /// rest, untouched: raises `TareError` otherwise, and `ReadError` if states no longer come. A
    /// tare belongs to the posture in which it was taken. Nothing moves, and nothing is changed at
    /// the robot; cancelled, it takes no tare.
    #[pyo3(signature = (duration = 0.5))]
    fn tare(&self, duration: f64) -> PyResult<Operation> {
        let (robot, duration) = (self.connected()?, seconds("duration", duration)?);
        Ok(Operation::new("Robot.tare", async move {
            robot.tare_over(duration).await.map(PyWrenchTare)
        }))
    }
}

/// The robot's estimate for an untouched arm at rest, to take off later. It belongs to the
/// posture in which it was taken.
#[pyclass(frozen, eq, name = "WrenchTare", module = "franka_async")]
#[derive(Clone, PartialEq)]
pub(crate) struct PyWrenchTare(pub(crate) WrenchTare);

#[pymethods]
impl PyWrenchTare {
    /// A tare is taken to hold within so much of its posture, rad of any joint.
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

    /// Joint positions in which it was taken, `(7,)` rad.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.q)
    }

    /// How many states it is the average of.
    #[getter]
    fn states(&self) -> u32 {
        self.0.states
    }

    /// The wrench of a state without the tare: force, then moment about the origin of the stiffness
    /// frame, in axes of the base, `(6,)` N and N m, positive where the arm exerts it. `None` where
    /// the robot has no estimate, near a singularity.
    fn compensate<'py>(
        &self,
        py: Python<'py>,
        state: &RobotState,
    ) -> Option<Bound<'py, PyArray1<f64>>> {
        let wrench = self.0.compensate(&state.state)?;
        Some(array(py, &wrench))
    }

    /// The external joint torques of a state without the tare, `(7,)` N m.
    fn compensate_torques<'py>(
        &self,
        py: Python<'py>,
        state: &RobotState,
    ) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.compensate_torques(&state.state))
    }

    /// The largest change of a joint since the tare, rad: beyond `NEAR`, take a new one.
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

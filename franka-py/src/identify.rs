//! What an arm takes beside its model, measured by a minute of small motions.

use franka_async::identify::{Estimate, Identified, Identify};
use franka_async::model::RobotKind;
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{array, table};
use crate::names::Named;
use crate::operation::Operation;
use crate::robot::Robot;

#[pymethods]
impl Robot {
    /// Plans motions that show friction and bias of the joints and the load at the flange: in each
    /// of six poses around where the arm is, all joints go 0.2 rad to and fro twice, at 0.2 rad/s,
    /// about a minute in all. Nothing moves before `run()` of the plan is awaited. The arm has to
    /// be free to go so far, see `reach`, and to carry what it is to be identified with.
    fn identify(&self) -> PyResult<IdentificationPlan> {
        Ok(IdentificationPlan(self.connected()?.identify()))
    }
}

/// Motions that identify an arm. `str()` is a line for each of them.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct IdentificationPlan(Identify);

#[pymethods]
impl IdentificationPlan {
    /// The joint positions that the arm goes to, `(n, 7)` rad, one row for each motion; the last
    /// one is where it is now.
    #[getter]
    fn waypoints<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let targets: Vec<[f64; 7]> = self.0.motions().iter().map(|motion| motion.to).collect();
        table(py, targets.as_flattened(), 7)
    }

    /// About how long it will take, s.
    #[getter]
    fn duration(&self) -> f64 {
        self.0.duration().as_secs_f64()
    }

    /// Farthest that each joint goes from where it is, either way, `(7,)` rad.
    #[getter]
    fn reach_of_joints<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.reach().joints)
    }

    /// Farthest that the end effector goes from where it is, m.
    #[getter]
    fn reach(&self) -> f64 {
        self.0.reach().end_effector
    }

    /// Farthest that the end effector goes down, base frame, m.
    #[getter]
    fn reach_down(&self) -> f64 {
        self.0.reach().down
    }

    /// Moves the arm, and returns an `Identified`. Nothing is changed at the robot: pass the result
    /// to `Robot(address, known=...)` of later connections, and declare the load by `set_load` if
    /// you like. Raises `MotionError`, and `IdentifyError` if the arm is no longer where this was
    /// planned, or was held or pushed. Cancelling brakes the arm; what was measured is lost.
    fn run(&self) -> Operation {
        let plan = self.0.clone();
        Operation::new("IdentificationPlan.run", async move {
            plan.run().await.map(PyIdentified)
        })
    }

    fn __str__(&self) -> String {
        let lines: Vec<String> = self.0.motions().iter().map(ToString::to_string).collect();
        lines.join("\n")
    }

    fn __repr__(&self) -> String {
        format!(
            "<IdentificationPlan of {} motions, {:.0} s, up to {:.2} m away>",
            self.0.motions().len(),
            self.duration(),
            self.reach()
        )
    }
}

/// What is known of one arm: friction and bias of its joints, and the load at its flange. `str()`
/// is a table to read.
#[pyclass(frozen, eq, name = "Identified", module = "franka_async")]
#[derive(Clone, PartialEq)]
pub(crate) struct PyIdentified(pub(crate) Identified);

#[pymethods]
impl PyIdentified {
    /// The kind of the robot: `fr3` or `fer`.
    #[getter]
    fn kind(&self) -> &'static str {
        self.0.kind.python_name()
    }

    /// Friction of each joint at 0.2 rad/s, beyond what the robot compensates itself, `(7,)` N m.
    #[getter]
    fn friction<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.joints.map(|joint| joint.friction.value))
    }

    /// Standard deviation of `friction`, `(7,)` N m.
    #[getter]
    fn friction_deviation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.joints.map(|joint| joint.friction.deviation))
    }

    /// Torque that each joint takes in either direction and in every pose, `(7,)` N m.
    #[getter]
    fn bias<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.joints.map(|joint| joint.bias.value))
    }

    /// Standard deviation of `bias`, `(7,)` N m.
    #[getter]
    fn bias_deviation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.joints.map(|joint| joint.bias.deviation))
    }

    /// Mass of what the flange carries beside the end effector that the robot is configured with,
    /// kg. A declared load is part of it.
    #[getter]
    fn mass(&self) -> f64 {
        self.0.load.mass.value
    }

    /// Standard deviation of `mass`, kg.
    #[getter]
    fn mass_deviation(&self) -> f64 {
        self.0.load.mass.deviation
    }

    /// Its centre of mass in the flange frame, `(3,)` m; `None` where the mass is less than three
    /// of its deviations, and the centre therefore unknown.
    #[getter]
    fn center<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let center: [Estimate; 3] = self.0.load.center()?;
        Some(array(py, &center.map(|axis| axis.value)))
    }

    /// Everything as text, for `from_json`.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string_pretty(&self.0)
            .map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// What `to_json` wrote. Raises `ValueError` for other text and implausible numbers.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        let broken = |error: &dyn std::fmt::Display| {
            PyValueError::new_err(format!("this is no identification: {error}"))
        };
        let found: Identified = serde_json::from_str(text).map_err(|error| broken(&error))?;
        found.check(found.kind).map_err(|error| broken(&error))?;
        Ok(Self(found))
    }

    fn __str__(&self) -> String {
        self.0.to_string()
    }

    fn __repr__(&self) -> String {
        let kind: RobotKind = self.0.kind;
        format!(
            "<Identified {}, load {:.3} kg>",
            kind.python_name(),
            self.mass()
        )
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let make = py.get_type::<Self>().getattr("from_json")?;
        Ok((make, PyTuple::new(py, [self.to_json()?])?))
    }
}

//! The parameters that an arm needs in addition to its model, measured with a minute of small
//! motions.

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
    /// Plans motions that determine friction and bias of the joints and the load at the flange. In
    /// each of six poses around the current position, all joints move 0.2 rad back and forth twice,
    /// at 0.2 rad/s: about a minute in total. The arm does not move before `run()` of the plan is
    /// awaited. It must have free space, see `reach`, and carry the tool to be identified.
    fn identify(&self) -> PyResult<IdentificationPlan> {
        Ok(IdentificationPlan(self.connected()?.identify()))
    }
}

/// Motions that identify an arm. `str()` is a line for each of them.
#[pyclass(frozen, module = "franka_async")]
pub(crate) struct IdentificationPlan(Identify);

#[pymethods]
impl IdentificationPlan {
    /// The joint positions of the motions, `(n, 7)` rad, one row for each; the last one is the
    /// current position.
    #[getter]
    fn waypoints<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let targets: Vec<[f64; 7]> = self.0.motions().iter().map(|motion| motion.to).collect();
        table(py, targets.as_flattened(), 7)
    }

    /// Approximate duration, s.
    #[getter]
    fn duration(&self) -> f64 {
        self.0.duration().as_secs_f64()
    }

    /// Largest displacement of each joint from its current position, in either direction, `(7,)`
    /// rad.
    #[getter]
    fn reach_of_joints<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.reach().joints)
    }

    /// Largest displacement of the end effector from its current position, m.
    #[getter]
    fn reach(&self) -> f64 {
        self.0.reach().end_effector
    }

    /// Largest downward displacement of the end effector, base frame, m.
    #[getter]
    fn reach_down(&self) -> f64 {
        self.0.reach().down
    }

    /// Moves the arm, and returns an `Identified`. The robot's settings do not change: pass the
    /// result to `Robot(address, known=...)` of later connections, and declare the load with
    /// `set_load` if needed. Raises `MotionError`, and `IdentifyError` if the arm has moved since
    /// the plan, or was held or pushed. Cancelling brakes the arm and discards the measurement.
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

/// The identified parameters of one arm: friction and bias of its joints, and the load at its
/// flange. `str()` is a readable table.
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

    /// Friction of each joint at 0.2 rad/s, in addition to the robot's own compensation, `(7,)` N
    /// m.
    #[getter]
    fn friction<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.joints.map(|joint| joint.friction.value))
    }

    /// Standard deviation of `friction`, `(7,)` N m.
    #[getter]
    fn friction_deviation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.joints.map(|joint| joint.friction.deviation))
    }

    /// Torque that each joint needs in both directions and in every pose, `(7,)` N m.
    #[getter]
    fn bias<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.joints.map(|joint| joint.bias.value))
    }

    /// Standard deviation of `bias`, `(7,)` N m.
    #[getter]
    fn bias_deviation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.0.joints.map(|joint| joint.bias.deviation))
    }

    /// Mass at the flange in addition to the configured end effector, kg. It includes a declared
    /// load.
    #[getter]
    fn mass(&self) -> f64 {
        self.0.load.mass.value
    }

    /// Standard deviation of `mass`, kg.
    #[getter]
    fn mass_deviation(&self) -> f64 {
        self.0.load.mass.deviation
    }

    /// Its centre of mass in the flange frame, `(3,)` m; `None` if the mass is less than three of
    /// its deviations, and the centre therefore unknown.
    #[getter]
    fn center<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let center: [Estimate; 3] = self.0.load.center()?;
        Some(array(py, &center.map(|axis| axis.value)))
    }

    /// All values as text, for `from_json`.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string_pretty(&self.0)
            .map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// Parses the output of `to_json`. Raises `ValueError` for other text and implausible numbers.
    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        let broken = |error: &dyn std::fmt::Display| {
            PyValueError::new_err(format!("text is not an identification: {error}"))
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

//! Limits of the joints and of Cartesian motions.

use franka_async::nalgebra::SVector;
use franka_model::limits;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyAny;

use super::{Array, Model};
use crate::arrays::array;
use crate::batch::{Batch, Cost, output, outputs};

/// Limits of the seven joints; each array is a new one, `(7,)`.
#[pyclass(frozen, eq, module = "franka_async")]
#[derive(PartialEq)]
pub(crate) struct JointLimits(limits::JointLimits);

#[pymethods]
impl Model {
    /// Limits of the joints.
    #[getter]
    fn joint_limits(&self) -> JointLimits {
        JointLimits(*self.numbers.joint_limits())
    }

    /// Limits of Cartesian motion commands.
    #[getter]
    fn cartesian_limits(&self) -> CartesianLimits {
        let limits = self.numbers.cartesian_limits();
        let [translation, rotation, elbow] = [limits.translation, limits.rotation, limits.elbow]
            .map(|of| MotionLimits {
                velocity: of.velocity,
                acceleration: of.acceleration,
                jerk: of.jerk,
            });
        CartesianLimits {
            translation,
            rotation,
            elbow,
        }
    }
}

#[pymethods]
impl JointLimits {
    /// Smallest commanded positions, rad, slightly inside `hard_lower`.
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.0.lower.as_slice())
    }

    /// Largest commanded positions, rad, slightly inside `hard_upper`.
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.0.upper.as_slice())
    }

    /// Lower ends of the velocity envelope, rad.
    #[getter]
    fn hard_lower<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.0.hard_lower.as_slice())
    }

    /// Upper ends of the velocity envelope, rad.
    #[getter]
    fn hard_upper<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.0.hard_upper.as_slice())
    }

    /// Largest speeds at any position, rad/s; near position limits see `velocity_envelope`.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.0.velocity.as_slice())
    }

    /// Largest accelerations of a commanded motion, rad/s^2.
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.0.acceleration.as_slice())
    }

    /// Largest jerks of a commanded motion, rad/s^3.
    #[getter]
    fn jerk<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.0.jerk.as_slice())
    }

    /// Largest torques, N m.
    #[getter]
    fn torque<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.0.torque.as_slice())
    }

    /// Largest rates of commanded torques, N m/s.
    #[getter]
    fn torque_rate<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, self.0.torque_rate.as_slice())
    }

    /// Smallest and largest joint velocities at the positions `q`, two arrays `(7,)` or `(n, 7)`,
    /// rad/s. On a Franka Research 3, the speed towards a position limit is bounded so that the
    /// joint can stop before it. `margin` in rad/s is subtracted on both sides: the robot checks
    /// with 0, libfranka limits with 0.001.
    #[pyo3(signature = (q, margin = 0.0))]
    fn velocity_envelope<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        margin: f64,
    ) -> PyResult<(Array<'py>, Array<'py>)> {
        let q = Batch::<7>::read("q", q)?;
        let shapes: [&[usize]; 2] = [&[7], &[7]];
        let arrays = outputs(py, q.count(), shapes, Cost::Little, |i, [least, most]| {
            let (lower, upper) = self.0.velocity_envelope(&(*q.row(i)).into(), margin);
            least.copy_from_slice(lower.as_slice());
            most.copy_from_slice(upper.as_slice());
        });
        Ok(arrays.into())
    }

    /// Distances of the positions `q` to the nearer of `lower` and `upper`, `(7,)` or `(n, 7)` rad,
    /// negative outside.
    fn distance<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Array<'py>> {
        let q = Batch::<7>::read("q", q)?;
        Ok(output(py, q.count(), &[7], Cost::Little, |i, row| {
            let q = SVector::from(*q.row(i));
            let nearer = (q - self.0.lower).inf(&(self.0.upper - q));
            row.copy_from_slice(nearer.as_slice());
        }))
    }

    /// True if every position is within `lower` and `upper`: one value, or an array `(n,)`.
    fn contains<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<bool>>> {
        let q = Batch::<7>::read("q", q)?;
        let inside = |i| self.0.contains(&(*q.row(i)).into());
        let inside: Vec<bool> = (0..q.count().unwrap_or(1)).map(inside).collect();
        let shape: Vec<usize> = q.count().into_iter().collect();
        PyArray1::from_vec(py, inside).reshape(shape)
    }

    fn __repr__(&self) -> String {
        let row = |name: &str, values: &franka_model::JointVector| {
            let values: Vec<String> = values.iter().map(|x| format!("{x:9.4}")).collect();
            format!("\n  {name:<12} {}", values.join(" "))
        };
        let limits = &self.0;
        let rows = [
            row("lower", &limits.lower),
            row("upper", &limits.upper),
            row("velocity", &limits.velocity),
            row("acceleration", &limits.acceleration),
            row("jerk", &limits.jerk),
            row("torque", &limits.torque),
            row("torque_rate", &limits.torque_rate),
        ];
        format!("<JointLimits{}>", rows.concat())
    }
}

/// Bounds on a motion along one coordinate, or on the norm of a vector of them, per second and its
/// powers.
#[pyclass(frozen, get_all, eq, module = "franka_async")]
#[derive(Clone, PartialEq)]
pub(crate) struct MotionLimits {
    /// Velocity, m/s or rad/s.
    velocity: f64,
    /// Acceleration, m/s^2 or rad/s^2.
    acceleration: f64,
    /// Jerk, m/s^3 or rad/s^3.
    jerk: f64,
}

#[pymethods]
impl MotionLimits {
    fn __repr__(&self) -> String {
        format!(
            "<MotionLimits velocity {}, acceleration {}, jerk {}>",
            self.velocity, self.acceleration, self.jerk
        )
    }
}

/// Limits of Cartesian motion commands.
#[pyclass(frozen, get_all, eq, module = "franka_async")]
#[derive(PartialEq)]
pub(crate) struct CartesianLimits {
    /// Limits of the end effector's position: bounds on the norm, m.
    translation: MotionLimits,
    /// Limits of the end effector's orientation: bounds on the norm, rad.
    rotation: MotionLimits,
    /// Limits of the elbow's angle, joint 3, rad.
    elbow: MotionLimits,
}

#[pymethods]
impl CartesianLimits {
    fn __repr__(&self) -> String {
        format!(
            "<CartesianLimits\n  translation {}\n  rotation    {}\n  elbow       {}>",
            self.translation.__repr__(),
            self.rotation.__repr__(),
            self.elbow.__repr__()
        )
    }
}

//! Limits of a motion of several axes.

use franka_model::RobotKind;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use crate::arrays::{Numbers, array, unexpected_shape};

/// Largest velocity, acceleration and jerk of each axis, in both directions. The program chooses
/// the units: rad or m, per second and its powers.
///
/// Each limit is one number for all axes, or one number for each axis, `(n,)`; all must be positive
/// and finite.
#[pyclass(frozen, eq, module = "franka_async")]
#[derive(Clone, PartialEq)]
pub(crate) struct AxisLimits {
    /// One number for all axes, or one for each.
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    jerk: Vec<f64>,
}

#[pymethods]
impl AxisLimits {
    #[new]
    fn new(
        velocity: &Bound<'_, PyAny>,
        acceleration: &Bound<'_, PyAny>,
        jerk: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let limits = Self {
            velocity: limit("velocity", velocity)?,
            acceleration: limit("acceleration", acceleration)?,
            jerk: limit("jerk", jerk)?,
        };
        limits.axes()?;
        Ok(limits)
    }

    /// Limits of the joints of a Franka Research 3. Near a position limit the robot allows less:
    /// see `JointLimits.velocity_envelope`.
    #[staticmethod]
    fn fr3() -> Self {
        Self::of(RobotKind::Fr3)
    }

    /// Limits of the joints of a Franka Emika Robot (Panda).
    #[staticmethod]
    fn fer() -> Self {
        Self::of(RobotKind::Fer)
    }

    /// The same limits times these factors.
    #[pyo3(signature = (velocity = 1.0, acceleration = 1.0, jerk = 1.0))]
    fn scaled(&self, velocity: f64, acceleration: f64, jerk: f64) -> PyResult<Self> {
        for (name, factor) in [
            ("velocity", velocity),
            ("acceleration", acceleration),
            ("jerk", jerk),
        ] {
            if !(factor.is_finite() && factor > 0.0) {
                let text = format!("{name} is {factor}, expected a positive finite factor");
                return Err(PyValueError::new_err(text));
            }
        }
        let times = |limits: &[f64], factor| limits.iter().map(|limit| limit * factor).collect();
        Ok(Self {
            velocity: times(&self.velocity, velocity),
            acceleration: times(&self.acceleration, acceleration),
            jerk: times(&self.jerk, jerk),
        })
    }

    /// Largest velocities: `(n,)`, or `(1,)` for all axes.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        array(py, &self.velocity)
    }

    /// Largest accelerations: `(n,)`, or `(1,)` for all axes.
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        array(py, &self.acceleration)
    }

    /// Largest jerks: `(n,)`, or `(1,)` for all axes.
    #[getter]
    fn jerk<'py>(&self, py: Python<'py>) -> Bound<'py, numpy::PyArray1<f64>> {
        array(py, &self.jerk)
    }

    fn __repr__(&self) -> String {
        format!(
            "AxisLimits(velocity={:?}, acceleration={:?}, jerk={:?})",
            self.velocity, self.acceleration, self.jerk
        )
    }
}

impl AxisLimits {
    fn of(kind: RobotKind) -> Self {
        let limits = franka_model::limits::JointLimits::of(kind);
        let list = |limits: &franka_model::JointVector| limits.iter().copied().collect();
        Self {
            velocity: list(&limits.velocity),
            acceleration: list(&limits.acceleration),
            jerk: list(&limits.jerk),
        }
    }

    /// Returns the number of axes; `None` if any number matches.
    ///
    /// # Errors
    /// `ValueError` if the quantities have different numbers of axes.
    pub(super) fn axes(&self) -> PyResult<Option<usize>> {
        let mut axes = None;
        for (name, limits) in [
            ("velocity", &self.velocity),
            ("acceleration", &self.acceleration),
            ("jerk", &self.jerk),
        ] {
            match axes {
                _ if limits.len() == 1 => {}
                Some(axes) if axes != limits.len() => {
                    return Err(PyValueError::new_err(format!(
                        "{name} has {} axes, expected {axes} as the other limits, or one number",
                        limits.len()
                    )));
                }
                _ => axes = Some(limits.len()),
            }
        }
        Ok(axes)
    }

    pub(super) fn axis(&self, axis: usize) -> franka_otg::AxisLimits {
        let of = |limits: &[f64]| *limits.get(axis).unwrap_or(&limits[0]);
        franka_otg::AxisLimits {
            velocity: of(&self.velocity),
            acceleration: of(&self.acceleration),
            jerk: of(&self.jerk),
        }
    }
}

fn limit(name: &str, argument: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let Numbers { shape, values } = Numbers::read(name, argument)?;
    if shape.len() > 1 || values.is_empty() {
        return Err(unexpected_shape(name, &shape, "a number or (n,)"));
    }
    match values.iter().find(|x| !(x.is_finite() && **x > 0.0)) {
        None => Ok(values),
        Some(value) => Err(PyValueError::new_err(format!(
            "{name} holds {value}, expected positive finite numbers"
        ))),
    }
}

//! Conversion of gains from and to `franka_async.goal.Gains`, and the defaults of Python values.

use franka_async::goal::{Deviation, Gains, Law, Leash, Margin, Settling, Tolerance};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::vector;
use crate::robot::Robot;

/// Reads a `franka_async.goal.Gains`.
///
/// # Errors
/// `TypeError` for another object; `ValueError`.
pub(crate) fn read(gains: &Bound<'_, PyAny>) -> PyResult<Gains> {
    let law: String = gains.getattr("law")?.extract()?;
    let law = match law.as_str() {
        "hybrid" => Law::Hybrid,
        "operational_space" => Law::OperationalSpace,
        _ => {
            let text = format!("law is {law:?}, expected 'hybrid' or 'operational_space'");
            return Err(PyValueError::new_err(text));
        }
    };
    let joints = |name| vector::<7>(name, &gains.getattr(name)?);
    let axes = |name| vector::<6>(name, &gains.getattr(name)?);
    Ok(Gains {
        law,
        cartesian_stiffness: axes("cartesian_stiffness")?,
        cartesian_damping: axes("cartesian_damping")?,
        joint_stiffness: joints("joint_stiffness")?,
        joint_damping: joints("joint_damping")?,
        feedforward: gains.getattr("feedforward")?.extract()?,
        feedforward_cutoff: gains.getattr("feedforward_cutoff")?.extract()?,
        project_joint_gains: gains.getattr("project_joint_gains")?.extract()?,
        compensation: joints("compensation")?,
        torque_limits: joints("torque_limits")?,
        torque_cutoff: gains.getattr("torque_cutoff")?.extract()?,
    })
}

/// Returns the arguments of `franka_async.goal.Gains`.
fn fields<'py>(py: Python<'py>, gains: &Gains) -> PyResult<Bound<'py, PyDict>> {
    let fields = PyDict::new(py);
    let law = match gains.law {
        Law::Hybrid => "hybrid",
        Law::OperationalSpace => "operational_space",
    };
    fields.set_item("law", law)?;
    let rows: [(&str, &[f64]); 6] = [
        ("cartesian_stiffness", &gains.cartesian_stiffness),
        ("cartesian_damping", &gains.cartesian_damping),
        ("joint_stiffness", &gains.joint_stiffness),
        ("joint_damping", &gains.joint_damping),
        ("compensation", &gains.compensation),
        ("torque_limits", &gains.torque_limits),
    ];
    for (name, row) in rows {
        fields.set_item(name, PyTuple::new(py, row)?)?;
    }
    fields.set_item("feedforward", gains.feedforward)?;
    fields.set_item("feedforward_cutoff", gains.feedforward_cutoff)?;
    fields.set_item("project_joint_gains", gains.project_joint_gains)?;
    fields.set_item("torque_cutoff", gains.torque_cutoff)?;
    Ok(fields)
}

/// Returns the gains with this name, as arguments of `Gains`.
#[pyfunction]
pub(crate) fn _gains<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyDict>> {
    let gains = match name {
        "cartesian" => Gains::cartesian(),
        "joint" => Gains::joint(),
        "droid" => Gains::droid(),
        _ => {
            return Err(PyValueError::new_err(format!(
                "got the gains {name:?}, expected a known name"
            )));
        }
    };
    fields(py, &gains)
}

/// Returns these gains with another stiffness at the end effector, as arguments of `Gains`.
#[pyfunction]
pub(crate) fn _softened<'py>(
    py: Python<'py>,
    gains: &Bound<'py, PyAny>,
    stiffness: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let stiffness = vector("stiffness", stiffness)?;
    fields(py, &read(gains)?.with_cartesian_stiffness(stiffness))
}

/// Adds the defaults of `franka_async.goal` to the module.
pub(crate) fn add_defaults(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let leash = Leash::default();
    module.add("_LEASH", (leash.translation, leash.rotation, leash.joints))?;
    let deviation = Deviation::default();
    let bounds = (deviation.translation, deviation.rotation, deviation.joints);
    module.add("_DEVIATION", bounds)?;
    let tolerance = Tolerance::default();
    module.add("_TOLERANCE", (tolerance.translation, tolerance.rotation))?;
    let settling = Settling::default();
    let times = (settling.hold.as_secs_f64(), settling.timeout.as_secs_f64());
    module.add("_SETTLING", times)?;
    module.add("_MARGIN", Margin::WANTED)
}

#[pymethods]
impl Robot {
    /// Margin of gains to the first oscillation of such an arm in its current posture: a `Margin`.
    /// `None` for gains that are out of range.
    fn margin<'py>(&self, gains: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(margin) = self.connected()?.margin(&read(gains)?) else {
            return Ok(None);
        };
        let class = gains.py().import("franka_async.goal")?.getattr("Margin")?;
        Ok(Some(class.call1((margin.damping, margin.stiffness))?))
    }
}

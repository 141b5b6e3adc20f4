//! Mass, Coriolis and gravity torques, inverse and forward dynamics.
#![allow(non_snake_case)]

use franka_model::JointVector;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyAny;

use super::arguments::{end_effector, gravity, load};
use super::{Array, Model};
use crate::batch::{Batch, Cost, output, outputs, write_matrix};

/// The quantities that a control law needs at a state of the arm, from one pass. Results of a batch
/// have a leading axis.
#[pyclass(frozen, get_all, module = "franka_async")]
pub(crate) struct Dynamics {
    /// Pose of the end effector in the base frame, `(4, 4)`.
    pose: Py<PyArrayDyn<f64>>,
    /// Zero Jacobian of the end effector, `(6, 7)`.
    jacobian: Py<PyArrayDyn<f64>>,
    /// Joint-space inertia, `(7, 7)` kg m^2.
    mass: Py<PyArrayDyn<f64>>,
    /// Torques of Coriolis and centrifugal forces, `(7,)` N m.
    coriolis: Py<PyArrayDyn<f64>>,
    /// Torques that hold the arm still against gravity, `(7,)` N m.
    gravity: Py<PyArrayDyn<f64>>,
    /// `dJ/dt dq`: acceleration of the end effector while the joints keep their velocity, `(6,)`
    /// m/s^2 and rad/s^2 in base axes.
    jdot_dq: Py<PyArrayDyn<f64>>,
}

#[pymethods]
impl Model {
    /// Joint-space inertia without rotors, `(7, 7)` or `(n, 7, 7)` kg m^2.
    ///
    /// A load has the mass `m_total` in kg, its centre of mass `F_x_Ctotal` in the flange frame,
    /// `(3,)` m, and its inertia about that point in flange axes, `I_total`, `(3, 3)` kg m^2, as in
    /// states. This applies to all methods. The default is no load and no tool: pass a robot's
    /// values from its state.
    #[pyo3(signature = (q, I_total = None, m_total = 0.0, F_x_Ctotal = None))]
    fn mass<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        I_total: Option<&Bound<'py, PyAny>>,
        m_total: f64,
        F_x_Ctotal: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Array<'py>> {
        let load = load(I_total, m_total, F_x_Ctotal)?;
        let (model, q) = (&self.numbers, Batch::read("q", q)?);
        Ok(output(py, q.count(), &[7, 7], Cost::Little, |i, row| {
            write_matrix(&model.mass(&(*q.row(i)).into(), &load), row);
        }))
    }

    /// Torques of Coriolis and centrifugal forces, `(7,)` or `(n, 7)` N m. Without tool and load
    /// unless given, as for `mass`.
    #[pyo3(signature = (q, dq, I_total = None, m_total = 0.0, F_x_Ctotal = None))]
    fn coriolis<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        I_total: Option<&Bound<'py, PyAny>>,
        m_total: f64,
        F_x_Ctotal: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Array<'py>> {
        let load = load(I_total, m_total, F_x_Ctotal)?;
        let (q, dq) = (Batch::<7>::read("q", q)?, Batch::<7>::read("dq", dq)?);
        let (model, count) = (&self.numbers, q.count_with(&dq)?);
        Ok(output(py, count, &[7], Cost::Little, |i, row| {
            let (q, dq) = ((*q.row(i)).into(), (*dq.row(i)).into());
            row.copy_from_slice(model.coriolis(&q, &dq, &load).as_slice());
        }))
    }

    /// Torques that hold the arm still against gravity, `(7,)` or `(n, 7)` N m. `gravity_earth` is
    /// the gravitational acceleration in the base frame, `(3,)` m/s^2, by default for an upright
    /// robot. Without tool and load unless given, as for `mass`.
    #[pyo3(signature = (q, m_total = 0.0, F_x_Ctotal = None, gravity_earth = None))]
    fn gravity<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        m_total: f64,
        F_x_Ctotal: Option<&Bound<'py, PyAny>>,
        gravity_earth: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Array<'py>> {
        let load = load(None, m_total, F_x_Ctotal)?;
        let gravity = gravity(gravity_earth)?;
        let (model, q) = (&self.numbers, Batch::read("q", q)?);
        Ok(output(py, q.count(), &[7], Cost::Little, |i, row| {
            let torque = model.gravity(&(*q.row(i)).into(), &load, &gravity);
            row.copy_from_slice(torque.as_slice());
        }))
    }

    /// Pose, Jacobian, mass, Coriolis and gravity torques from one pass, for the end effector
    /// `F_T_EE`, the identity unless given. Without tool and load unless given, as for `mass`.
    #[pyo3(signature = (q, dq, *, F_T_EE = None, I_total = None, m_total = 0.0, F_x_Ctotal = None, gravity_earth = None))]
    #[allow(clippy::too_many_arguments)] // the caller names each argument
    fn dynamics<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        F_T_EE: Option<&Bound<'py, PyAny>>,
        I_total: Option<&Bound<'py, PyAny>>,
        m_total: f64,
        F_x_Ctotal: Option<&Bound<'py, PyAny>>,
        gravity_earth: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Dynamics> {
        let ee = end_effector(F_T_EE, None)?;
        let load = load(I_total, m_total, F_x_Ctotal)?;
        let gravity = gravity(gravity_earth)?;
        let (q, dq) = (Batch::<7>::read("q", q)?, Batch::<7>::read("dq", dq)?);
        let (model, count) = (&self.numbers, q.count_with(&dq)?);
        let shapes: [&[usize]; 6] = [&[4, 4], &[6, 7], &[7, 7], &[7], &[7], &[6]];
        let arrays = outputs(py, count, shapes, Cost::Little, |i, rows| {
            let (q, dq) = ((*q.row(i)).into(), (*dq.row(i)).into());
            let all = model.dynamics(&q, &dq, &ee, &load, &gravity);
            let [pose, jacobian, mass, coriolis, gravity, jdot_dq] = rows;
            write_matrix(&all.pose, pose);
            write_matrix(&all.jacobian, jacobian);
            write_matrix(&all.mass, mass);
            coriolis.copy_from_slice(all.coriolis.as_slice());
            gravity.copy_from_slice(all.gravity.as_slice());
            jdot_dq.copy_from_slice(all.jdot_dq.as_slice());
        });
        let [pose, jacobian, mass, coriolis, gravity, jdot_dq] = arrays.map(Bound::unbind);
        Ok(Dynamics {
            pose,
            jacobian,
            mass,
            coriolis,
            gravity,
            jdot_dq,
        })
    }

    /// Torques for the accelerations `ddq`, `M ddq + C dq + g`: `(7,)` or `(n, 7)` N m. Without
    /// tool and load unless given, as for `mass`.
    #[pyo3(signature = (q, dq, ddq, *, I_total = None, m_total = 0.0, F_x_Ctotal = None, gravity_earth = None))]
    #[allow(clippy::too_many_arguments)] // the caller names each argument
    fn inverse_dynamics<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
        I_total: Option<&Bound<'py, PyAny>>,
        m_total: f64,
        F_x_Ctotal: Option<&Bound<'py, PyAny>>,
        gravity_earth: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Array<'py>> {
        let load = load(I_total, m_total, F_x_Ctotal)?;
        let gravity = gravity(gravity_earth)?;
        let state = [("q", q), ("dq", dq), ("ddq", ddq)];
        let (state, count) = three(state)?;
        let model = &self.numbers;
        Ok(output(py, count, &[7], Cost::Little, |i, row| {
            let [q, dq, ddq] = state.each_ref().map(|part| (*part.row(i)).into());
            let torque = model.inverse_dynamics(&q, &dq, &ddq, &load, &gravity);
            row.copy_from_slice(torque.as_slice());
        }))
    }

    /// Accelerations under the joint torques `tau`, gravity included: `(7,)` or `(n, 7)` rad/s^2.
    /// `armature` is the reflected rotor inertia of the joints, `(7,)` kg m^2, zero unless given.
    /// If mass and armature are not physical, the result is NaN. Without tool and load unless
    /// given, as for `mass`.
    #[pyo3(signature = (q, dq, tau, *, I_total = None, m_total = 0.0, F_x_Ctotal = None, gravity_earth = None, armature = None))]
    #[allow(clippy::too_many_arguments)] // the caller names each argument
    fn forward_dynamics<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        tau: &Bound<'py, PyAny>,
        I_total: Option<&Bound<'py, PyAny>>,
        m_total: f64,
        F_x_Ctotal: Option<&Bound<'py, PyAny>>,
        gravity_earth: Option<&Bound<'py, PyAny>>,
        armature: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Array<'py>> {
        let load = load(I_total, m_total, F_x_Ctotal)?;
        let gravity = gravity(gravity_earth)?;
        let armature = match armature {
            Some(armature) => crate::arrays::vector("armature", armature)?.into(),
            None => JointVector::zeros(),
        };
        let (state, count) = three([("q", q), ("dq", dq), ("tau", tau)])?;
        let model = &self.numbers;
        Ok(output(py, count, &[7], Cost::Little, |i, row| {
            let [q, dq, tau] = state.each_ref().map(|part| (*part.row(i)).into());
            let ddq = model.forward_dynamics(&q, &dq, &tau, &load, &gravity, &armature);
            let ddq = ddq.unwrap_or(JointVector::repeat(f64::NAN));
            row.copy_from_slice(ddq.as_slice());
        }))
    }
}

/// Returns three batches of joint vectors, and their common number of rows.
///
/// # Errors
/// `ValueError` for wrong shapes and different numbers of rows.
fn three(
    arguments: [(&'static str, &Bound<'_, PyAny>); 3],
) -> PyResult<([Batch<7>; 3], Option<usize>)> {
    let [one, two, three] = arguments.map(|(name, argument)| Batch::read(name, argument));
    let (one, two, three) = (one?, two?, three?);
    let counts = [
        one.count_with(&two)?,
        one.count_with(&three)?,
        two.count_with(&three)?,
    ];
    let count = counts.into_iter().flatten().next();
    Ok(([one, two, three], count))
}

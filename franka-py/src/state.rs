//! States as numpy arrays. Derived forms, such as text, are in `state_views`.
#![allow(non_snake_case)]

use franka_async::connection::Version;
use franka_async::state::{Errors, TotalLoad};
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arrays::{array, columns, table};
use crate::names::Named;

/// The robot's state of one millisecond, with the vendor's names: O base, F flange, NE nominal end
/// effector, EE end effector, K stiffness frame; `X_T_Y` is the pose of Y in X, with the
/// translation in the last column.
///
/// The state is immutable. Each access returns a new array, which the program may change.
#[pyclass(frozen, eq, module = "franka_async")]
#[derive(Clone, PartialEq)]
pub(crate) struct RobotState {
    pub(crate) state: Box<franka_async::state::RobotState>,
    pub(crate) version: Version,
}

#[pymethods]
impl RobotState {
    /// Measured joint positions, `(7,)` rad.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.q)
    }

    /// Desired joint positions, `(7,)` rad.
    #[getter]
    fn q_d<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.q_d)
    }

    /// Measured joint velocities, `(7,)` rad/s.
    #[getter]
    fn dq<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.dq)
    }

    /// Desired joint velocities, `(7,)` rad/s.
    #[getter]
    fn dq_d<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.dq_d)
    }

    /// Desired joint accelerations, `(7,)` rad/s^2.
    #[getter]
    fn ddq_d<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.ddq_d)
    }

    /// Measured link-side joint torques, gravity included, `(7,)` N m.
    #[getter]
    fn tau_J<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.tau_J)
    }

    /// Desired joint torques, gravity excluded, `(7,)` N m.
    #[getter]
    fn tau_J_d<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.tau_J_d)
    }

    /// Derivatives of the measured joint torques, `(7,)` N m/s.
    #[getter]
    fn dtau_J<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.dtau_J)
    }

    /// Motor positions, `(7,)` rad.
    #[getter]
    fn theta<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.theta)
    }

    /// Motor velocities, `(7,)` rad/s.
    #[getter]
    fn dtheta<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.dtheta)
    }

    /// Contact level of each joint, `(7,)`, 0 or 1.
    #[getter]
    fn joint_contact<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.joint_contact)
    }

    /// Collision level of each joint until the recovery, `(7,)`, 0 or 1.
    #[getter]
    fn joint_collision<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.joint_collision)
    }

    /// Estimated external joint torques, `(7,)` N m.
    #[getter]
    fn tau_ext_hat_filtered<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.tau_ext_hat_filtered)
    }

    /// Contact level of each Cartesian axis, `(6,)`, 0 or 1.
    #[getter]
    fn cartesian_contact<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.cartesian_contact)
    }

    /// Collision level of each Cartesian axis until the recovery, `(6,)`, 0 or 1.
    #[getter]
    fn cartesian_collision<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.cartesian_collision)
    }

    /// Estimated external wrench in the base frame, `(6,)` N and N m, its torque about the origin
    /// of the base, positive when the robot pushes. Zeros near a singularity.
    #[getter]
    fn O_F_ext_hat_K<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.O_F_ext_hat_K)
    }

    /// Estimated external wrench on the stiffness frame in the stiffness frame, `(6,)` N and N m,
    /// positive when the robot pushes. Zeros near a singularity.
    #[getter]
    fn K_F_ext_hat_K<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.K_F_ext_hat_K)
    }

    /// Desired twist of the end effector in the base frame, `(6,)` m/s and rad/s.
    #[getter]
    fn O_dP_EE_d<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.O_dP_EE_d)
    }

    /// Last commanded twist of the end effector in the base frame, `(6,)` m/s and rad/s.
    #[getter]
    fn O_dP_EE_c<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.O_dP_EE_c)
    }

    /// Last commanded acceleration of the end effector in the base frame, `(6,)` m/s^2 and rad/s^2.
    #[getter]
    fn O_ddP_EE_c<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.O_ddP_EE_c)
    }

    /// Acceleration of the base, gravity included, `(3,)` m/s^2.
    #[getter]
    fn O_ddP_O<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.O_ddP_O)
    }

    /// Centre of mass of the end effector in the flange frame, `(3,)` m.
    #[getter]
    fn F_x_Cee<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.F_x_Cee)
    }

    /// Centre of mass of the load in the flange frame, `(3,)` m.
    #[getter]
    fn F_x_Cload<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.F_x_Cload)
    }

    /// Measured elbow, `(2,)`: angle of joint 3 in rad and sign of joint 4.
    #[getter]
    fn elbow<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.elbow)
    }

    /// Desired elbow, `(2,)`: angle of joint 3 in rad and sign of joint 4.
    #[getter]
    fn elbow_d<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.elbow_d)
    }

    /// Last commanded elbow, `(2,)`: angle of joint 3 in rad and sign of joint 4.
    #[getter]
    fn elbow_c<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.elbow_c)
    }

    /// Velocity of the commanded elbow, `(2,)`: velocity of joint 3 in rad/s, then 0.
    #[getter]
    fn delbow_c<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.delbow_c)
    }

    /// Acceleration of the commanded elbow, `(2,)`: acceleration of joint 3 in rad/s^2, then 0.
    #[getter]
    fn ddelbow_c<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.state.ddelbow_c)
    }

    /// Measured pose of the end effector in the base frame, `(4, 4)`.
    #[getter]
    fn O_T_EE<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        columns::<4, 4>(py, &self.state.O_T_EE)
    }

    /// Desired pose of the end effector in the base frame, `(4, 4)`.
    #[getter]
    fn O_T_EE_d<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        columns::<4, 4>(py, &self.state.O_T_EE_d)
    }

    /// Last commanded pose of the end effector in the base frame, `(4, 4)`.
    #[getter]
    fn O_T_EE_c<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        columns::<4, 4>(py, &self.state.O_T_EE_c)
    }

    /// Pose of the end effector in the flange frame, `(4, 4)`.
    #[getter]
    fn F_T_EE<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        columns::<4, 4>(py, &self.state.F_T_EE)
    }

    /// Pose of the stiffness frame in the end-effector frame, `(4, 4)`.
    #[getter]
    fn EE_T_K<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        columns::<4, 4>(py, &self.state.EE_T_K)
    }

    /// Pose of the nominal end effector in the flange frame, `(4, 4)`.
    #[getter]
    fn F_T_NE<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        columns::<4, 4>(py, &self.state.F_T_NE)
    }

    /// Pose of the end effector in the nominal end-effector frame, `(4, 4)`.
    #[getter]
    fn NE_T_EE<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        columns::<4, 4>(py, &self.state.NE_T_EE)
    }

    /// Inertia of the end effector about its centre of mass, `(3, 3)` kg m^2.
    #[getter]
    fn I_ee<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        columns::<3, 3>(py, &self.state.I_ee)
    }

    /// Inertia of the load about its centre of mass, `(3, 3)` kg m^2.
    #[getter]
    fn I_load<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        columns::<3, 3>(py, &self.state.I_load)
    }

    /// Mass of the end effector, kg.
    #[getter]
    fn m_ee(&self) -> f64 {
        self.state.m_ee
    }

    /// Mass of the load, kg.
    #[getter]
    fn m_load(&self) -> f64 {
        self.state.m_load
    }

    /// Share of the last 100 commands that arrived in time, 0 to 1; 0 while no control runs.
    #[getter]
    pub(crate) fn control_command_success_rate(&self) -> f64 {
        self.state.control_command_success_rate
    }

    /// Mass of end effector and load, kg.
    #[getter]
    fn m_total(&self) -> f64 {
        self.total().m_total
    }

    /// Common centre of mass of end effector and load in the flange frame, `(3,)` m.
    #[getter]
    fn F_x_Ctotal<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        array(py, &self.total().F_x_Ctotal)
    }

    /// Inertia of end effector and load about their common centre of mass, `(3, 3)` kg m^2.
    #[getter]
    fn I_total<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        columns::<3, 3>(py, &self.total().I_total)
    }

    /// Upper accelerometers of joints 1 to 6, `(6, 3)` m/s^2; zero on a Franka Emika Robot.
    #[getter]
    fn accelerometer_top<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        accelerometers(py, &self.state.accelerometer_top)
    }

    /// Lower accelerometers of joints 1 to 6, `(6, 3)` m/s^2; zero on a Franka Emika Robot.
    #[getter]
    fn accelerometer_bottom<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        accelerometers(py, &self.state.accelerometer_bottom)
    }

    /// The robot's clock, s: a thousandth more with each cycle.
    #[getter]
    pub(crate) fn time(&self) -> f64 {
        self.state.message_id as f64 / 1000.0
    }

    /// The robot's clock, ms: one more with each cycle.
    #[getter]
    fn time_ms(&self) -> u64 {
        self.state.message_id
    }

    /// Overall mode of the robot: `other`, `idle`, `move`, `guiding`, `reflex`, `user_stopped` or
    /// `automatic_error_recovery`.
    #[getter]
    pub(crate) fn robot_mode(&self) -> &'static str {
        self.state.robot_mode.python_name()
    }

    /// The active motion generator.
    #[getter]
    pub(crate) fn motion_generator_mode(&self) -> &'static str {
        self.state.motion_generator_mode.python_name()
    }

    /// The active controller.
    #[getter]
    pub(crate) fn controller_mode(&self) -> &'static str {
        self.state.controller_mode.python_name()
    }

    /// Errors that block the robot now, by the vendor's names.
    #[getter]
    pub(crate) fn current_errors(&self) -> Vec<String> {
        names(self.state.errors)
    }

    /// Errors that ended the last motion, by the vendor's names.
    #[getter]
    pub(crate) fn last_motion_errors(&self) -> Vec<String> {
        names(self.state.reflex_reason)
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let json = serde_json::to_string(&*self.state)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        let make = py
            .import("franka_async._native")?
            .getattr("_state_of_json")?;
        Ok((
            make,
            PyTuple::new(
                py,
                [
                    json.into_pyobject(py)?.into_any(),
                    self.version.number().into_pyobject(py)?.into_any(),
                ],
            )?,
        ))
    }
}

impl RobotState {
    pub(crate) fn new(state: franka_async::state::RobotState, version: Version) -> Self {
        let state = Box::new(state);
        Self { state, version }
    }

    fn total(&self) -> TotalLoad {
        self.state.total_load(self.version)
    }
}

/// The state written by `pickle`.
#[pyfunction]
pub(crate) fn _state_of_json(json: &str, version: u16) -> PyResult<RobotState> {
    let version = Version::from_number(version)
        .ok_or_else(|| PyValueError::new_err(format!("got protocol version {version}")))?;
    let state =
        serde_json::from_str(json).map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(RobotState::new(state, version))
}

pub(crate) fn names(errors: Errors) -> Vec<String> {
    errors.iter().map(|error| error.to_string()).collect()
}

fn accelerometers<'py>(py: Python<'py>, values: &[[f32; 3]; 6]) -> Bound<'py, PyArray2<f64>> {
    let values: Vec<f64> = values
        .iter()
        .flatten()
        .map(|value| f64::from(*value))
        .collect();
    table(py, &values, 3)
}

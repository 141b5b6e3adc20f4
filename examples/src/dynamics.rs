//! The quantities of the model that a torque law needs.

use franka_async::connection::Version;
use franka_async::model::{Dynamics, EndEffector, Load, Model};
use franka_async::state::RobotState;

/// The model at a state: pose, Jacobian, mass, Coriolis and gravity torques, with the end effector
/// and the load that are set on the robot. One pass over the arm without allocation, so it can be
/// called in a control function.
pub fn dynamics(model: &Model, version: Version, state: &RobotState) -> Dynamics {
    let load = state.total_load(version);
    model.dynamics(
        &state.q.into(),
        &state.dq.into(),
        &EndEffector::from_arrays(&state.F_T_EE, &state.EE_T_K),
        &Load::from_arrays(load.m_total, &load.F_x_Ctotal, &load.I_total),
        &state.O_ddP_O.into(),
    )
}

//! The pose of the end effector in the base frame, `[m]`: the measured pose, and the pose at given
//! joint positions.

use franka_model::{Frame, Model, transform};
use franka_proto::RobotState;
use franka_rt::session::geometry::reported_end_effector;
use nalgebra::Isometry3;

/// Returns `O_T_EE` of a state, if it is a rigid transformation.
pub(crate) fn pose_of(state: &RobotState) -> Option<Isometry3<f64>> {
    transform::isometry_from_array(&state.O_T_EE)
}

/// Returns the pose of the end effector at the joint positions `q`, `[rad]`, with the end effector
/// of `state`. If that end effector is not a rigid transformation, the flange is used instead.
pub(crate) fn pose_at(model: &Model, state: &RobotState, q: [f64; 7]) -> Isometry3<f64> {
    let ee = reported_end_effector(model, state).unwrap_or_default();
    let pose = model.pose(Frame::EndEffector, &q.into(), &ee);
    transform::isometry(&pose).unwrap_or_default()
}

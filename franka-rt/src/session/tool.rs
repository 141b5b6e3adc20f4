//! Frames and loads of a robot state, as types of the model.

use franka_model::{EndEffector, Load, transform};
use franka_proto::{RobotState, Version};
use nalgebra::{Isometry3, Matrix4, Rotation3, Translation3, UnitQuaternion};

/// Returns the end effector and the stiffness frame of a state. Both are orthonormalised, because
/// protocol 10 rounds them to `f32`. Returns `None` if one of them is not a rigid transformation.
pub(crate) fn end_effector_of(state: &RobotState) -> Option<EndEffector> {
    let rigid = |column_major| {
        transform::isometry_from_array(column_major).map(|pose| transform::matrix(&pose))
    };
    Some(EndEffector {
        f_t_ee: rigid(&state.F_T_EE)?,
        ee_t_k: rigid(&state.EE_T_K)?,
    })
}

/// Returns the combined load of end effector and payload in a state of protocol `version`. Returns
/// `None` if one of its numbers is not finite.
pub(crate) fn load_of(state: &RobotState, version: Version) -> Option<Load> {
    let total = state.total_load(version);
    let numbers = [&[total.m_total][..], &total.F_x_Ctotal, &total.I_total];
    let finite = numbers.into_iter().flatten().all(|x| x.is_finite());
    finite.then(|| Load {
        mass: total.m_total,
        com: total.F_x_Ctotal.into(),
        inertia: nalgebra::Matrix3::from_column_slice(&total.I_total),
    })
}

/// Converts a pose of the model to an isometry. The model's poses are products of rotations, so
/// they need no orthonormalisation.
pub(crate) fn rigid(pose: &Matrix4<f64>) -> Isometry3<f64> {
    let rotation = Rotation3::from_matrix_unchecked(pose.fixed_view::<3, 3>(0, 0).into_owned());
    Isometry3::from_parts(
        Translation3::new(pose[(0, 3)], pose[(1, 3)], pose[(2, 3)]),
        UnitQuaternion::from_rotation_matrix(&rotation),
    )
}

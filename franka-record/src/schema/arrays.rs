//! Conversion of arrays and poses to and from messages.

use franka_model::transform;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

use super::franka;

/// Writes `values` with the precision of the message, `f32`.
pub(super) fn put(message: &mut Vec<f32>, values: &[f64]) {
    message.clear();
    message.extend(values.iter().map(|&value| value as f32));
}

/// Like [`put`], but omits the field if all values are zero.
pub(super) fn put_unless_zero(message: &mut Vec<f32>, values: &[f64]) {
    message.clear();
    if values.iter().any(|&value| value != 0.0) {
        put(message, values);
    }
}

/// Reads the values of a field. Missing values are zero, also if the whole field is missing.
pub(super) fn get<const N: usize>(message: &[f32]) -> [f64; N] {
    core::array::from_fn(|index| message.get(index).map_or(0.0, |&value| f64::from(value)))
}

/// Does the same as [`get`] for a field with full precision.
pub(super) fn get_exact<const N: usize>(message: &[f64]) -> [f64; N] {
    core::array::from_fn(|index| message.get(index).copied().unwrap_or(0.0))
}

/// Writes `true` for each level above zero.
pub(super) fn put_levels(message: &mut Vec<bool>, levels: &[f64]) {
    message.clear();
    message.extend(levels.iter().map(|&level| level > 0.0));
}

/// Reads levels, each of which is 0 or 1.
pub(super) fn get_levels<const N: usize>(message: &[bool]) -> [f64; N] {
    core::array::from_fn(|index| f64::from(u8::from(message.get(index) == Some(&true))))
}

/// Converts a column-major matrix to a pose; `None` if it is not a rigid transformation.
pub(super) fn pose_of(matrix: &[f64; 16]) -> Option<franka::Pose> {
    transform::isometry_from_array(matrix).map(|isometry| pose(&isometry))
}

/// Returns the column-major matrix of a pose. Returns the identity if the pose is missing or
/// invalid.
pub(super) fn matrix_of(pose: Option<&franka::Pose>) -> [f64; 16] {
    transform::array(&pose.and_then(isometry).unwrap_or_default())
}

pub(super) fn pose(isometry: &Isometry3<f64>) -> franka::Pose {
    let [x, y, z, qx, qy, qz, qw] = numbers(isometry).map(|number| number as f32);
    franka::Pose {
        x,
        y,
        z,
        qx,
        qy,
        qz,
        qw,
    }
}

/// Returns the pose in a message; `None` if the numbers do not form a pose.
pub(super) fn isometry(pose: &franka::Pose) -> Option<Isometry3<f64>> {
    let franka::Pose {
        x,
        y,
        z,
        qx,
        qy,
        qz,
        qw,
    } = *pose;
    from_numbers([x, y, z, qx, qy, qz, qw].map(f64::from))
}

/// Returns the position followed by the quaternion `[x, y, z, w]`.
pub(super) fn numbers(isometry: &Isometry3<f64>) -> [f64; 7] {
    let (position, rotation) = (isometry.translation, isometry.rotation);
    [
        position.x, position.y, position.z, rotation.i, rotation.j, rotation.k, rotation.w,
    ]
}

/// Returns the pose for the output of [`numbers`]; `None` if a number is not finite or the
/// quaternion is zero.
pub(super) fn from_numbers(numbers: [f64; 7]) -> Option<Isometry3<f64>> {
    let [x, y, z, qx, qy, qz, qw] = numbers;
    let rotation = UnitQuaternion::try_new(Quaternion::new(qw, qx, qy, qz), 1e-3)?;
    let finite = numbers.iter().all(|number| number.is_finite());
    finite.then(|| Isometry3::from_parts(Translation3::new(x, y, z), rotation))
}

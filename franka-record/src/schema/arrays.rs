//! Arrays and poses as messages carry them.

use franka_model::transform;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

use super::franka;

/// Writes `values` with the precision of the message.
pub(super) fn put(message: &mut Vec<f32>, values: &[f64]) {
    message.clear();
    message.extend(values.iter().map(|&value| value as f32));
}

/// As [`put`], but leaves the field out where all are zero.
pub(super) fn put_unless_zero(message: &mut Vec<f32>, values: &[f64]) {
    message.clear();
    if values.iter().any(|&value| value != 0.0) {
        put(message, values);
    }
}

/// Reads as many values as there are; the rest, and all of a field that is left out, is zero.
pub(super) fn get<const N: usize>(message: &[f32]) -> [f64; N] {
    core::array::from_fn(|index| message.get(index).map_or(0.0, |&value| f64::from(value)))
}

/// As [`get`], without a loss.
pub(super) fn get_exact<const N: usize>(message: &[f64]) -> [f64; N] {
    core::array::from_fn(|index| message.get(index).copied().unwrap_or(0.0))
}

/// Writes whether each level is above zero.
pub(super) fn put_levels(message: &mut Vec<bool>, levels: &[f64]) {
    message.clear();
    message.extend(levels.iter().map(|&level| level > 0.0));
}

/// Reads levels: 0 or 1 each.
pub(super) fn get_levels<const N: usize>(message: &[bool]) -> [f64; N] {
    core::array::from_fn(|index| f64::from(u8::from(message.get(index) == Some(&true))))
}

/// A column-major matrix as a pose; `None` if it is not a rigid transformation.
pub(super) fn pose_of(matrix: &[f64; 16]) -> Option<franka::Pose> {
    transform::isometry_from_array(matrix).map(|isometry| pose(&isometry))
}

/// A column-major matrix of a pose; the identity for one that is missing or no pose.
pub(super) fn matrix_of(pose: Option<&franka::Pose>) -> [f64; 16] {
    transform::array(&pose.and_then(isometry).unwrap_or_default())
}

/// A pose as a message.
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

/// The pose of a message; `None` if its numbers are no pose.
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

/// Position, then the quaternion `[x, y, z, w]`.
pub(super) fn numbers(isometry: &Isometry3<f64>) -> [f64; 7] {
    let (position, rotation) = (isometry.translation, isometry.rotation);
    [
        position.x, position.y, position.z, rotation.i, rotation.j, rotation.k, rotation.w,
    ]
}

/// The pose of [`numbers`]; `None` if one is not finite or the quaternion has no direction.
pub(super) fn from_numbers(numbers: [f64; 7]) -> Option<Isometry3<f64>> {
    let [x, y, z, qx, qy, qz, qw] = numbers;
    let rotation = UnitQuaternion::try_new(Quaternion::new(qw, qx, qy, qz), 1e-3)?;
    let finite = numbers.iter().all(|number| number.is_finite());
    finite.then(|| Isometry3::from_parts(Translation3::new(x, y, z), rotation))
}

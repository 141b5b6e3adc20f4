//! Converts poses from and to the formats of other programs, and rotates poses in place.
//!
//! A [`Pose`] is an [`Isometry3`](crate::nalgebra::Isometry3) of `nalgebra`; for most tasks,
//! multiply poses. `start` is a pose of the end effector in the base frame:
//!
//! | wanted | written |
//! |---|---|
//! | `start`, 5 cm up in the base frame | `Pose::translation(0.0, 0.0, 0.05) * start` |
//! | `start`, 5 cm along the z axis of the end effector | `start * Pose::translation(0.0, 0.0, 0.05)` |
//! | turned by `turn` about axes of the end effector | `start * turn` |
//! | turned by `turn` about axes of the base through the end effector | [`rotated`]`(&start, turn)` |
//! | the position, the orientation | `start.translation.vector`, `start.rotation` |
//! | the way from `start` to `goal`, in axes of `start` | `start.inv_mul(&goal)` |
//!
//! `turn` is a [`UnitQuaternion`]. A state contains its poses as column-major arrays: see
//! [`from_array`]. Policies and planners often use positions and quaternions: see [`from_xyzw`].
//! The model uses matrices: see [`from_matrix`].
//!
//! ```
//! use franka_async::nalgebra::{UnitQuaternion, Vector3};
//! use franka_async::pose;
//!
//! let start = pose::from_xyzw([0.4, 0.0, 0.3], [1.0, 0.0, 0.0, 0.0]).expect("a rotation");
//! let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * 0.5);
//! let (position, [x, y, _, _]) = pose::to_xyzw(&pose::rotated(&start, turn));
//! assert_eq!(position, [0.4, 0.0, 0.3]);
//! assert!((2.0 * y.atan2(x) - 0.5).abs() < 1e-12);
//! ```

pub use franka_model::rotation;
pub use franka_model::transform::array as to_array;

use franka_model::transform;
use nalgebra::{Matrix4, Quaternion, Translation3, UnitQuaternion};

use crate::robot::Pose;

/// Reason why a matrix is not a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NotRigid {
    /// A number is not finite.
    #[error("the number in row {row}, column {column} is not finite")]
    NotFinite {
        /// Row of that number, counted from 1.
        row: usize,
        /// Column of that number, counted from 1.
        column: usize,
    },
    /// The transpose is a pose, so the numbers are in row-major order.
    #[error(
        "got the pose row by row, expected it column by column: 0 0 0 1 is in the last column, not in \
         the last row"
    )]
    RowMajor,
    /// The last row is not the last row of a homogeneous matrix.
    #[error("the last row is not 0 0 0 1, so the matrix is not a pose")]
    LastRow,
    /// The upper left block is scaled, sheared or mirrored.
    #[error(
        "the upper left 3x3 block differs from every rotation matrix by more than {}",
        transform::DISTORTION_MAX
    )]
    Rotation,
}

/// Returns the pose nearest to a matrix, for example to a matrix of the model.
///
/// # Errors
/// Returns [`NotRigid`] if the matrix is not a pose. Errors below 1e-3 in the rotation are
/// accepted.
pub fn from_matrix(matrix: &Matrix4<f64>) -> Result<Pose, NotRigid> {
    transform::isometry(matrix).ok_or_else(|| {
        if let Some(index) = matrix.iter().position(|x| !x.is_finite()) {
            let (row, column) = (index % 4 + 1, index / 4 + 1);
            return NotRigid::NotFinite { row, column };
        }
        if transform::isometry(&matrix.transpose()).is_some() {
            return NotRigid::RowMajor;
        }
        match matrix.row(3) == Matrix4::identity().row(3) {
            true => NotRigid::Rotation,
            false => NotRigid::LastRow,
        }
    })
}

/// Returns the pose nearest to 16 numbers in column-major order, as in `O_T_EE`. Apart from that,
/// it is like [`from_matrix`].
///
/// # Errors
/// See [`from_matrix`].
pub fn from_array(column_major: &[f64; 16]) -> Result<Pose, NotRigid> {
    from_matrix(&Matrix4::from_column_slice(column_major))
}

/// Returns the pose with this position, `[m]`, and this quaternion, `[x, y, z, w]`, which is
/// normalised.
///
/// Returns `None` if a number is not finite, or if the quaternion is shorter than 1e-6 and
/// therefore has no direction.
pub fn from_xyzw(position: [f64; 3], [x, y, z, w]: [f64; 4]) -> Option<Pose> {
    let rotation = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), SHORTEST)?;
    let pose = Pose::from_parts(Translation3::from(position), rotation);
    let (position, quaternion) = to_xyzw(&pose);
    let is_finite = position.iter().chain(&quaternion).all(|x| x.is_finite());
    is_finite.then_some(pose)
}

/// Returns the position, `[m]`, and the quaternion, `[x, y, z, w]`, of length 1.
pub fn to_xyzw(pose: &Pose) -> ([f64; 3], [f64; 4]) {
    (pose.translation.vector.into(), pose.rotation.coords.into())
}

/// Returns `pose` rotated in place, by `turn` about the axes of the base. The position does not
/// change.
pub fn rotated(pose: &Pose, turn: UnitQuaternion<f64>) -> Pose {
    Pose::from_parts(pose.translation, turn * pose.rotation)
}

/// Length of a quaternion below which it counts as zero.
const SHORTEST: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use nalgebra::{Vector3, Vector4};

    use super::*;

    #[test]
    fn a_quaternion_is_normalised_and_comes_back() {
        let pose = from_xyzw([0.1, 0.2, 0.3], [0.0, 0.0, 3.0, 4.0]).expect("a pose");
        let (position, quaternion) = to_xyzw(&pose);
        assert_eq!(position, [0.1, 0.2, 0.3]);
        let off = Vector4::from(quaternion) - Vector4::new(0.0, 0.0, 0.6, 0.8);
        assert!(off.amax() < 1e-15, "{quaternion:?}");
    }

    #[test]
    fn invalid_pose_is_refused() {
        let (there, upright) = ([0.1, 0.2, 0.3], [0.0, 0.0, 0.0, 1.0]);
        assert!(from_xyzw(there, upright).is_some());
        assert_eq!(from_xyzw(there, [0.0; 4]), None);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(from_xyzw([0.1, bad, 0.3], upright), None, "{bad}");
            assert_eq!(from_xyzw(there, [0.0, bad, 0.0, 1.0]), None, "{bad}");
        }
    }

    #[test]
    fn an_array_that_is_no_pose_is_refused_for_a_reason() {
        let turn = UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3);
        let pose = Pose::from_parts([0.4, 0.1, 0.3].into(), turn);
        let good = to_array(&pose);
        assert!(
            (from_array(&good).unwrap().to_homogeneous() - pose.to_homogeneous()).amax() < 1e-12
        );
        let with = |index: usize, value| {
            let mut numbers = good;
            numbers[index] = value;
            from_array(&numbers).unwrap_err()
        };
        assert_eq!(with(6, f64::NAN), NotRigid::NotFinite { row: 3, column: 2 });
        assert_eq!(with(15, 2.0), NotRigid::LastRow);
        assert_eq!(with(0, 2.0), NotRigid::Rotation);
        assert_eq!(from_array(&[0.0; 16]), Err(NotRigid::LastRow));
        let by_rows = std::array::from_fn(|i| good[i % 4 * 4 + i / 4]);
        assert_eq!(from_array(&by_rows), Err(NotRigid::RowMajor));
    }

    #[test]
    fn a_turn_is_about_axes_of_the_base_and_keeps_the_position() {
        let about = |axis: Vector3<f64>| UnitQuaternion::from_scaled_axis(axis);
        let start = Pose::from_parts([0.4, 0.1, 0.3].into(), about(Vector3::x() * 1.0));
        let turned = rotated(&start, about(Vector3::z() * 0.5));
        assert_eq!(turned.translation, start.translation);
        // The x axis of the pose is the x axis of the base, so it turns in the plane.
        let x = turned * Vector3::x();
        assert!((x - Vector3::new(0.5_f64.cos(), 0.5_f64.sin(), 0.0)).norm() < 1e-12);
    }
}

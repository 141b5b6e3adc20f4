//! Checks that the numbers of a command are finite, and that a pose or an elbow is valid.

use crate::shaping::InvalidCommand;

/// Largest deviation from 1 of the norm of a row or column of a rotation (libfranka 0.21,
/// `kOrthonormalThreshold`).
pub const ORTHONORMAL_TOLERANCE: f64 = 1e-5;

/// Checks that all values are finite.
///
/// # Errors
/// Returns [`InvalidCommand::NotFinite`] if a value is infinite or NaN.
pub fn finite(values: &[f64]) -> Result<(), InvalidCommand> {
    if all_finite(values) {
        Ok(())
    } else {
        Err(InvalidCommand::NotFinite)
    }
}

/// Checks that an array is a pose in column-major order.
///
/// # Errors
/// Returns [`InvalidCommand::NotFinite`] or [`InvalidCommand::Transformation`] if the array is not
/// such a pose.
pub fn pose(column_major: &[f64; 16]) -> Result<(), InvalidCommand> {
    finite(column_major)?;
    if is_homogeneous(column_major) {
        Ok(())
    } else {
        Err(InvalidCommand::Transformation)
    }
}

/// Checks that an elbow consists of an angle of joint 3, `[rad]`, and a sign of joint 4, plus or
/// minus 1.
///
/// # Errors
/// Returns [`InvalidCommand::NotFinite`] or [`InvalidCommand::ElbowSign`] if the elbow is invalid.
pub fn elbow(elbow: &[f64; 2]) -> Result<(), InvalidCommand> {
    finite(elbow)?;
    if elbow[1] == 1.0 || elbow[1] == -1.0 {
        Ok(())
    } else {
        Err(InvalidCommand::ElbowSign)
    }
}

/// True if a 4x4 matrix in column-major order counts as a transformation. Its last row must be
/// exactly `0 0 0 1`, and each row and column of its rotation must have length 1 within
/// [`ORTHONORMAL_TOLERANCE`].
///
/// As in libfranka, neither the angles between the columns nor the handedness are checked, so a
/// mirrored matrix passes.
pub fn is_homogeneous(column_major: &[f64; 16]) -> bool {
    let m = column_major;
    let square = |x: f64, y: f64, z: f64| (x * x + y * y) + z * z;
    let squares = [
        square(m[0], m[1], m[2]),
        square(m[4], m[5], m[6]),
        square(m[8], m[9], m[10]),
        square(m[0], m[4], m[8]),
        square(m[1], m[5], m[9]),
        square(m[2], m[6], m[10]),
    ];
    let unit = |square: f64| (square.sqrt() - 1.0).abs() <= ORTHONORMAL_TOLERANCE;
    // If the square is this close to 1, its root is within the tolerance. So nearly every pose
    // needs no root.
    let near = |square: f64| (square - 1.0).abs() <= 1.9 * ORTHONORMAL_TOLERANCE;
    [m[3], m[7], m[11], m[15]] == [0.0, 0.0, 0.0, 1.0]
        && (squares.map(near) == [true; 6] || squares.into_iter().all(unit))
}

pub(super) fn all_finite(values: &[f64]) -> bool {
    values.iter().all(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    const IDENTITY: [f64; 16] = [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.3, 0.2, 0.1, 1.0,
    ];

    fn with(index: usize, value: f64) -> [f64; 16] {
        let mut m = IDENTITY;
        m[index] = value;
        m
    }

    #[test]
    fn a_matrix_in_row_major_order_is_no_pose() {
        let transposed = core::array::from_fn(|i| IDENTITY[i % 4 * 4 + i / 4]);
        assert_eq!(pose(&IDENTITY), Ok(()));
        assert_eq!(pose(&transposed), Err(InvalidCommand::Transformation));
    }

    #[test]
    fn lengths_count_and_handedness_does_not() {
        assert!(is_homogeneous(&with(0, -1.0)));
        assert!(is_homogeneous(&with(0, 1.0 + 0.9e-5)));
        assert!(is_homogeneous(&with(0, 1.0 - 0.999e-5)));
        assert!(!is_homogeneous(&with(0, 1.0 + 1.1e-5)));
        assert!(!is_homogeneous(&with(15, 1.0 + f64::EPSILON)));
        assert!(!is_homogeneous(&with(5, 1e200)));
        assert!(!is_homogeneous(&with(5, f64::NAN)));
    }

    #[test]
    fn non_finite_numbers_are_named_first() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(pose(&with(3, value)), Err(InvalidCommand::NotFinite));
            assert_eq!(elbow(&[0.1, value]), Err(InvalidCommand::NotFinite));
            assert_eq!(elbow(&[value, 0.5]), Err(InvalidCommand::NotFinite));
        }
    }

    #[test]
    fn an_elbow_has_a_sign() {
        for sign in [1.0, -1.0] {
            assert_eq!(elbow(&[0.1, sign]), Ok(()));
        }
        for sign in [0.0, -0.0, 0.999_999, 2.0] {
            assert_eq!(elbow(&[0.1, sign]), Err(InvalidCommand::ElbowSign));
        }
    }
}

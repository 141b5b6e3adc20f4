//! Conversions between homogeneous matrices and isometries.
//!
//! The robot's matrices are column-major, may come from `f32` fields, and are not always exactly
//! rigid. For example, a pose with the vendor's 0.7071 for sqrt(1/2) deviates by 1e-5. The
//! conversion replaces the rotation block by the nearest rotation in the least-squares sense (the
//! polar factor).

use nalgebra::{Isometry3, Matrix3, Matrix4, Rotation3, Translation3, UnitQuaternion};

/// Largest deviation of an element of a rotation block from the nearest rotation.
///
/// The bound is a hundred times the deviation of the vendor's rounded constants. A transposed or
/// sheared matrix deviates far more.
pub const DISTORTION_MAX: f64 = 1e-3;

/// Returns the rigid transform nearest to `matrix`.
///
/// Returns `None` if an element is not finite, or if the last row is not `0 0 0 1`. Also returns
/// `None` if the rotation block deviates by more than `DISTORTION_MAX` (1e-3) from every rotation.
pub fn isometry(matrix: &Matrix4<f64>) -> Option<Isometry3<f64>> {
    let last_row = [matrix.m41, matrix.m42, matrix.m43, matrix.m44];
    if last_row != [0.0, 0.0, 0.0, 1.0] {
        return None;
    }
    let block = matrix.fixed_view::<3, 3>(0, 0).into_owned();
    let translation = Translation3::new(matrix.m14, matrix.m24, matrix.m34);
    let rotation = nearest_rotation(&block)?;
    let rigid = (rotation.matrix() - block).amax() <= DISTORTION_MAX;
    let finite = translation.vector.iter().all(|x| x.is_finite());
    (rigid && finite).then(|| {
        Isometry3::from_parts(translation, UnitQuaternion::from_rotation_matrix(&rotation))
    })
}

/// Returns the rigid transform nearest to a column-major matrix, such as `O_T_EE`; see
/// [`isometry`].
pub fn isometry_from_array(column_major: &[f64; 16]) -> Option<Isometry3<f64>> {
    isometry(&Matrix4::from_column_slice(column_major))
}

/// Returns the homogeneous matrix of a rigid transform.
pub fn matrix(isometry: &Isometry3<f64>) -> Matrix4<f64> {
    isometry.to_homogeneous()
}

/// Returns the column-major matrix of a rigid transform, in the format of `O_T_EE_c`.
pub fn array(isometry: &Isometry3<f64>) -> [f64; 16] {
    let mut column_major = [0.0; 16];
    column_major.copy_from_slice(matrix(isometry).as_slice());
    column_major
}

/// Returns the rotation part of the polar decomposition, by Newton's iteration `X <- (X + X⁻ᵀ) /
/// 2`.
///
/// The iteration converges for every matrix with a positive determinant, quadratically near a
/// rotation (Higham, Functions of Matrices, 2008, section 8.3). Returns `None` for other matrices,
/// and if 20 steps are not enough. Only almost singular matrices need more.
pub fn nearest_rotation(block: &Matrix3<f64>) -> Option<Rotation3<f64>> {
    let determinant = block.determinant();
    if determinant.is_nan() || determinant <= 0.0 {
        return None;
    }
    let mut x = *block;
    for _ in 0..NEWTON_STEPS_MAX {
        let next = (x + x.try_inverse()?.transpose()) * 0.5;
        let change = (next - x).amax();
        x = next;
        if change < 1e-9 {
            // Convergence is quadratic, so another step would change less than one unit in the
            // last place.
            return Some(Rotation3::from_matrix_unchecked(x));
        }
    }
    None
}

const NEWTON_STEPS_MAX: usize = 20;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::rotation;
    use nalgebra::Vector3;

    fn pose(random: &mut Random) -> Isometry3<f64> {
        let translation = Translation3::from(random.vector3(1.0));
        Isometry3::from_parts(translation, rotation::exp(&random.vector3(3.0)))
    }

    #[test]
    fn arrays_and_isometries_convert_both_ways() {
        let mut random = Random::new(1);
        for _ in 0..1000 {
            let original = pose(&mut random);
            let back = isometry_from_array(&array(&original)).expect("a pose");
            assert!((matrix(&back) - matrix(&original)).amax() < 2e-15);
        }
    }

    #[test]
    fn the_vendors_rounded_hand_frame_gives_an_eighth_of_a_turn() {
        let r = (core::f64::consts::FRAC_1_SQRT_2 * 1e4).floor() / 1e4;
        let mut m = Matrix4::identity();
        (m.m11, m.m12, m.m21, m.m22) = (r, r, -r, r);
        let angle = rotation::log(&isometry(&m).expect("a pose").rotation);
        let expected = Vector3::new(0.0, 0.0, -core::f64::consts::FRAC_PI_4);
        assert!((angle - expected).amax() < 1e-15);
    }

    #[test]
    fn nearest_rotation_is_the_orthogonal_factor_of_the_svd() {
        let mut random = Random::new(2);
        for _ in 0..1000 {
            let noise = Matrix3::from_fn(|_, _| random.uniform(-0.3, 0.3));
            let block = pose(&mut random).rotation.to_rotation_matrix().matrix() + noise;
            let svd = block.svd(true, true);
            let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
                panic!("both factors were asked for")
            };
            match nearest_rotation(&block) {
                Some(rotation) => assert!((rotation.matrix() - u * v_t).amax() < 1e-12),
                None => assert!(block.determinant() <= 0.0),
            }
        }
    }

    #[test]
    fn invalid_pose_is_refused() {
        let good = pose(&mut Random::new(3));
        assert!(isometry(&matrix(&good)).is_some());
        assert!(isometry(&matrix(&good).transpose()).is_none());
        assert!(isometry(&Matrix4::zeros()).is_none());
        let mirrored = Matrix4::new_nonuniform_scaling(&Vector3::new(1.0, 1.0, -1.0));
        assert!(isometry(&mirrored).is_none());
        let scaled = Matrix4::new_nonuniform_scaling(&Vector3::new(1.0, 1.0, 1.01));
        assert!(isometry(&scaled).is_none());
        for index in 0..16 {
            for bad in [f64::NAN, f64::INFINITY] {
                let mut numbers = array(&good);
                numbers[index] = bad;
                assert!(isometry_from_array(&numbers).is_none(), "element {index}");
            }
        }
    }
}

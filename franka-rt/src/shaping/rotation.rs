//! Rotations inside the column-major poses of commands and states.

use nalgebra::{Matrix3, Matrix4, Quaternion, SymmetricEigen, UnitQuaternion, Vector3};

/// The translation of a pose, `[m]`.
pub(super) fn translation(pose: &[f64; 16]) -> Vector3<f64> {
    Vector3::new(pose[12], pose[13], pose[14])
}

/// The rotation nearest to the upper left block of a pose, which may be rounded to `f32`.
///
/// That is the orthogonal factor of its polar decomposition, turned where the block is mirrored. Any finite block gives a
/// rotation; NaN if an element is not finite.
pub(super) fn nearest_rotation(pose: &[f64; 16]) -> Matrix3<f64> {
    let m = pose;
    let block = Matrix3::new(m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]);
    polished(block).unwrap_or_else(|| procrustes(&block))
}

/// A pose of a rotation and a translation with the last row given.
pub(super) fn pose(
    rotation: &Matrix3<f64>,
    translation: &Vector3<f64>,
    last_row: [f64; 4],
) -> [f64; 16] {
    core::array::from_fn(|i| match (i % 4, i / 4) {
        (3, column) => last_row[column],
        (row, 3) => translation[row],
        (row, column) => rotation[(row, column)],
    })
}

/// The quaternion of a rotation matrix.
pub(super) fn quaternion(rotation: &Matrix3<f64>) -> UnitQuaternion<f64> {
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(*rotation);
    UnitQuaternion::from_rotation_matrix(&rotation)
}

/// The way from `from` to `to` by the share `t`, along the shorter arc.
pub(super) fn slerp(
    from: &UnitQuaternion<f64>,
    to: &UnitQuaternion<f64>,
    t: f64,
) -> UnitQuaternion<f64> {
    let cosine = from.coords.dot(&to.coords);
    let (of_from, of_to) = if cosine.abs() >= 1.0 - f64::EPSILON {
        (1.0 - t, t)
    } else {
        let angle = cosine.abs().acos();
        let sine = angle.sin();
        (((1.0 - t) * angle).sin() / sine, (t * angle).sin() / sine)
    };
    let of_to = if cosine < 0.0 { -of_to } else { of_to };
    let sum = from.coords * of_from + to.coords * of_to;
    UnitQuaternion::new_normalize(Quaternion::from(sum))
}

/// The rotation about `axis`, of length 1, by `angle` radians (Rodrigues).
pub(super) fn about(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let k = axis.cross_matrix();
    let (sine, cosine) = angle.sin_cos();
    Matrix3::identity() + k * sine + k * k * (1.0 - cosine)
}

/// The nearest rotation by Newton and Schulz's iteration `X <- X - X (X'X - 1) / 2`, whose error squares with each step.
/// `None` where the block is not close to a rotation.
fn polished(block: Matrix3<f64>) -> Option<Matrix3<f64>> {
    let mut x = block;
    for _ in 0..POLISH_STEPS_MAX {
        let error = x.tr_mul(&x) - Matrix3::identity();
        // False for NaN, which `amax` may drop.
        let within = |bound: f64| error.iter().all(|x| x.abs() <= bound);
        if !within(POLISH_BELOW) || x.determinant() <= 0.0 {
            return None;
        }
        if within(ROUNDING) {
            return Some(x);
        }
        x -= x * error * 0.5;
        if within(SQUARES_AWAY) {
            return Some(x);
        }
    }
    None
}

/// The rotation that maximises `tr(R'M)`, which is the nearest one: the eigenvector of the largest eigenvalue of a
/// symmetric matrix, read as a quaternion (Horn, J. Opt. Soc. Am. A 4, 1987, section 4).
#[cold]
fn procrustes(block: &Matrix3<f64>) -> Matrix3<f64> {
    let not_a_number = Matrix3::repeat(f64::NAN);
    if !block.iter().all(|x| x.is_finite()) {
        return not_a_number;
    }
    let size = block.amax();
    if size == 0.0 {
        return Matrix3::identity();
    }
    let m = block / size;
    let trace = m.trace();
    let skew = Vector3::new(
        m[(2, 1)] - m[(1, 2)],
        m[(0, 2)] - m[(2, 0)],
        m[(1, 0)] - m[(0, 1)],
    );
    let mut k = Matrix4::zeros();
    k[(0, 0)] = trace;
    k.fixed_view_mut::<3, 1>(1, 0).copy_from(&skew);
    k.fixed_view_mut::<1, 3>(0, 1).copy_from(&skew.transpose());
    k.fixed_view_mut::<3, 3>(1, 1)
        .copy_from(&(m + m.transpose() - Matrix3::identity() * trace));
    let Some(eigen) = SymmetricEigen::try_new(k, f64::EPSILON, EIGEN_STEPS_MAX) else {
        return not_a_number;
    };
    let q = eigen.eigenvectors.column(eigen.eigenvalues.imax());
    let q = Quaternion::new(q[0], q[1], q[2], q[3]);
    UnitQuaternion::new_normalize(q)
        .to_rotation_matrix()
        .into_inner()
}

/// Where the iteration is used: within this of orthogonal it converges in five steps.
const POLISH_BELOW: f64 = 0.1;
const POLISH_STEPS_MAX: usize = 6;
/// What is this close to orthogonal is as close after one more step as rounding allows.
const SQUARES_AWAY: f64 = 1e-8;
/// What products of rotations are off by.
const ROUNDING: f64 = 2.0 * f64::EPSILON;
/// Far more than a symmetric 4x4 matrix takes.
const EIGEN_STEPS_MAX: usize = 200;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn block() -> impl Strategy<Value = Matrix3<f64>> {
        prop::array::uniform9(-1.0..1.0).prop_map(|m| Matrix3::from_column_slice(&m))
    }

    fn rotation() -> impl Strategy<Value = Matrix3<f64>> {
        prop::array::uniform3(-3.0..3.0)
            .prop_map(|v| UnitQuaternion::from_scaled_axis(Vector3::from(v)))
            .prop_map(|q| q.to_rotation_matrix().into_inner())
    }

    fn nearest(block: &Matrix3<f64>) -> Matrix3<f64> {
        nearest_rotation(&pose(block, &Vector3::zeros(), [0.0, 0.0, 0.0, 1.0]))
    }

    fn is_rotation(r: &Matrix3<f64>) -> bool {
        (r.tr_mul(r) - Matrix3::identity()).amax() < 4e-15 && r.determinant() > 0.0
    }

    /// `U V'` of the singular value decomposition, the last singular direction turned to make it a rotation.
    fn by_singular_values(m: &Matrix3<f64>) -> Matrix3<f64> {
        let svd = m.svd(true, true);
        let (Some(mut u), Some(v_t)) = (svd.u, svd.v_t) else {
            panic!("both factors were asked for")
        };
        if (u * v_t).determinant() < 0.0 {
            let smallest = svd.singular_values.imin();
            u.column_mut(smallest).neg_mut();
        }
        u * v_t
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

        #[test]
        fn the_nearest_rotation_is_the_factor_of_the_singular_value_decomposition(m in block()) {
            let mut singular = m.singular_values();
            singular.as_mut_slice().sort_by(f64::total_cmp);
            let (least, middle) = (singular[0], singular[1]);
            // The result is as well determined as the two smallest singular values are apart from opposite.
            let gap = if m.determinant() > 0.0 { middle + least } else { middle - least };
            prop_assume!(gap > 1e-3);
            prop_assert!(is_rotation(&nearest(&m)));
            prop_assert!((nearest(&m) - by_singular_values(&m)).amax() < 1e-14 / gap);
        }

        #[test]
        fn a_rotation_is_its_own_nearest_and_one_rounded_to_f32_nearly(r in rotation()) {
            prop_assert!((nearest(&r) - r).amax() < 2e-15);
            let rounded = r.map(|x| f64::from(x as f32));
            prop_assert!(is_rotation(&nearest(&rounded)));
            prop_assert!((nearest(&rounded) - by_singular_values(&rounded)).amax() < 2e-15);
        }

        #[test]
        fn what_is_not_close_and_what_is_give_the_same(r in rotation(), noise in block()) {
            let m = r + noise * 0.01;
            let polished = polished(m).expect("close to a rotation");
            prop_assert!((polished - procrustes(&m)).amax() < 4e-15);
        }
    }

    #[test]
    fn any_finite_block_gives_a_rotation() {
        let flat = Matrix3::repeat(1.0 / 3.0_f64.sqrt());
        let mirrored = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
        for block in [
            Matrix3::zeros(),
            flat,
            mirrored,
            -Matrix3::identity(),
            Matrix3::repeat(1e300),
            mirrored * 1e-300,
            mirrored * 5e-324,
            Matrix3::identity() * f64::MAX,
        ] {
            assert!(is_rotation(&nearest(&block)), "{block}");
        }
    }

    #[test]
    fn a_block_that_is_not_finite_gives_nan() {
        for bad in [f64::NAN, f64::INFINITY] {
            for index in 0..9 {
                let mut block = Matrix3::identity();
                block[index] = bad;
                assert!(nearest(&block).iter().all(|x| x.is_nan()));
            }
        }
    }

    #[test]
    fn the_way_between_orientations_is_the_short_one_at_even_speed() {
        let axis = Vector3::z_axis();
        for (angle, t) in [(1.0, 0.25), (3.1, 0.5), (1e-9, 0.386), (0.0, 0.3)] {
            let to = UnitQuaternion::from_axis_angle(&axis, angle);
            for to in [to, UnitQuaternion::new_unchecked(-to.into_inner())] {
                let between = slerp(&UnitQuaternion::identity(), &to, t);
                let expected = UnitQuaternion::from_axis_angle(&axis, angle * t);
                assert!((between.coords - expected.coords).amax() < 4e-16, "{angle}");
            }
        }
    }
}

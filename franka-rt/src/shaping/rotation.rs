//! Rotations inside the column-major poses of commands and states.

use nalgebra::{Matrix3, Matrix4, Quaternion, SymmetricEigen, UnitQuaternion, Vector3};

/// A pose with an orthogonal rotation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rigid {
    pub(crate) rotation: Matrix3<f64>,
    /// The rotation as a quaternion.
    pub(crate) orientation: UnitQuaternion<f64>,
    /// Translation, `[m]`.
    pub(crate) translation: Vector3<f64>,
    /// Last row of the homogeneous matrix; `0 0 0 1` for a pose.
    pub(crate) last_row: [f64; 4],
}

impl Rigid {
    /// Returns a column-major pose, which may be rounded to `f32`, with the [`nearest_rotation`].
    pub(crate) fn nearest(pose: &[f64; 16]) -> Self {
        let m = pose;
        let block = Matrix3::new(m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]);
        let rotation = nearest_rotation(&block);
        Self {
            rotation,
            orientation: quaternion(&rotation),
            translation: Vector3::new(m[12], m[13], m[14]),
            last_row: [m[3], m[7], m[11], m[15]],
        }
    }

    /// Returns the column-major pose.
    pub(crate) fn pose(&self) -> [f64; 16] {
        pose(&self.rotation, &self.translation, self.last_row)
    }
}

/// Returns the column-major pose with these parts.
pub(crate) fn pose(
    rotation: &Matrix3<f64>,
    translation: &Vector3<f64>,
    last_row: [f64; 4],
) -> [f64; 16] {
    let (r, t) = (rotation, translation);
    let [e, f, g, h] = last_row;
    [
        r.m11, r.m21, r.m31, e, r.m12, r.m22, r.m32, f, r.m13, r.m23, r.m33, g, t.x, t.y, t.z, h,
    ]
}

/// Returns the rotation nearest to a matrix: the orthogonal factor of its polar decomposition, or
/// the nearest proper rotation if that factor is a reflection.
///
/// Every finite matrix has a result. If an element is not finite, the result is NaN.
fn nearest_rotation(block: &Matrix3<f64>) -> Matrix3<f64> {
    polished(*block).unwrap_or_else(|| procrustes(block))
}

/// Returns the quaternion of a rotation matrix.
fn quaternion(rotation: &Matrix3<f64>) -> UnitQuaternion<f64> {
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(*rotation);
    UnitQuaternion::from_rotation_matrix(&rotation)
}

/// Returns the rotation at the share `t` of the shorter arc between `from` and `to`.
pub(crate) fn slerp(
    from: &UnitQuaternion<f64>,
    to: &UnitQuaternion<f64>,
    t: f64,
) -> UnitQuaternion<f64> {
    let signed = from.coords.dot(&to.coords);
    let cosine = signed.abs();
    let (of_from, of_to) = if cosine >= 1.0 - f64::EPSILON {
        (1.0 - t, t)
    } else {
        let angle = cosine.acos();
        let sine = ((1.0 - cosine) * (1.0 + cosine)).sqrt();
        (((1.0 - t) * angle).sin() / sine, (t * angle).sin() / sine)
    };
    let of_to = if signed < 0.0 { -of_to } else { of_to };
    let sum = from.coords * of_from + to.coords * of_to;
    // Its length is 1 except for rounding. So this Newton step is as accurate as a division by the
    // root.
    let sum = sum * (1.5 - 0.5 * sum.norm_squared());
    UnitQuaternion::new_unchecked(Quaternion::from(sum))
}

/// Returns the rotation by `angle` radians about `axis`, which has length 1 (Rodrigues).
pub(crate) fn about(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let (sine, cosine) = angle.sin_cos();
    let (along, across) = (axis * (1.0 - cosine), axis * sine);
    let beside = |i: usize, j: usize| along[i] * axis[j];
    let (xy, yz, zx) = (beside(0, 1), beside(1, 2), beside(2, 0));
    Matrix3::new(
        beside(0, 0) + cosine,
        xy - across.z,
        zx + across.y,
        xy + across.z,
        beside(1, 1) + cosine,
        yz - across.x,
        zx - across.y,
        yz + across.x,
        beside(2, 2) + cosine,
    )
}

/// Returns the nearest rotation, by iterating `X <- X (1 - E / 2 + 3 E^2 / 8)` with `E = X'X - 1`.
/// The factor is the start of the series of `(X'X)^(-1/2)`; each step cubes the error. `None` if
/// the block is not close to a rotation.
fn polished(block: Matrix3<f64>) -> Option<Matrix3<f64>> {
    if block.determinant() <= 0.0 {
        return None;
    }
    let mut x: [Vector3<f64>; 3] = core::array::from_fn(|i| block.column(i).into_owned());
    for _ in 0..POLISH_STEPS_MAX {
        let error = Symmetric {
            diagonal: core::array::from_fn(|i| x[i].norm_squared() - 1.0),
            beside: [x[1].dot(&x[2]), x[2].dot(&x[0]), x[0].dot(&x[1])],
        };
        let size = error.size();
        if size.is_nan() || size > POLISH_BELOW {
            return None;
        }
        if size <= ROUNDING {
            return Some(Matrix3::from_columns(&x));
        }
        let [correction_x, correction_y, correction_z] = error.correction();
        let [a, b, c] = x;
        let corrected = |s: [f64; 3], own: Vector3<f64>| own - (a * s[0] + b * s[1] + c * s[2]);
        x = [
            corrected(correction_x, a),
            corrected(correction_y, b),
            corrected(correction_z, c),
        ];
        if size <= CUBES_AWAY {
            return Some(Matrix3::from_columns(&x));
        }
    }
    None
}

/// A symmetric 3x3 matrix.
struct Symmetric {
    diagonal: [f64; 3],
    /// Elements yz, zx and xy.
    beside: [f64; 3],
}

impl Symmetric {
    /// Returns the sum of the absolute values of all elements. Unlike the maximum, it keeps a NaN.
    fn size(&self) -> f64 {
        let sum = |x: &[f64; 3]| x[0].abs() + x[1].abs() + x[2].abs();
        sum(&self.diagonal) + 2.0 * sum(&self.beside)
    }

    /// Returns the columns of `E / 2 - 3 E^2 / 8`.
    fn correction(&self) -> [[f64; 3]; 3] {
        let ([xx, yy, zz], [yz, zx, xy]) = (self.diagonal, self.beside);
        let rows = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
        let element = |i: usize, j: usize| {
            let (a, b) = (rows[i], rows[j]);
            let square = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            0.5 * a[j] - 0.375 * square
        };
        let (xy, yz, zx) = (element(0, 1), element(1, 2), element(2, 0));
        [
            [element(0, 0), xy, zx],
            [xy, element(1, 1), yz],
            [zx, yz, element(2, 2)],
        ]
    }
}

/// Returns the rotation that maximises `tr(R'M)`, which is the nearest rotation. As a quaternion,
/// it is the eigenvector of the largest eigenvalue of a symmetric matrix. Source: Horn, J. Opt.
/// Soc. Am. A 4, 1987, section 4.
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

/// Largest sum of the absolute values of `E` for which three steps of the series are enough.
const POLISH_BELOW: f64 = 0.3;
const POLISH_STEPS_MAX: usize = 4;
/// Deviation from orthogonality below which one more step is exact up to rounding. Rotations
/// rounded to `f32` are below it.
const CUBES_AWAY: f64 = 5e-6;
/// Rounding error of products of rotations.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Maximum number of steps, far more than a symmetric 4x4 matrix needs.
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
        Rigid::nearest(&pose(block, &Vector3::zeros(), [0.0, 0.0, 0.0, 1.0])).rotation
    }

    fn is_rotation(r: &Matrix3<f64>) -> bool {
        (r.tr_mul(r) - Matrix3::identity()).amax() < 4e-15 && r.determinant() > 0.0
    }

    /// Returns `U V'` of the singular value decomposition. The last singular direction is flipped
    /// if that makes the result a rotation.
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
        fn nearest_rotation_is_the_factor_of_the_svd(m in block()) {
            let mut singular = m.singular_values();
            singular.as_mut_slice().sort_by(f64::total_cmp);
            let (least, middle) = (singular[0], singular[1]);
            // The result is well determined if the two smallest singular values are far from
            // opposite.
            let gap = if m.determinant() > 0.0 { middle + least } else { middle - least };
            prop_assume!(gap > 1e-3);
            prop_assert!(is_rotation(&nearest(&m)));
            prop_assert!((nearest(&m) - by_singular_values(&m)).amax() < 1e-13 / gap);
        }

        #[test]
        fn a_rotation_is_its_own_nearest_and_one_rounded_to_f32_nearly(r in rotation()) {
            prop_assert!((nearest(&r) - r).amax() < 2e-15);
            let rounded = r.map(|x| f64::from(x as f32));
            prop_assert!(is_rotation(&nearest(&rounded)));
            prop_assert!((nearest(&rounded) - by_singular_values(&rounded)).amax() < 2e-15);
        }

        #[test]
        fn polishing_and_procrustes_give_the_same_rotation(r in rotation(), noise in block()) {
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
    fn a_turn_about_an_axis_is_its_exponential() {
        let axis = Vector3::new(0.36, -0.48, 0.8);
        for angle in [0.0, 1e-9, 2.5e-3, 1.0, -3.0] {
            let expected = UnitQuaternion::from_scaled_axis(axis * angle).to_rotation_matrix();
            assert!((about(&axis, angle) - expected.matrix()).amax() < 4e-16);
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

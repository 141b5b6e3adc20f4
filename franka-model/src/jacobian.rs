//! Poses and Jacobians of the frames.

use nalgebra::{Matrix3, Matrix4, Vector3};

use crate::chain::Chain;
use crate::frame::{EndEffector, Frame};
use crate::geometry::SHOULDER;
use crate::inertia::cross;
use crate::ldl::Ldl;
use crate::scalar::sqrt;
use crate::{Jacobian, JointVector};

/// Rotation block and origin of a frame, in base axes and relative to the shoulder.
pub(crate) struct Placement {
    pub(crate) rotation: Matrix3<f64>,
    pub(crate) origin: Vector3<f64>,
}

impl Placement {
    #[inline(always)]
    pub(crate) fn of(chain: &Chain, frame: Frame, ee: &EndEffector) -> Self {
        let flange = || Self {
            rotation: chain.rotation[6],
            origin: chain.flange(),
        };
        match frame {
            Frame::Flange => flange(),
            Frame::EndEffector => flange().times(&ee.f_t_ee),
            Frame::Stiffness => flange().times(&ee.f_t_ee).times(&ee.ee_t_k),
            joint => {
                let index = joint.joints() - 1;
                Self {
                    rotation: chain.rotation[index],
                    origin: chain.origin[index],
                }
            }
        }
    }

    /// Returns the homogeneous matrix in the base frame.
    #[inline(always)]
    pub(crate) fn pose(&self) -> Matrix4<f64> {
        let (r, p) = (&self.rotation, &self.origin);
        Matrix4::new(
            r.m11,
            r.m12,
            r.m13,
            p.x, //
            r.m21,
            r.m22,
            r.m23,
            p.y, //
            r.m31,
            r.m32,
            r.m33,
            p.z + SHOULDER, //
            0.0,
            0.0,
            0.0,
            1.0,
        )
    }

    #[inline(always)]
    fn times(&self, transform: &Matrix4<f64>) -> Self {
        let t = transform;
        let r = &self.rotation;
        let column =
            |j: usize| r.column(0) * t[(0, j)] + r.column(1) * t[(1, j)] + r.column(2) * t[(2, j)];
        Self {
            rotation: Matrix3::from_columns(&[column(0), column(1), column(2)]),
            origin: self.origin + column(3),
        }
    }
}

/// Returns the Jacobian of a point that moves with the first `joints` joints, in base axes.
#[inline(always)]
pub(crate) fn zero_jacobian(chain: &Chain, joints: usize, point: &Vector3<f64>) -> Jacobian {
    let mut jacobian = Jacobian::zeros();
    for i in 0..joints {
        let axis = &chain.axis[i];
        let linear = cross(axis, point) + chain.moment[i];
        let mut column = jacobian.column_mut(i);
        column[0] = linear.x;
        column[1] = linear.y;
        column[2] = linear.z;
        column[3] = axis.x;
        column[4] = axis.y;
        column[5] = axis.z;
    }
    jacobian
}

/// Returns the speed of the fastest of the origins of the joint frames, the flange and the end
/// effector.
pub(crate) fn fastest_point(chain: &Chain, dq: &JointVector, ee: &EndEffector) -> f64 {
    let (mut turning, mut moment) = (Vector3::zeros(), Vector3::zeros());
    let squared_speed = |turning: &Vector3<f64>, moment: &Vector3<f64>, point: &Vector3<f64>| {
        (cross(turning, point) + moment).norm_squared()
    };
    let mut fastest = 0.0_f64;
    for i in 0..7 {
        turning += chain.axis[i] * dq[i];
        moment += chain.moment[i] * dq[i];
        fastest = squared_speed(&turning, &moment, &chain.origin[i]).max(fastest);
    }
    for frame in [Frame::Flange, Frame::EndEffector] {
        let point = Placement::of(chain, frame, ee).origin;
        fastest = squared_speed(&turning, &moment, &point).max(fastest);
    }
    sqrt(fastest)
}

/// Returns the Jacobian in the frame's own axes.
pub(crate) fn body_jacobian(zero: &Jacobian, rotation: &Matrix3<f64>) -> Jacobian {
    let mut body = *zero;
    for mut column in body.column_iter_mut() {
        let linear = rotation.tr_mul(&column.fixed_rows::<3>(0));
        let angular = rotation.tr_mul(&column.fixed_rows::<3>(3));
        column.fixed_rows_mut::<3>(0).copy_from(&linear);
        column.fixed_rows_mut::<3>(3).copy_from(&angular);
    }
    body
}

/// Returns Yoshikawa's manipulability `sqrt(det(J Jᵀ))`. It is zero in a singularity, and the same
/// for every point of the last link.
///
/// The unit mixes metres and radians, because the Jacobian contains both. The value at the ready
/// pose is 0.080.
pub fn manipulability(jacobian: &Jacobian) -> f64 {
    sqrt(squared_manipulability(jacobian))
}

/// Returns `det(J Jᵀ)`, or zero if rounding makes the matrix indefinite.
pub(crate) fn squared_manipulability(jacobian: &Jacobian) -> f64 {
    squared_manipulabilities(jacobian)[1]
}

/// Returns `det(J Jᵀ)` for the first three rows of `J`, and for all rows.
pub(crate) fn squared_manipulabilities(jacobian: &Jacobian) -> [f64; 2] {
    let mut gram = [[0.0; 6]; 6];
    for column in &jacobian.data.0 {
        for i in 0..6 {
            for j in 0..=i {
                gram[i][j] += column[i] * column[j];
            }
        }
    }
    let [_, _, position, _, _, pose] = Ldl::leading_minors(&gram);
    [position, pose]
}

#[cfg(test)]
mod tests {
    use nalgebra::{Isometry3, Translation3};

    use crate::random::Random;
    use crate::{EndEffector, Frame, JointVector, Model};

    #[test]
    fn the_fastest_point_is_that_of_the_jacobians() {
        let mut random = Random::new(72);
        let model = Model::fr3();
        let ee = EndEffector {
            f_t_ee: Isometry3::from(Translation3::new(0.1, -0.2, 0.3)).to_homogeneous(),
            ..EndEffector::default()
        };
        for case in 0..100 {
            let (q, mut dq) = (random.posture(model), random.posture(model));
            if case % 2 == 0 {
                // The elbow is the fastest point.
                dq = JointVector::from([dq[0], dq[1], dq[2], 0.0, 0.0, 0.0, 0.0]);
            }
            let speed = |frame: &Frame| {
                let twist = model.zero_jacobian(*frame, &q, &ee) * dq;
                twist.fixed_rows::<3>(0).norm()
            };
            let fastest = Frame::ALL[..9].iter().map(speed).fold(0.0, f64::max);
            let got = model.fastest_point(&q, &dq, &ee);
            assert!((got - fastest).abs() < 1e-12, "{got}, {fastest}");
        }
    }
}

//! Rotation vectors, which describe orientations by three numbers, and their derivatives.
//!
//! A rotation vector `phi` is the axis times the angle. On a path of orientations `R(t) =
//! exp(phi(t)) R0` with constant `R0`, the angular velocity and acceleration in base axes are
//!
//! ```text
//! omega = J(phi) phi'                 J: left Jacobian of SO(3)
//! alpha = J(phi) phi'' + J'(phi) phi'
//! ```
//!
//! With `K = [phi]×` and `x = |phi|²`, `J = 1 + c2 K + c3 K²`, where the functions `c_k(x) = 1/k! −
//! x/(k+2)! + x²/(k+4)! − …` are Stumpff's. These functions are smooth at zero, obey `c_k = 1/k! −
//! x c_(k+2)`, and yield the derivative and the inverse without cancellation: `dc2/dt = (2 c4 − c3)
//! phi·phi'` and `dc3/dt = (3 c5 − c4) phi·phi'`.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::scalar::{atan2, sin_cos, sqrt};

/// Returns the rotation about `phi` by `|phi|` radians.
pub fn exp(phi: &Vector3<f64>) -> UnitQuaternion<f64> {
    let half = phi * 0.5;
    let c = Stumpff::at(half.norm_squared());
    let v = half * c.c1;
    UnitQuaternion::new_unchecked(Quaternion::new(c.c0, v.x, v.y, v.z))
}

/// Returns the shortest rotation vector of `rotation`, of length at most π.
///
/// At exactly half a turn, both directions are valid; the sign of the quaternion selects one.
pub fn log(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    let v = rotation.imag();
    let w = rotation.w;
    let sine = v.norm();
    // Below this bound, the square of the norm underflows. The approximation sin(a/2) = a/2 is
    // exact far above it.
    let scale = if sine < 1e-150 {
        2.0
    } else {
        2.0 * atan2(sine, w.abs()) / sine
    };
    v * if w < 0.0 { -scale } else { scale }
}

/// Returns the rotation vector, in base axes, that turns `actual` into `target`.
pub fn error(target: &UnitQuaternion<f64>, actual: &UnitQuaternion<f64>) -> Vector3<f64> {
    log(&(target * actual.inverse()))
}

/// Returns `J(phi)`, which maps the rate of the rotation vector to angular velocity in base axes.
pub fn left_jacobian(phi: &Vector3<f64>) -> Matrix3<f64> {
    let c = Stumpff::at(phi.norm_squared());
    let k = phi.cross_matrix();
    Matrix3::identity() + k * c.c2 + k * k * c.c3
}

/// Returns the inverse of [`left_jacobian`]. The inverse exists for `|phi| < 2π`.
pub fn left_jacobian_inverse(phi: &Vector3<f64>) -> Matrix3<f64> {
    let c = Stumpff::at(phi.norm_squared());
    let k = phi.cross_matrix();
    Matrix3::identity() - k * 0.5 + k * k * ((c.c3 - 2.0 * c.c4) / (2.0 * c.c2))
}

/// Returns the time derivative of [`left_jacobian`] while `phi` changes at `rate`.
pub fn left_jacobian_rate(phi: &Vector3<f64>, rate: &Vector3<f64>) -> Matrix3<f64> {
    let c = Stumpff::at(phi.norm_squared());
    let (k, dk) = (phi.cross_matrix(), rate.cross_matrix());
    let growth = phi.dot(rate);
    k * ((2.0 * c.c4 - c.c3) * growth)
        + dk * c.c2
        + k * k * ((3.0 * c.c5 - c.c4) * growth)
        + (dk * k + k * dk) * c.c3
}

/// Returns the angular velocity `[rad/s]`, in base axes, while `phi` changes at `rate`.
pub fn angular_velocity(phi: &Vector3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
    left_jacobian(phi) * rate
}

/// Returns the angular acceleration `[rad/s²]`, in base axes, from the rotation vector and its
/// first two derivatives.
pub fn angular_acceleration(
    phi: &Vector3<f64>,
    rate: &Vector3<f64>,
    second: &Vector3<f64>,
) -> Vector3<f64> {
    left_jacobian(phi) * second + left_jacobian_rate(phi, rate) * rate
}

/// Returns the first and the second derivative of the rotation vector at `phi`, for the angular
/// velocity `omega` and the angular acceleration `alpha`. The result is valid for `|phi| < 2π`.
pub fn derivatives(
    phi: &Vector3<f64>,
    omega: &Vector3<f64>,
    alpha: &Vector3<f64>,
) -> (Vector3<f64>, Vector3<f64>) {
    let inverse = left_jacobian_inverse(phi);
    let rate = inverse * omega;
    let second = inverse * (alpha - left_jacobian_rate(phi, &rate) * rate);
    (rate, second)
}

/// Stumpff's functions of `x = angle²`: cosine, sine over angle, and the functions of higher order.
struct Stumpff {
    c0: f64,
    c1: f64,
    c2: f64,
    c3: f64,
    c4: f64,
    c5: f64,
}

impl Stumpff {
    fn at(x: f64) -> Self {
        if x < SERIES_BELOW {
            let (c4, c5) = (series(4.0, x) / 24.0, series(5.0, x) / 120.0);
            let (c2, c3) = (0.5 - x * c4, 1.0 / 6.0 - x * c5);
            Self {
                c0: 1.0 - x * c2,
                c1: 1.0 - x * c3,
                c2,
                c3,
                c4,
                c5,
            }
        } else {
            let angle = sqrt(x);
            let (sin, c0) = sin_cos(angle);
            let c1 = sin / angle;
            let (c2, c3) = ((1.0 - c0) / x, (1.0 - c1) / x);
            Self {
                c0,
                c1,
                c2,
                c3,
                c4: (0.5 - c2) / x,
                c5: (1.0 / 6.0 - c3) / x,
            }
        }
    }
}

/// Returns `k! c_k(x)` for `0 <= x < 1`; the first omitted term is below 1e-19.
fn series(k: f64, x: f64) -> f64 {
    let mut sum = 1.0;
    for term in (1..=8).rev() {
        let n = k + 2.0 * f64::from(term);
        sum = 1.0 - sum * x / (n * (n - 1.0));
    }
    sum
}

/// Square of an angle of 1 rad. Above this angle, the quotients lose at most two digits.
const SERIES_BELOW: f64 = 1.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use core::f64::consts::PI;

    /// Returns rotation vectors of many lengths below `limit`, including zero and the length at
    /// which the formula changes.
    fn samples(limit: f64) -> std::vec::Vec<Vector3<f64>> {
        let mut random = Random::new(11);
        let lengths = [
            0.0, 1e-300, 1e-12, 1e-6, 1e-3, 0.3, 0.999_999, 1.0, 2.0, 3.1,
        ];
        (0..400)
            .map(|i| {
                let direction = random.vector3(1.0).normalize();
                direction
                    * lengths
                        .get(i)
                        .copied()
                        .unwrap_or(limit * random.uniform(0.0, 1.0))
            })
            .collect()
    }

    #[test]
    fn logarithm_undoes_exponential_up_to_half_a_turn() {
        for phi in samples(PI - 1e-9) {
            let back = log(&exp(&phi));
            assert!((back - phi).norm() < 4e-15, "{phi} became {back}");
        }
    }

    #[test]
    fn both_quaternions_of_a_rotation_have_the_same_logarithm() {
        for phi in samples(3.0) {
            let q = exp(&phi);
            let other = UnitQuaternion::new_unchecked(-q.into_inner());
            assert_eq!(log(&q), log(&other));
        }
    }

    #[test]
    fn half_a_turn_has_length_pi() {
        let half = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 0.6, 0.0, 0.8));
        assert!((log(&half) - Vector3::new(0.6, 0.0, 0.8) * PI).norm() < 1e-15);
    }

    #[test]
    fn error_turns_the_actual_orientation_into_the_target() {
        let pairs = samples(3.0);
        for (a, b) in pairs.iter().zip(pairs.iter().rev()) {
            let (target, actual) = (exp(a), exp(b));
            let reached = exp(&error(&target, &actual)) * actual;
            assert!(reached.angle_to(&target) < 1e-7); // angle_to has sqrt(epsilon) resolution
            let difference =
                reached.to_rotation_matrix().matrix() - target.to_rotation_matrix().matrix();
            assert!(difference.amax() < 4e-15);
        }
    }

    #[test]
    fn left_jacobian_is_the_derivative_of_the_exponential() {
        let mut random = Random::new(12);
        for phi in samples(6.0) {
            let rate = random.vector3(1.0);
            let h = 1e-5;
            let step = exp(&(phi + rate * h)) * exp(&(phi - rate * h)).inverse();
            let numeric = log(&step) / (2.0 * h);
            let omega = angular_velocity(&phi, &rate);
            assert!((omega - numeric).norm() < 3e-9, "at {phi}");
        }
    }

    #[test]
    fn jacobian_rate_is_its_derivative() {
        let mut random = Random::new(13);
        for phi in samples(6.0) {
            let rate = random.vector3(1.0);
            let h = 1e-5;
            let numeric =
                (left_jacobian(&(phi + rate * h)) - left_jacobian(&(phi - rate * h))) / (2.0 * h);
            assert!((left_jacobian_rate(&phi, &rate) - numeric).amax() < 1e-9);
        }
    }

    #[test]
    fn inverse_jacobian_is_the_inverse() {
        for phi in samples(6.0) {
            let product = left_jacobian(&phi) * left_jacobian_inverse(&phi);
            assert!((product - Matrix3::identity()).amax() < 1e-13, "at {phi}");
        }
    }

    #[test]
    fn derivatives_undo_angular_velocity_and_acceleration() {
        let mut random = Random::new(14);
        for phi in samples(PI) {
            let (omega, alpha) = (random.vector3(2.0), random.vector3(10.0));
            let (rate, second) = derivatives(&phi, &omega, &alpha);
            assert!((angular_velocity(&phi, &rate) - omega).norm() < 1e-13);
            assert!((angular_acceleration(&phi, &rate, &second) - alpha).norm() < 1e-12);
        }
    }
}

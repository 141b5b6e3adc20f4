//! Fifth-degree polynomials between two states. This is the lowest degree that meets position,
//! velocity and acceleration at both ends.

use nalgebra::SVector;

/// Position, velocity and acceleration of a point with `D` coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PointState<const D: usize> {
    pub(super) p: SVector<f64, D>,
    pub(super) v: SVector<f64, D>,
    pub(super) a: SVector<f64, D>,
}

impl<const D: usize> PointState<D> {
    pub(super) fn zero() -> Self {
        Self {
            p: SVector::zeros(),
            v: SVector::zeros(),
            a: SVector::zeros(),
        }
    }

    /// Returns the state after `t` seconds of constant `jerk`.
    pub(super) fn after(&self, jerk: &SVector<f64, D>, t: f64) -> Self {
        Self {
            p: self.p + (self.v + (self.a + jerk * (t / 3.0)) * (0.5 * t)) * t,
            v: self.v + (self.a + jerk * (0.5 * t)) * t,
            a: self.a + jerk * t,
        }
    }
}

/// Returns the state at the time `t` of a motion that is at `from` at 0 and at `to` at `duration`,
/// in seconds.
pub(super) fn between<const D: usize>(
    from: &PointState<D>,
    to: &PointState<D>,
    duration: f64,
    t: f64,
) -> PointState<D> {
    // The unit of time is the duration.
    let (s, d) = (t / duration, duration);
    let (v, a) = (from.v * d, from.a * (0.5 * d * d));
    // Difference at the end if the initial acceleration continues.
    let p1 = to.p - from.p - v - a;
    let v1 = to.v * d - v - a * 2.0;
    let a1 = to.a * (0.5 * d * d) - a;
    let c3 = p1 * 10.0 - v1 * 4.0 + a1;
    let c4 = p1 * -15.0 + v1 * 7.0 - a1 * 2.0;
    let c5 = p1 * 6.0 - v1 * 3.0 + a1;
    PointState {
        p: from.p + (v + (a + (c3 + (c4 + c5 * s) * s) * s) * s) * s,
        v: (v + (a * 2.0 + (c3 * 3.0 + (c4 * 4.0 + c5 * (5.0 * s)) * s) * s) * s) / d,
        a: (a * 2.0 + (c3 * 6.0 + (c4 * 12.0 + c5 * (20.0 * s)) * s) * s) / (d * d),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SVector;

    #[test]
    fn quintic_meets_both_ends_with_matching_derivatives() {
        let from = PointState {
            p: SVector::from([0.3, -1.0]),
            v: SVector::from([0.5, 2.0]),
            a: SVector::from([-3.0, 0.1]),
        };
        let to = PointState {
            p: SVector::from([0.1, 1.0]),
            v: SVector::from([-0.7, 0.0]),
            a: SVector::from([4.0, -2.0]),
        };
        let duration = 0.16;
        let at = |t| between(&from, &to, duration, t);
        for (got, end) in [(at(0.0), from), (at(duration), to)] {
            assert!((got.p - end.p).norm() < 1e-13);
            assert!((got.v - end.v).norm() < 1e-12);
            assert!((got.a - end.a).norm() < 1e-10);
        }
        let h = 1e-5;
        for t in [0.01, 0.05, 0.1, 0.15] {
            let v = (at(t + h).p - at(t - h).p) / (2.0 * h);
            let a = (at(t + h).v - at(t - h).v) / (2.0 * h);
            assert!((at(t).v - v).norm() < 1e-6 && (at(t).a - a).norm() < 1e-4);
        }
    }

    #[test]
    fn reproduces_a_motion_of_constant_acceleration() {
        let from = PointState {
            p: SVector::from([1.0]),
            v: SVector::from([-2.0]),
            a: SVector::from([3.0]),
        };
        let still = SVector::zeros();
        let to = from.after(&still, 0.5);
        let middle = between(&from, &to, 0.5, 0.2);
        assert!((middle.p - from.after(&still, 0.2).p).norm() < 1e-14);
        assert!((middle.a - from.a).norm() < 1e-12);
    }
}

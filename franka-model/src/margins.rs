//! Distances of the joints from their limits, at rest and in motion.

use crate::JointVector;
use crate::limits::JointLimits;

/// Distances of the joints from their limits, at given positions and velocities. A negative margin
/// is the amount by which a joint exceeds a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMargins {
    /// Distance to the smallest commanded position, `[rad]`.
    pub to_lower: JointVector,
    /// Distance to the largest commanded position, `[rad]`.
    pub to_upper: JointVector,
    /// Distance to the nearer position limit, as a share of half the range: 1 in the middle, 0 at a
    /// limit.
    pub normalised: JointVector,
    /// Distance, `[rad]`, to the limit in the direction of motion if the joint brakes to a stop
    /// now. At rest, this is the distance to the nearer limit. The joint brakes with the
    /// deceleration of its [envelope](crate::limits::BrakingEnvelope), or with its largest
    /// acceleration if it has no envelope. The real braking distance is slightly longer, because
    /// the jerk is also bounded.
    pub braking: JointVector,
    /// Distance to the smallest velocity allowed at this position, `[rad/s]`; see
    /// [`JointLimits::velocity_envelope`].
    pub to_least_velocity: JointVector,
    /// Distance to the largest velocity allowed at this position, `[rad/s]`.
    pub to_greatest_velocity: JointVector,
}

impl JointMargins {
    /// Returns the joint, 1 to 7, with the smallest [`normalised`](Self::normalised) margin, and
    /// that margin. A NaN position comes first.
    pub fn tightest(&self) -> (usize, f64) {
        let mut tightest = (1, self.normalised[0]);
        for (i, &margin) in self.normalised.iter().enumerate() {
            if margin < tightest.1 || (margin.is_nan() && !tightest.1.is_nan()) {
                tightest = (i + 1, margin);
            }
        }
        tightest
    }
}

impl JointLimits {
    /// Returns the margins at positions `q` `[rad]` and velocities `dq` `[rad/s]`; pass zeros for
    /// an arm at rest.
    pub fn margins(&self, q: &JointVector, dq: &JointVector) -> JointMargins {
        let (to_lower, to_upper) = (q - self.lower, self.upper - q);
        let nearer = to_lower.zip_map(&to_upper, f64::min);
        let (least, greatest) = self.velocity_envelope(q, 0.0);
        JointMargins {
            to_lower,
            to_upper,
            normalised: JointVector::from_fn(|i, _| {
                // `f64::min` ignores NaN.
                let nearer = if q[i].is_nan() { f64::NAN } else { nearer[i] };
                2.0 * nearer / (self.upper[i] - self.lower[i])
            }),
            braking: JointVector::from_fn(|i, _| {
                let ahead = if dq[i] > 0.0 {
                    to_upper[i]
                } else if dq[i] < 0.0 {
                    to_lower[i]
                } else {
                    nearer[i]
                };
                ahead - dq[i] * dq[i] / (2.0 * self.deceleration(i))
            }),
            to_least_velocity: dq - least,
            to_greatest_velocity: greatest - dq,
        }
    }

    /// Returns the deceleration of a braking joint, `[rad/s²]`.
    fn deceleration(&self, i: usize) -> f64 {
        match &self.envelope {
            Some(envelope) => envelope.deceleration[i],
            None => self.acceleration[i],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::{Model, READY, RobotKind};

    #[test]
    fn margin_is_one_mid_range_zero_at_limit_negative_beyond() {
        let rest = JointVector::zeros();
        for kind in RobotKind::ALL {
            let limits = JointLimits::of(kind);
            let at = |q: JointVector| limits.margins(&q, &rest).normalised;
            let middle = (limits.lower + limits.upper) * 0.5;
            assert!((at(middle).add_scalar(-1.0)).amax() < 1e-14);
            assert_eq!(at(limits.lower), JointVector::zeros());
            assert_eq!(at(limits.upper), JointVector::zeros());
            assert!(at(limits.upper.add_scalar(0.1)).max() < 0.0);
            assert!(at(limits.lower.add_scalar(-0.1)).max() < 0.0);
        }
    }

    #[test]
    fn tightest_joint_is_nearest_to_a_limit_for_its_range() {
        let limits = Model::fr3().joint_limits();
        let mut q = READY;
        q[3] = limits.upper[3] - 0.01;
        let margins = limits.margins(&q, &JointVector::zeros());
        let (joint, margin) = margins.tightest();
        assert_eq!(joint, 4);
        assert!((margin - 0.02 / (limits.upper[3] - limits.lower[3])).abs() < 1e-15);
        assert!((margins.to_upper[3] - 0.01).abs() < 1e-15);

        q[5] = f64::NAN;
        let (joint, margin) = limits.margins(&q, &JointVector::zeros()).tightest();
        assert!(joint == 6 && margin.is_nan());
    }

    #[test]
    fn a_joint_that_brakes_comes_to_rest_where_the_margin_says() {
        let mut random = Random::new(63);
        for case in 0..1000 {
            let model = [Model::fr3(), Model::fer()][case % 2];
            let limits = model.joint_limits();
            let (q, dq) = (random.posture(model), random.joints(2.0));
            let margins = limits.margins(&q, &dq);
            for i in 0..7 {
                // Integrates small steps of constant deceleration.
                let deceleration = match &limits.envelope {
                    Some(envelope) => envelope.deceleration[i],
                    None => limits.acceleration[i],
                };
                let (mut at, mut speed) = (q[i], dq[i]);
                let dt = (speed / deceleration).abs() / 1000.0;
                for _ in 0..1000 {
                    let next = speed - deceleration * speed.signum() * dt;
                    at += 0.5 * (speed + next) * dt;
                    speed = next;
                }
                let left = if dq[i] > 0.0 {
                    limits.upper[i] - at
                } else {
                    at - limits.lower[i]
                };
                assert!((margins.braking[i] - left).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn margins_of_velocity_are_those_of_the_envelope() {
        let mut random = Random::new(64);
        let limits = Model::fr3().joint_limits();
        for _ in 0..1000 {
            let (q, dq) = (random.posture(Model::fr3()), random.joints(3.0));
            let margins = limits.margins(&q, &dq);
            let (least, greatest) = limits.velocity_envelope(&q, 0.0);
            for i in 0..7 {
                let within = (least[i]..=greatest[i]).contains(&dq[i]);
                let margin = margins.to_least_velocity[i].min(margins.to_greatest_velocity[i]);
                assert_eq!(within, margin >= 0.0);
            }
        }
    }
}

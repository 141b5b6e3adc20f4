//! The torque of each joint in steady motion that the robot's model does not contain. It has two
//! parts: friction, which opposes the motion, and bias, which does not depend on the direction.
//!
//! While a joint moves in one direction, only the sum of friction and bias is visible. For each
//! joint, a Kalman filter with two states separates them: `takes = direction * friction + bias`.
//! Friction changes slowly. Bias changes quickly, because the torque of a load depends on the pose.
//! Covariances are divided by the noise density of the measurement, `[1/s]`, so they are the rates
//! of learning.

use crate::shaping::CYCLE;

/// Learned friction and bias of each joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Learned([Joint; 7]);

#[derive(Clone, Copy, Debug, PartialEq)]
struct Joint {
    /// Friction, `[N m]`, at least zero.
    friction: f64,
    /// Bias, `[N m]`.
    bias: f64,
    /// Variance of the friction, variance of the bias, and covariance of the two, `[1/s]`.
    covariance: [f64; 3],
}

impl Default for Joint {
    fn default() -> Self {
        Self {
            friction: 0.0,
            bias: 0.0,
            covariance: [UNKNOWN[0], UNKNOWN[1], 0.0],
        }
    }
}

impl Learned {
    /// Creates the values of an arm from a friction and a bias of each joint. Each comes with its
    /// standard deviation; all are in `[N m]`.
    pub(crate) fn known(joints: [((f64, f64), (f64, f64)); 7]) -> Self {
        Self(joints.map(|((friction, of_friction), (bias, of_bias))| {
            let covariance = |deviation: f64, most: f64| (deviation * deviation / NOISE).min(most);
            Joint {
                friction,
                bias,
                covariance: [
                    covariance(of_friction, UNKNOWN[0]),
                    covariance(of_bias, UNKNOWN[1]),
                    0.0,
                ],
            }
        }))
    }

    /// Returns the friction and the bias of a joint, `[N m]`.
    ///
    /// Even an arm without friction needs a small torque, because its torques lag. For such an arm
    /// both values are zero.
    pub(crate) fn of(&self, joint: usize) -> (f64, f64) {
        let Joint { friction, bias, .. } = self.0[joint];
        let sticks = (friction / SMOOTH - 1.0).clamp(0.0, 1.0);
        let unsure = bias.clamp(-UNBIASED, UNBIASED) * (1.0 - sticks);
        (friction * sticks, bias - unsure)
    }

    /// Returns the uncertainty of a joint: 1 until the joint has moved in both directions, after
    /// that a value that falls to 0.
    pub(super) fn unknown(&self, joint: usize) -> f64 {
        let [of_friction, ..] = self.0[joint].covariance;
        (of_friction / KNOWN - 1.0).clamp(0.0, 1.0)
    }

    /// Learns from a joint that moves in the direction of `sign` and needs this torque, `[N m]`.
    pub(super) fn learn(&mut self, joint: usize, sign: f64, takes: f64) {
        let Joint {
            friction,
            bias,
            covariance: [of_friction, of_bias, of_both],
        } = &mut self.0[joint];
        *of_friction += DRIFT[0] * CYCLE;
        *of_bias += DRIFT[1] * CYCLE;
        let by_friction = *of_friction * sign + *of_both;
        let by_bias = *of_both * sign + *of_bias;
        let of_takes = by_friction * sign + by_bias + 1.0 / CYCLE;
        let off = takes - (sign * *friction + *bias);
        *friction = (*friction + by_friction / of_takes * off).max(0.0);
        *bias += by_bias / of_takes * off;
        *of_friction -= by_friction * by_friction / of_takes;
        *of_bias -= by_bias * by_bias / of_takes;
        *of_both -= by_friction * by_bias / of_takes;
    }
}

/// Friction up to which a joint counts as smooth, `[N m]`. At twice this value or more, the joint
/// counts as sticking.
const SMOOTH: f64 = 0.1;

/// Bias of a smooth joint that the springs and the integral compensate alone, `[N m]`.
pub(super) const UNBIASED: f64 = 0.1;

/// Initial variances of friction and bias for an unknown arm, `[1/s]`.
const UNKNOWN: [f64; 2] = [5.0, 3.0];

/// Noise density of the measured torque of a joint, `[N^2 m^2 s]`. With it, the prior standard
/// deviation of an unknown friction is about 1 N m.
const NOISE: f64 = 0.2;

/// Variance of the friction once a joint has moved in both directions, `[1/s]`. While it has moved
/// in only one direction, the variance stays at twice this value or more.
const KNOWN: f64 = 0.9;

/// Growth rates of the variances of friction and bias, `[1/s^2]`.
const DRIFT: [f64; 2] = [0.2, 5.0];

#[cfg(test)]
mod tests {
    use super::*;

    /// Moves to and fro for four seconds. The joint has this friction, and this bias as a function
    /// of time.
    fn to_and_fro(friction: f64, bias: impl Fn(f64) -> f64) -> Learned {
        let mut this = Learned::default();
        for cycle in 0..4000 {
            let sign = if cycle / 500 % 2 == 0 { 1.0 } else { -1.0 };
            this.learn(0, sign, sign * friction + bias(f64::from(cycle) * CYCLE));
        }
        this
    }

    #[test]
    fn friction_and_bias_are_told_apart() {
        let (friction, bias) = to_and_fro(0.8, |_| -0.3).of(0);
        assert!((friction - 0.8).abs() < 0.05, "{friction}");
        assert!((bias + 0.3).abs() < 0.05, "{bias}");
    }

    /// A load that has more torque on the way out than on the way back does not count as friction.
    #[test]
    fn a_bias_that_changes_with_the_pose_is_not_taken_for_friction() {
        let pose = |t: f64| 2.0 * (core::f64::consts::PI * t).sin().abs();
        let (friction, _) = to_and_fro(0.8, pose).of(0);
        assert!((friction - 0.8).abs() < 0.25, "{friction}");
    }

    #[test]
    fn one_direction_says_little_of_the_other() {
        let mut this = Learned::default();
        assert_eq!(this.unknown(0), 1.0);
        for _ in 0..2000 {
            this.learn(0, 1.0, 0.9);
        }
        let (friction, bias) = this.of(0);
        assert!((friction + bias - 0.9).abs() < 0.02, "{friction} {bias}");
        assert_eq!(this.unknown(0), 1.0, "{this:?}");
        assert_eq!(to_and_fro(0.8, |_| 0.0).unknown(0), 0.0);
    }

    #[test]
    fn known_values_weigh_by_their_certainty() {
        let begin = |deviation| {
            let joint = ((0.8, deviation), (-0.3, deviation));
            Learned::known([joint; 7])
        };
        let (mut sure, mut unsure) = (begin(0.05), begin(5.0));
        assert_eq!(sure.of(0), (0.8, -0.3));
        assert_eq!((sure.unknown(0), unsure.unknown(0)), (0.0, 1.0));
        for _ in 0..100 {
            sure.learn(0, 1.0, 1.5);
            unsure.learn(0, 1.0, 1.5);
        }
        let change = |of: Learned| (of.of(0).0 - 0.8).abs();
        assert!(change(sure) < 0.1 * change(unsure), "{sure:?} {unsure:?}");
    }

    #[test]
    fn covariances_stay_sound_whatever_moves() {
        for period in [1, 10, 1000, 100_000] {
            let mut this = Learned::default();
            for cycle in 0..100_000 {
                let sign = if cycle / period % 2 == 0 { 1.0 } else { -1.0 };
                this.learn(0, sign, sign);
            }
            let [friction, bias, both] = this.0[0].covariance;
            assert!(friction > 0.0 && bias > 0.0, "{this:?}");
            assert!(both * both < friction * bias, "{this:?}");
            assert!(friction + bias < 1000.0, "{this:?}");
        }
    }
}

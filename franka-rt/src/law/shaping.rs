//! From the torques of a law to the torques that the robot accepts.

use franka_model::JointVector;
use franka_model::limits::CLIENT_MARGIN;

use crate::shaping::{CYCLE, DEFAULT_CUTOFF_FREQUENCY, filter, limiter};

/// Bound of the spring and damper torques per joint, `[N m]`: just inside the 87 and 12 N m that
/// the joints can give.
pub const TORQUE_CLAMP: [f64; 7] = [86.0, 86.0, 86.0, 86.0, 11.5, 11.5, 11.5];

/// Share of the new value in the low-pass filter, which has the cutoff frequency of libfranka's
/// control loops.
const FILTER_GAIN: f64 = filter::gain(CYCLE, DEFAULT_CUTOFF_FREQUENCY);

/// Bounds each torque by `most`, `[N m]`, and tells whether that changed any.
pub fn clamp(tau: &JointVector, most: &JointVector) -> (JointVector, bool) {
    let clamped = tau.zip_map(most, |tau, most| tau.clamp(-most, most));
    (clamped, clamped != *tau)
}

/// Low-passes `tau` against the torques that the robot last took, `tau_J_d` of its state.
pub fn low_pass(tau: &JointVector, last: &JointVector) -> JointVector {
    tau.zip_map(last, |tau, last| filter::mix(FILTER_GAIN, tau, last))
}

/// Keeps the change from the torques that the robot last took inside its rate limit, and tells
/// whether that bound.
///
/// The usual margin is kept from `rate`, the robot's limit `[N m/s]`, and what an echo rounded to
/// `f32` may hide of the last torques.
pub fn limit_rate(
    tau: &JointVector,
    last: &JointVector,
    rate: &JointVector,
) -> (JointVector, bool) {
    let mut bound = false;
    let limited = tau.zip_zip_map(last, rate, |tau, last, rate| {
        let rate = limiter::within_echo(rate - CLIENT_MARGIN, last);
        let (limited, slowed) = limiter::limit_rate(tau, last, rate);
        bound |= slowed;
        limited
    });
    (limited, bound)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_filter_has_the_gain_of_libfranka_at_100_hz() {
        assert!((FILTER_GAIN - 0.385_869_545_095_037_5).abs() < 1e-16);
        let one = low_pass(&JointVector::repeat(1.0), &JointVector::zeros());
        assert_eq!(one[0], FILTER_GAIN);
    }

    #[test]
    fn the_rate_stays_inside_the_limit_of_the_unrounded_torque() {
        for sent in [86.0_f64, 63.999_999_7, -77.123_456_789, 1e-3, 0.0] {
            let echo = JointVector::repeat(f64::from(sent as f32));
            for wish in [200.0, -200.0] {
                let limit = 1000.0;
                let (next, bound) = limit_rate(
                    &JointVector::repeat(wish),
                    &echo,
                    &JointVector::repeat(limit),
                );
                assert!(bound);
                let rate = (next[0] - sent).abs() / CYCLE;
                assert!(rate <= limit, "{rate} N m/s from {sent}");
                assert!(rate > limit - 0.02);
            }
        }
    }

    #[test]
    fn clamps_each_joint_by_its_own_bound() {
        let (tau, bound) = clamp(&JointVector::repeat(50.0), &TORQUE_CLAMP.into());
        assert!(bound);
        assert_eq!(tau[0], 50.0);
        assert_eq!(tau[6], 11.5);
        assert!(!clamp(&JointVector::repeat(-11.5), &TORQUE_CLAMP.into()).1);
    }
}

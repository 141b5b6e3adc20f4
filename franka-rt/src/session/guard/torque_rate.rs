//! The torque-rate limit of target control: commanded torques change no faster than the robot
//! accepts. Control functions have their own, optional limit in `control::shaper`. The arithmetic
//! is in `shaping::limiter`. The simulated robot's check is in `franka_sim`, `robot::motion`.

use franka_model::JointVector;
use franka_model::limits::CLIENT_MARGIN;

use crate::shaping::limiter;

/// Limits the change from the last torques that the robot accepted. Also returns true if a torque
/// was limited.
///
/// Two margins are subtracted from `rate`, the robot's limit `[N m/s]`: the usual margin, and the
/// error that an echo rounded to `f32` may hide.
pub(crate) fn limit_rate(
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
    use crate::shaping::CYCLE;

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
}

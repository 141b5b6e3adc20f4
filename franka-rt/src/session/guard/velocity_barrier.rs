//! The velocity barrier: brakes a joint that comes near the robot's velocity limit, regardless of
//! the cause.
//!
//! The generators keep the reference inside the limits. A hand or a stretched spring may accelerate
//! the arm itself further, and then the robot stops with a reflex. From [`ONSET`] of the limit on,
//! the torque of a joint is blended from the law's torque to full braking, reached at the limit:
//!
//! ```text
//! tau' = (1 - s) tau - s sign(dq) clamp        s = smoothstep((|dq| / limit - 0.85) / 0.15)
//! ```
//!
//! Even a law that drives the joint with its full torque is therefore balanced half way. `s` and
//! its slope are continuous.
//!
//! The rate of the torque bounds the torque that the barrier can hold: the robot accepts 1 N m per
//! millisecond. While a torque `tau` on an inertia `I` is removed, it adds `tau^2 / (2 I 1000 N
//! m/s)` of speed. At the shoulder, 0.39 rad/s above the onset, that is at most 28 N m on 1 kg m^2.
//! At the wrist, with 0.79 rad/s, it is 12 N m on 0.1 kg m^2. The barrier begins gently, so it
//! holds a little less.

use franka_model::JointVector;

/// Share of the velocity limit from which on a joint is braked.
pub const ONSET: f64 = 0.85;

/// Brakes the joints that are too fast. Returns true if there were any. `dq` is the measured
/// velocity and `limit` the robot's limit, `[rad/s]`; `most` is the torque of full braking, `[N
/// m]`.
pub(crate) fn brake(
    tau: &JointVector,
    dq: &JointVector,
    limit: &JointVector,
    most: &JointVector,
) -> (JointVector, bool) {
    let mut binds = false;
    let braked = JointVector::from_fn(|i, _| {
        let beyond = (dq[i].abs() / limit[i] - ONSET) / (1.0 - ONSET);
        if beyond <= 0.0 {
            return tau[i];
        }
        binds = true;
        let x = beyond.min(1.0);
        let share = x * x * (3.0 - 2.0 * x);
        tau[i] + share * (-most[i].copysign(dq[i]) - tau[i])
    });
    (braked, binds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Gains;
    use crate::law::blended_gains::BlendedGains;
    use crate::session::effort::low_pass;
    use crate::session::guard::torque_rate::limit_rate;
    use franka_model::{CYCLE, Model};
    use proptest::prelude::*;

    fn of(tau: f64, dq: f64) -> (f64, bool) {
        let limit = JointVector::repeat(2.0);
        let most = JointVector::repeat(50.0);
        let (tau, dq) = (JointVector::repeat(tau), JointVector::repeat(dq));
        let (braked, binds) = brake(&tau, &dq, &limit, &most);
        (braked[3], binds)
    }

    #[test]
    fn leaves_slow_joints_alone_and_brakes_fully_from_the_limit_on() {
        assert_eq!(of(30.0, 1.7), (30.0, false));
        assert_eq!(of(30.0, -1.7), (30.0, false));
        assert_eq!(of(30.0, 2.0), (-50.0, true));
        assert_eq!(of(30.0, -9.0), (50.0, true));
        assert!(of(50.0, 1.85).0.abs() < 1e-9, "balanced half way");
    }

    #[test]
    fn value_and_slope_are_continuous() {
        let step = 1e-4;
        let at = |i: i32| of(20.0, 1.6 + step * f64::from(i)).0;
        for i in 1..5000 {
            let slope = (at(i) - at(i - 1)) / step;
            let next = (at(i + 1) - at(i)) / step;
            // Greatest curvature: 6 / 0.3^2 of 70 N m.
            assert!(
                (next - slope).abs() < 5000.0 * step,
                "at {i}: {slope}, {next}"
            );
        }
    }

    proptest! {
        #[test]
        fn only_ever_opposes_the_motion_and_stays_within_the_clamp(
            tau in -50.0..50.0f64,
            dq in -4.0..4.0f64,
        ) {
            let (braked, _) = of(tau, dq);
            prop_assert!((braked - tau) * dq <= 0.0);
            prop_assert!(braked.abs() <= 50.0 * (1.0 + 1e-15));
        }
    }

    /// Uses the inertia of links and rotors near the ready pose. The torque is the greatest that
    /// the joints tolerate at the robot's torque rate, through the filter and the rate limit of the
    /// cycle.
    #[test]
    fn a_joint_that_is_driven_on_and_on_stays_under_the_limit() {
        let limits = Model::fr3().joint_limits();
        let most = JointVector::from(Gains::TORQUE_LIMITS);
        let inertia = [1.0, 1.0, 1.0, 1.0, 0.2, 0.2, 0.1];
        let driving = JointVector::from([25.0, 25.0, 25.0, 25.0, 8.0, 8.0, 8.0]);
        let gains = [Gains::cartesian(), Gains::LEAST].map(|gains| BlendedGains::new(&gains, None));
        for (side, gains) in [1.0, -1.0]
            .into_iter()
            .flat_map(|side| gains.map(|of| (side, of)))
        {
            let (mut dq, mut last) = (JointVector::zeros(), JointVector::zeros());
            let mut fastest = JointVector::zeros();
            for _ in 0..5000 {
                let (tau, _) = brake(&(driving * side), &dq, &limits.velocity, &most);
                let filtered = low_pass(gains.torque_share, &tau, &last);
                let (tau, _) = limit_rate(&filtered, &last, &limits.torque_rate);
                for i in 0..7 {
                    dq[i] += last[i] / inertia[i] * CYCLE;
                    fastest[i] = fastest[i].max(dq[i].abs());
                }
                last = tau;
            }
            for i in 0..7 {
                let share = fastest[i] / limits.velocity[i];
                assert!((ONSET..1.0).contains(&share), "joint {i} at {share}");
                let kept = dq[i].abs() / limits.velocity[i];
                assert!((ONSET..0.95).contains(&kept), "joint {i} goes on at {kept}");
            }
        }
    }
}

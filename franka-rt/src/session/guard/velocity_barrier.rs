//! The velocity barrier: brakes a joint that comes near the robot's velocity limit, regardless of
//! the cause.
//!
//! The generators keep the reference inside the limits. The arm itself may be faster, thrown by a
//! hand or by a stretched spring, and then the robot stops with a reflex. The torque of a fast
//! joint is blended from the law's torque to full braking, reached at the limit:
//!
//! ```text
//! tau' = (1 - s) tau - s sign(dq) clamp        s = smoothstep((|dq| - onset) / (0.15 limit))
//! ```
//!
//! The braking begins at [`ONSET`] of the limit. Near the end of its range a joint has a lower
//! limit, the [velocity envelope](JointLimits::velocity_envelope), and the onset is as far below
//! that. But it is above the reference, which may follow the envelope closely: only an arm that is
//! pushed ahead of its reference is braked there.
//!
//! So even a law that drives the joint with its full torque is balanced half way. `s` and its slope
//! are continuous.
//!
//! The rate of the torque bounds the torque that the barrier can hold: the robot accepts 1 N m per
//! millisecond. While a torque `tau` on an inertia `I` is removed, it adds `tau^2 / (2 I 1000 N
//! m/s)` of speed. At the shoulder, 0.39 rad/s above the onset, that is at most 28 N m on 1 kg m^2.
//! At the wrist, with 0.79 rad/s, it is 12 N m on 0.1 kg m^2. The barrier begins gently, so it
//! holds a little less.

use franka_model::JointVector;
use franka_model::limits::JointLimits;

/// Share of the velocity limit from which on a joint is braked, away from the ends of its range.
pub const ONSET: f64 = 0.85;

/// Speed by which a joint may be faster than its reference near an end of its range, `[rad/s]`: it
/// swings less than that.
const FASTER: f64 = 0.1;

/// Brakes the joints that are too fast. Returns true if there were any. `q` and `dq` are measured,
/// `[rad]` and `[rad/s]`; `most` is the torque of full braking, `[N m]`.
pub(crate) fn brake(
    tau: &JointVector,
    (q, dq): (&JointVector, &JointVector),
    dq_ref: &JointVector,
    limits: &JointLimits,
    most: &JointVector,
) -> (JointVector, bool) {
    let width = |i: usize| (1.0 - ONSET) * limits.velocity[i];
    // Speed up to which a joint is not braked at any position.
    let ahead = |i: usize| {
        let reference = if dq[i] > 0.0 { dq_ref[i] } else { -dq_ref[i] };
        (reference.max(0.0) + FASTER).min(limits.velocity[i] - width(i))
    };
    // Nearly always no joint is that much faster than its reference, and no envelope is needed.
    if (0..7).all(|i| dq[i].abs() <= ahead(i)) {
        return (*tau, false);
    }
    let mut binds = false;
    let (lower, upper) = limits.velocity_envelope(q, 0.0);
    let braked = JointVector::from_fn(|i, _| {
        let here = if dq[i] > 0.0 { upper[i] } else { -lower[i] };
        let beyond = (dq[i].abs() - (here - width(i)).max(ahead(i))) / width(i);
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

    /// The same limits at all positions.
    fn flat(limits: &JointLimits) -> JointLimits {
        JointLimits {
            envelope: None,
            ..*limits
        }
    }

    fn of(tau: f64, dq: f64) -> (f64, bool) {
        let limits = JointLimits {
            velocity: JointVector::repeat(2.0),
            ..flat(Model::fr3().joint_limits())
        };
        let most = JointVector::repeat(50.0);
        let (tau, dq) = (JointVector::repeat(tau), JointVector::repeat(dq));
        let still = JointVector::zeros();
        let (braked, binds) = brake(&tau, (&still, &dq), &still, &limits, &most);
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
        let limits = flat(Model::fr3().joint_limits());
        let still = JointVector::zeros();
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
                let (tau, _) = brake(&(driving * side), (&still, &dq), &still, &limits, &most);
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

    /// A push of 10 N m turns a joint to the end of its range, where the robot allows less and less
    /// speed. Its reference rests.
    #[test]
    fn a_joint_that_is_pushed_to_its_end_stays_inside_the_envelope() {
        let limits = JointLimits::fr3_system_5_9();
        let most = JointVector::from(Gains::TORQUE_LIMITS);
        let inertia = [1.0, 1.0, 1.0, 1.0, 0.2, 0.2, 0.1];
        let still = JointVector::zeros();
        let share = BlendedGains::new(&Gains::cartesian(), None).torque_share;
        for (i, side) in (0..7).flat_map(|i| [(i, 1.0), (i, -1.0)]) {
            let push = if i < 4 { 10.0 } else { 2.0 } * side;
            let (mut q, mut dq) = (JointVector::zeros(), JointVector::zeros());
            q[i] = 0.5 * (limits.lower[i] + limits.upper[i]);
            let mut last = JointVector::zeros();
            loop {
                let (tau, _) = brake(&still, (&q, &dq), &still, limits, &most);
                let filtered = low_pass(share, &tau, &last);
                let (tau, _) = limit_rate(&filtered, &last, &limits.torque_rate);
                dq[i] += (last[i] + push) / inertia[i] * CYCLE;
                q[i] += dq[i] * CYCLE;
                last = tau;
                let (lower, upper) = limits.velocity_envelope(&q, 0.0);
                let most = if side > 0.0 { upper[i] } else { -lower[i] };
                // A push brings the joint slowly to where the envelope allows hardly any speed.
                if most < 4.0 * FASTER {
                    break;
                }
                let speed = dq[i] * side;
                assert!(speed < most, "joint {}: {speed} of {most} rad/s", i + 1);
            }
        }
    }

    #[test]
    fn a_reference_that_follows_the_envelope_is_not_braked() {
        let limits = JointLimits::fr3_system_5_9();
        let (mut q, mut dq) = (JointVector::zeros(), JointVector::zeros());
        (q[3], dq[3]) = (-0.2, 0.4);
        assert!(dq[3] < limits.velocity_envelope(&q, 0.0).1[3]);
        let (tau, most) = (JointVector::repeat(5.0), JointVector::repeat(50.0));
        assert_eq!(brake(&tau, (&q, &dq), &dq, limits, &most), (tau, false));
        let (braked, binds) = brake(&tau, (&q, &dq), &JointVector::zeros(), limits, &most);
        assert!(binds && braked[3] < 0.0, "{braked}");
    }
}

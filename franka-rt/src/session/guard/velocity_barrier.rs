//! The velocity barrier: brakes a joint that comes near the robot's velocity limit, or near an end
//! of its range, regardless of the cause.
//!
//! The generators keep the reference inside the limits. The arm itself may be faster, thrown by a
//! hand or by a stretched spring, and then the robot stops with a reflex. The torque of a fast
//! joint is blended from the law's torque to full braking, reached at the limit:
//!
//! ```text
//! tau' = (1 - s) tau - s side clamp        s = smoothstep((side dq - onset) / (here - onset))
//! ```
//!
//! `side` is the sign of `dq`, or of the nearer end of the range if the joint is slow. `here` is
//! the limit of the velocity at the joint's position: near the end of its range a joint has a lower
//! limit, the [velocity envelope](JointLimits::velocity_envelope). Robots without an envelope use
//! [`ENDS`].
//!
//! The braking begins at [`ONSET`] of the limit. Near an end it begins as far below `here`, but
//! above the velocity of the reference, so a motion to the end arrives. A joint that is pushed
//! beyond its reference is held at the end, even if it is at rest.
//!
//! Even a law that drives the joint with its full torque is balanced half way. `s` and its slope
//! are continuous.
//!
//! The rate of the torque bounds the torque that the barrier can hold: see the derivation in
//! `docs/src/dev/laws.md`.

use franka_model::limits::{BrakingEnvelope, JointLimits};
use franka_model::{JointVector, joint_vector};

use crate::session::reference::Reference;

/// Share of the velocity limit above which every joint is braked, away from the ends of its range.
pub const ONSET: f64 = 0.85;

/// Speed by which a joint may be faster than its reference, `[rad/s]`: it swings less than that.
const FASTER: f64 = 0.1;

/// Distance by which a joint may be beyond its reference at an end of its range, `[rad]`.
const BEYOND: f64 = 0.02;

/// Rate at which [`FASTER`] decreases with the distance beyond that, `[1/s]`.
const RETURN: f64 = 10.0;

/// Envelope of robots without an envelope: the decelerations of the Franka Research 3. At
/// rest, a joint is fully held 3 to 17 mrad before its end.
const ENDS: BrakingEnvelope = BrakingEnvelope {
    deceleration: joint_vector([6.0, 2.585, 3.5, 4.0, 17.0, 5.5, 17.0]),
    offset: joint_vector([0.3; 7]),
};

/// Brakes the joints that are too fast. Returns true if there were any. `q` and `dq` are measured,
/// `[rad]` and `[rad/s]`; `most` is the torque of full braking, `[N m]`.
pub(crate) fn brake(
    tau: &JointVector,
    (q, dq): (&JointVector, &JointVector),
    reference: &Reference,
    limits: &JointLimits,
    most: &JointVector,
) -> (JointVector, bool) {
    let off = q - reference.q;
    // Most cycles end here, without an envelope: no joint is far enough beyond its reference, or
    // faster by enough, to be braked at any position.
    let follows = |i: usize| {
        let along = if dq[i] > 0.0 {
            reference.dq[i]
        } else {
            -reference.dq[i]
        };
        let ahead = (along.max(0.0) + FASTER).min(ONSET * limits.velocity[i]);
        off[i].abs() <= BEYOND && dq[i].abs() <= ahead
    };
    if (0..7).all(follows) {
        return (*tau, false);
    }
    let mut binds = false;
    let envelope = limits.envelope.as_ref().unwrap_or(&ENDS);
    let braked = JointVector::from_fn(|i, _| {
        let (limit, zone) = (limits.velocity[i], (1.0 - ONSET) * limits.velocity[i]);
        let (down, up) = (q[i] - limits.hard_lower[i], limits.hard_upper[i] - q[i]);
        let upwards = if dq[i].abs() < zone {
            up < down
        } else {
            dq[i] > 0.0
        };
        let (side, room) = if upwards { (1.0, up) } else { (-1.0, down) };
        let here = envelope.speed(i, room).min(limit);
        let beyond = (side * off[i] - BEYOND).max(0.0);
        let ahead = (side * reference.dq[i]).max(0.0) + FASTER - RETURN * beyond;
        let onset = (here - zone).max(ahead.min(ONSET * limit));
        if side * dq[i] <= onset {
            return tau[i];
        }
        binds = true;
        let width = (here - onset).max((1.0 - ONSET) * limit);
        let x = ((side * dq[i] - onset) / width).min(1.0);
        let share = x * x * (3.0 - 2.0 * x);
        tau[i] + share * (-most[i] * side - tau[i])
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
    use franka_model::{CYCLE, Model, READY};
    use proptest::prelude::*;

    /// The same limits at all positions.
    fn flat(limits: &JointLimits) -> JointLimits {
        JointLimits {
            envelope: Some(BrakingEnvelope {
                deceleration: JointVector::repeat(1e6),
                offset: JointVector::zeros(),
            }),
            ..*limits
        }
    }

    /// Brakes a joint with a limit of 2 rad/s that follows its reference.
    fn of(tau: f64, dq: f64) -> (f64, bool) {
        with_reference(tau, dq, dq)
    }

    fn with_reference(tau: f64, dq: f64, dq_ref: f64) -> (f64, bool) {
        let limits = JointLimits {
            velocity: JointVector::repeat(2.0),
            ..flat(Model::fr3().joint_limits())
        };
        let most = JointVector::repeat(50.0);
        let (tau, dq) = (JointVector::repeat(tau), JointVector::repeat(dq));
        let reference = Reference {
            dq: JointVector::repeat(dq_ref),
            ..Reference::at_rest(READY)
        };
        let (braked, binds) = brake(&tau, (&READY, &dq), &reference, &limits, &most);
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
        let still = Reference::at_rest(READY);
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
                let (tau, _) = brake(&(driving * side), (&READY, &dq), &still, &limits, &most);
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

    /// A push turns each joint from the middle of its range to its end, and holds it there. The
    /// reference follows on a leash.
    #[test]
    fn a_joint_that_is_pushed_to_its_end_stops_before_it() {
        let most = JointVector::from(Gains::TORQUE_LIMITS);
        let inertia = [1.0, 1.0, 1.0, 1.0, 0.2, 0.2, 0.1];
        let share = BlendedGains::new(&Gains::cartesian(), None).torque_share;
        let robots = [
            JointLimits::fr3_system_5_9(),
            Model::fr3().joint_limits(),
            Model::fer().joint_limits(),
        ];
        let joints = (0..7).flat_map(|i| [(i, 1.0), (i, -1.0)]);
        for (robot, (i, side)) in (0..3).flat_map(|robot| joints.clone().map(move |j| (robot, j))) {
            let limits = robots[robot];
            let push = if i < 4 { 15.0 } else { 4.0 } * side;
            let mut q = 0.5 * (limits.lower + limits.upper);
            let mut dq = JointVector::zeros();
            let mut last = JointVector::zeros();
            let mut reference = Reference::at_rest(q);
            for _ in 0..8000 {
                reference.q[i] = reference.q[i].clamp(q[i] - 0.1, q[i] + 0.1);
                let still = JointVector::zeros();
                let (tau, _) = brake(&still, (&q, &dq), &reference, limits, &most);
                let filtered = low_pass(share, &tau, &last);
                let (tau, _) = limit_rate(&filtered, &last, &limits.torque_rate);
                dq[i] += (last[i] + push) / inertia[i] * CYCLE;
                q[i] += dq[i] * CYCLE;
                last = tau;
                let (lower, upper) = limits.velocity_envelope(&q, 0.0);
                let most = if side > 0.0 { upper[i] } else { -lower[i] };
                let case = format!("robot {robot}, joint {} at {} rad", i + 1, q[i]);
                let speed = dq[i] * side;
                assert!(speed < most, "{case}: {speed} of {most} rad/s");
                assert!(limits.contains(&q), "{case}");
            }
            let (room, speed) = (limits.upper[i] - q[i], dq[i].abs());
            let room = room.min(q[i] - limits.lower[i]);
            assert!(room < 0.15, "joint {} stops {room} rad before", i + 1);
            assert!(speed < 1e-3, "joint {} at {speed} rad/s", i + 1);
        }
    }

    #[test]
    fn a_reference_that_follows_the_envelope_is_not_braked() {
        let limits = JointLimits::fr3_system_5_9();
        let mut follows = Reference::at_rest(JointVector::zeros());
        (follows.q[3], follows.dq[3]) = (-0.2, 0.4);
        let (q, dq) = (follows.q, follows.dq);
        assert!(dq[3] < limits.velocity_envelope(&q, 0.0).1[3]);
        let (tau, most) = (JointVector::repeat(5.0), JointVector::repeat(50.0));
        let with = |reference| brake(&tau, (&q, &dq), &reference, limits, &most);
        assert_eq!(with(follows), (tau, false));
        let (braked, binds) = with(Reference::at_rest(q));
        assert!(binds && braked[3] < 0.0, "{braked}");
    }

    #[test]
    fn a_joint_at_rest_at_its_end_is_held_only_beyond_its_reference() {
        for model in [Model::fr3(), Model::fer()] {
            let limits = model.joint_limits();
            let (q, still) = (limits.lower, JointVector::zeros());
            let (tau, most) = (JointVector::repeat(-5.0), JointVector::repeat(50.0));
            let with = |away: f64| {
                let reference = Reference::at_rest(q.add_scalar(away));
                brake(&tau, (&q, &still), &reference, limits, &most)
            };
            assert_eq!(with(-0.1), (tau, false));
            assert_eq!(with(BEYOND), (tau, false));
            let (held, binds) = with(0.1);
            assert!(binds && held.min() > 30.0, "{held}");
        }
    }
}

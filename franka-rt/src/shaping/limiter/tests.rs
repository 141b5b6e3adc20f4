//! Tests that limited commands keep the bounds for any input. Each test walks from rest, and every
//! result is the last value of the next step.

use franka_model::limits::{CartesianLimits, JointLimits, MotionLimits};
use franka_model::{JointVector, READY, RobotKind, Twist, rotation, transform};
use nalgebra::{Isometry3, Vector3};
use proptest::prelude::*;

use super::*;
use crate::shaping::{Bounds, CYCLE};

/// Generates shares of a bound to command: moderate, far outside, so large that squares overflow,
/// and tiny.
fn share() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => -1.5..1.5,
        3 => -100.0..100.0,
        1 => prop_oneof![Just(1e290), Just(-1e290), Just(1e-300), Just(0.0)],
    ]
}

/// Generates commands of `N` shares each, every one held for some steps; about 300 steps in all.
fn commands<const N: usize>(
    share: impl Strategy<Value = f64>,
) -> impl Strategy<Value = Vec<[f64; N]>> {
    let command = prop::array::uniform(share);
    prop::collection::vec((command, 1..60_usize), 1..20).prop_map(|held| {
        let steps = held.into_iter();
        steps.flat_map(|(c, n)| std::iter::repeat_n(c, n)).collect()
    })
}

fn robot() -> impl Strategy<Value = (RobotKind, Bounds)> {
    prop_oneof![
        Just((RobotKind::Fr3, Bounds::fr3())),
        Just((RobotKind::Fer, Bounds::fer())),
    ]
}

/// The last values of a vector of one, three or more coordinates.
#[derive(Clone, Copy, Debug)]
struct Last<const N: usize> {
    velocity: [f64; N],
    acceleration: [f64; N],
}

impl<const N: usize> Last<N> {
    const AT_REST: Self = Self {
        velocity: [0.0; N],
        acceleration: [0.0; N],
    };

    /// Advances to the next velocity and returns the jerk that leads to it.
    fn advance(&mut self, velocity: [f64; N]) -> [f64; N] {
        let rate =
            |new: [f64; N], old: [f64; N]| core::array::from_fn(|i| (new[i] - old[i]) / CYCLE);
        let acceleration = rate(velocity, self.velocity);
        let jerk = rate(acceleration, self.acceleration);
        *self = Self {
            velocity,
            acceleration,
        };
        jerk
    }
}

/// Returns the norms of the linear and the angular part of a twist or of its derivatives.
fn norms(twist: &[f64; 6]) -> [f64; 2] {
    let twist = Twist::from(*twist);
    [
        twist.fixed_rows::<3>(0).norm(),
        twist.fixed_rows::<3>(3).norm(),
    ]
}

/// Returns the nominal limits of both parts, which the robot checks. Their distance from the bounds
/// is room for rounding.
fn halves(limits: &CartesianLimits) -> [MotionLimits; 2] {
    [limits.translation, limits.rotation]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

    #[test]
    fn torques_keep_their_rate(
        command in prop::array::uniform7(prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL),
        last in prop::array::uniform7(-87.0..87.0),
        (kind, bounds) in robot(),
    ) {
        let limited = torques(&command, &last, &bounds.torque_rate)?;
        let limit = JointLimits::of(kind).torque_rate;
        for i in 0..7 {
            prop_assert!((limited[i] - last[i]).abs() / CYCLE <= limit[i]);
        }
    }

    #[test]
    fn rate_within_the_echo_keeps_the_limit_of_sent_torque(
        wish in -200.0..200.0_f64,
        sent in -87.0..87.0_f64,
    ) {
        let echo = f64::from(sent as f32);
        let (next, _) = limit_rate(wish, echo, within_echo(999.999, echo));
        prop_assert!(f64::abs(next - sent) / CYCLE <= 1000.0);
    }

    #[test]
    fn joint_velocities_keep_velocity_acceleration_and_jerk(
        shares in commands::<7>(share()),
        (kind, bounds) in robot(),
    ) {
        let limits = JointLimits::of(kind);
        let joints = bounds.joints_at(&READY.into());
        let (lower, upper) = limits.velocity_envelope(&READY, 0.0);
        let mut last = Last::<7>::AT_REST;
        for shares in shares {
            let command = core::array::from_fn(|i| shares[i] * limits.velocity[i]);
            let dq = joint_velocities(&joints, &command, &last.velocity, &last.acceleration)?;
            let jerk = last.advance(dq);
            for i in 0..7 {
                prop_assert!(lower[i] < dq[i] && dq[i] < upper[i]);
                prop_assert!(last.acceleration[i].abs() < limits.acceleration[i]);
                prop_assert!(jerk[i].abs() < limits.jerk[i]);
            }
        }
    }

    /// As in libfranka, the jerk exceeds its bound where the envelope reduces the velocity faster
    /// than the jerk bound allows.
    #[test]
    fn joint_positions_keep_limits_and_jerk_without_envelope(
        shares in commands::<7>(share()),
        (kind, bounds) in robot(),
    ) {
        let limits = JointLimits::of(kind);
        let mut q: [f64; 7] = READY.into();
        let mut last = Last::<7>::AT_REST;
        for shares in shares {
            let command = core::array::from_fn(|i| q[i] + shares[i] * limits.velocity[i] * CYCLE);
            let joints = bounds.joints_at(&q);
            let next =
                joint_positions(&joints, &command, &q, &last.velocity, &last.acceleration)?;
            let dq = core::array::from_fn(|i| (next[i] - q[i]) / CYCLE);
            let jerk = last.advance(dq);
            for i in 0..7 {
                prop_assert!(dq[i].abs() < limits.velocity[i]);
                prop_assert!(last.acceleration[i].abs() < limits.acceleration[i]);
                prop_assert!(jerk[i].abs() < limits.jerk[i] || limits.envelope.is_some());
            }
            q = next;
        }
    }

    /// As in libfranka, a vector that turns at its velocity bound may exceed the jerk bound.
    #[test]
    fn twists_keep_velocity_and_acceleration(
        shares in commands::<6>(share()),
        (kind, bounds) in robot(),
    ) {
        let limits = halves(CartesianLimits::of(kind));
        let mut last = Last::<6>::AT_REST;
        for shares in shares {
            let command = core::array::from_fn(|i| shares[i] * limits[i / 3].velocity);
            let next = cartesian_velocity(
                &bounds.cartesian, &command, &last.velocity, &last.acceleration,
            )?;
            last.advance(next);
            for (half, limits) in limits.iter().enumerate() {
                prop_assert!(norms(&last.velocity)[half] < limits.velocity);
                prop_assert!(norms(&last.acceleration)[half] < limits.acceleration);
            }
        }
    }

    #[test]
    fn twists_away_from_the_bound_of_the_velocity_keep_the_jerk_too(
        shares in commands::<6>(-0.5..0.5),
        (kind, bounds) in robot(),
    ) {
        let limits = halves(CartesianLimits::of(kind));
        let mut last = Last::<6>::AT_REST;
        for shares in shares {
            let command = core::array::from_fn(|i| shares[i] * limits[i / 3].velocity);
            let next = cartesian_velocity(
                &bounds.cartesian, &command, &last.velocity, &last.acceleration,
            )?;
            let jerk = last.advance(next);
            for (half, limits) in limits.iter().enumerate() {
                prop_assert!(norms(&jerk)[half] < limits.jerk);
            }
        }
    }

    /// As in the robot, the last values are derived from the poses.
    #[test]
    fn poses_keep_velocity_and_acceleration_and_stay_poses(
        shares in commands::<6>(-2.0..2.0),
        (kind, bounds) in robot(),
    ) {
        let limits = halves(CartesianLimits::of(kind));
        let mut pose = Isometry3::translation(0.3, -0.1, 0.5);
        let mut last = Last::<6>::AT_REST;
        for shares in shares {
            let step = |i: usize| shares[i] * limits[i / 3].velocity * CYCLE;
            let command = Isometry3::from_parts(
                (pose.translation.vector + Vector3::new(step(0), step(1), step(2))).into(),
                rotation::exp(&Vector3::new(step(3), step(4), step(5))) * pose.rotation,
            );
            let next = cartesian_pose(
                &bounds.cartesian,
                &transform::array(&command),
                &transform::array(&pose),
                &last.velocity,
                &last.acceleration,
            )?;
            let next = transform::isometry_from_array(&next);
            let next = next.ok_or_else(|| TestCaseError::fail("no pose"))?;
            let v = (next.translation.vector - pose.translation.vector) / CYCLE;
            let w = rotation::error(&next.rotation, &pose.rotation) / CYCLE;
            last.advance([v.x, v.y, v.z, w.x, w.y, w.z]);
            for (half, limits) in limits.iter().enumerate() {
                prop_assert!(norms(&last.velocity)[half] < limits.velocity);
                prop_assert!(norms(&last.acceleration)[half] < limits.acceleration);
            }
            pose = next;
        }
    }
}

/// Drives every joint of the FR3 towards the end of its range, upwards or downwards. Returns the
/// position of each joint after six seconds, `[rad]`, and by how much it exceeded its envelope,
/// `[rad/s]`.
fn against_the_end(direction: f64) -> ([f64; 7], [f64; 7]) {
    let limits = JointLimits::of(RobotKind::Fr3);
    let bounds = Bounds::fr3();
    let mut q: [f64; 7] = READY.into();
    let mut last = Last::<7>::AT_REST;
    let mut excess = [0.0_f64; 7];
    for _ in 0..6000 {
        let joints = bounds.joints_at(&q);
        let command = [direction * 10.0; 7];
        let next = joint_positions(&joints, &command, &q, &last.velocity, &last.acceleration)
            .expect("the command is finite");
        last.advance(core::array::from_fn(|i| (next[i] - q[i]) / CYCLE));
        let (lower, upper) = limits.velocity_envelope(&JointVector::from(q), 0.0);
        for (i, excess) in excess.iter_mut().enumerate() {
            let dq = last.velocity[i];
            *excess = excess.max(dq - upper[i]).max(lower[i] - dq);
        }
        q = next;
    }
    (q, excess)
}

/// The envelope and its slope change within a cycle, so the limiter lags by some mrad/s.
#[test]
fn a_joint_sent_against_the_end_of_its_range_stops_before_it() {
    let limits = JointLimits::of(RobotKind::Fr3);
    for direction in [1.0, -1.0] {
        let (q, excess) = against_the_end(direction);
        for i in [0, 1, 2, 3, 5] {
            assert!(limits.hard_lower[i] < q[i] && q[i] < limits.hard_upper[i]);
            assert!(excess[i] < 0.005, "joint {}: {}", i + 1, excess[i]);
        }
    }
}

/// As the module documents, the limiter keeps the acceleration bound upwards, but exceeds it
/// downwards.
#[test]
fn joints_5_and_7_of_the_fr3_pass_their_upper_end() {
    let limits = JointLimits::of(RobotKind::Fr3);
    for i in [4, 6] {
        let ((up, excess_up), (down, excess_down)) = (against_the_end(1.0), against_the_end(-1.0));
        assert!(up[i] > limits.hard_upper[i] && excess_up[i] > 1.0);
        assert!(down[i] > limits.hard_lower[i] && excess_down[i] < 0.02);
    }
}

#[test]
fn velocity_keeps_acceleration_above_bounds_but_not_below() {
    let bounds = AxisBounds {
        upper_velocity: 1.0,
        lower_velocity: -1.0,
        acceleration: 10.0,
        jerk: 5000.0,
    };
    assert_eq!(velocity(&bounds, 2.0, 2.0, 0.0), Ok(2.0 - 10.0 * CYCLE));
    assert_eq!(velocity(&bounds, -2.0, -2.0, 0.0), Ok(-2.0 + 500.0 * CYCLE));
    // The lower bound is applied last, so it takes precedence where the limiter cannot keep both.
    let turned = AxisBounds {
        upper_velocity: -1.0,
        lower_velocity: 1.0,
        ..bounds
    };
    assert_eq!(velocity(&turned, 0.0, 0.0, 0.0), Ok(500.0 * CYCLE));
}

#[test]
fn vector_far_beyond_velocity_bound_keeps_only_jerk_bound() {
    // No acceleration perpendicular to the last velocity leads back into the sphere, so its
    // distance is NaN.
    let bounds = Bounds::fr3().cartesian;
    let last = [10.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let acceleration = [0.0, 20.0, 0.0, 0.0, 0.0, 0.0];
    let held = [10.0, 0.02, 0.0, 0.0, 0.0, 0.0];
    let next = cartesian_velocity(&bounds, &held, &last, &acceleration).unwrap();
    assert!((next[1] - 0.02).abs() < 1e-15, "{next:?}");
}

#[test]
fn vector_with_nan_acceleration_keeps_its_velocity() {
    let bounds = Bounds::fr3().cartesian;
    let last = [0.1, 0.2, 0.3, 0.0, 0.0, 0.0];
    let acceleration = [0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0];
    let next = cartesian_velocity(&bounds, &[0.0; 6], &last, &acceleration);
    assert_eq!(next, Ok(last));
}

#[test]
fn an_echo_too_large_for_the_rate_leaves_none() {
    assert_eq!(within_echo(999.999, 1e30), 0.0);
    assert_eq!(
        limit_rate(5.0, 1e30, within_echo(999.999, 1e30)),
        (1e30, true)
    );
    assert!(within_echo(999.999, f64::NAN).is_nan());
}

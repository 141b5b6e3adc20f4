//! Approach of a joint to a target near the end of its range.
//!
//! The nearer a joint is to the end of its range, the less speed the robot allows. The limit is the
//! braking parabola of its velocity envelope, minus an offset. Consider a plan that brakes with
//! constant deceleration to a target at the distance `room` from that end. It stays inside the
//! envelope if, at every speed `v` while it brakes,
//!
//! ```text
//! (v + offset)^2 / (2 envelope deceleration)  <=  v^2 / (2 plan acceleration) + room
//! ```
//!
//! The left side is the distance that the envelope requires for a stop. The right side is the
//! distance that the plan has. If a plan violates this condition, it must brake more gently: with
//! `acceleration <= deceleration - offset^2 / (2 room)`, the condition holds at every speed. Within
//! some milliradians of the end of the range, no acceleration is low enough.

use franka_model::limits::JointLimits;
use franka_otg::AxisLimits;

/// Speed margin to the envelope, `[rad/s]`. It is needed because the measured velocity differs
/// slightly from the plan's velocity.
const MARGIN: f64 = 0.02;

/// Least acceleration of a plan, `[rad/s^2]`. A target that requires a gentler approach is refused.
const GENTLEST: f64 = 0.3;

/// Returns the limits of a plan from `q` to `target`, reduced if the target is near the end of the
/// joint's range.
pub(super) fn limits(
    i: usize,
    robot: &JointLimits,
    q: f64,
    target: f64,
    plan: AxisLimits,
) -> AxisLimits {
    let Some(envelope) = &robot.envelope else {
        return plan;
    };
    let room = if target >= q {
        robot.hard_upper[i] - target
    } else {
        target - robot.hard_lower[i]
    };
    let (deceleration, offset) = (envelope.deceleration[i], envelope.offset[i] + MARGIN);
    if keeps(deceleration, offset, room, &plan) {
        return plan;
    }
    let gentle = deceleration - 0.5 * offset * offset / room.max(f64::MIN_POSITIVE);
    AxisLimits {
        acceleration: plan.acceleration.min(gentle.max(GENTLEST)),
        ..plan
    }
}

/// Returns the joint targets that sessions accept: the lowest and the highest position of each
/// joint, `[rad]`. They are the joint's own range, minus some milliradians in which its velocity
/// envelope allows no speed.
pub fn target_range(robot: &JointLimits) -> [(f64, f64); 7] {
    core::array::from_fn(|i| range(i, robot))
}

/// Same as [`target_range`], for plans that brake with these accelerations, `[rad/s^2]`, and do not
/// brake more gently near the end of a range.
pub fn target_range_of(robot: &JointLimits, acceleration: &[f64; 7]) -> [(f64, f64); 7] {
    core::array::from_fn(|i| range_of(i, robot, acceleration[i]))
}

/// Returns the range of targets that plans can approach, `[rad]`. If the range is empty, both its
/// ends are the middle of the joint's range.
pub(super) fn range(i: usize, robot: &JointLimits) -> (f64, f64) {
    range_of(i, robot, GENTLEST)
}

fn range_of(i: usize, robot: &JointLimits, acceleration: f64) -> (f64, f64) {
    let room = robot.envelope.as_ref().map_or(0.0, |envelope| {
        let offset = envelope.offset[i] + MARGIN;
        // If the envelope's deceleration does not exceed the plan's, no range is left.
        0.5 * offset * offset / (envelope.deceleration[i] - acceleration).max(f64::MIN_POSITIVE)
    });
    let lower = robot.lower[i].max(robot.hard_lower[i] + room);
    let upper = robot.upper[i].min(robot.hard_upper[i] - room);
    if lower <= upper {
        return (lower, upper);
    }
    let middle = 0.5 * (robot.hard_lower[i] + robot.hard_upper[i]);
    (middle, middle)
}

/// True if `plan`, while it brakes, stays inside the envelope at every speed up to its own.
fn keeps(deceleration: f64, offset: f64, room: f64, plan: &AxisLimits) -> bool {
    let excess = |v: f64| {
        0.5 * (v + offset) * (v + offset) / deceleration - 0.5 * v * v / plan.acceleration - room
    };
    // The excess is a parabola in the speed. If the parabola opens downward, its maximum is here.
    // Otherwise the maximum is at an end of the interval.
    let closest = offset * plan.acceleration / (deceleration - plan.acceleration);
    let inside = closest > 0.0 && closest < plan.velocity;
    excess(0.0) <= 0.0 && excess(plan.velocity) <= 0.0 && !(inside && excess(closest) > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::{Model, READY};

    /// Returns the speed margin between the envelope and a plan that brakes to `target`, `[rad/s]`.
    /// Negative beyond the envelope.
    fn clearance(i: usize, target: f64, plan: &AxisLimits) -> f64 {
        let limits = Model::fr3().joint_limits();
        let top = plan.velocity.min(limits.velocity[i] - MARGIN);
        let at = |step: i32| {
            let v = top * f64::from(step) / 1000.0;
            let mut q = READY;
            q[i] = target - v * v / (2.0 * plan.acceleration);
            limits.velocity_envelope(&q, MARGIN).1[i] - v
        };
        (0..=1000).map(at).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn braking_stays_in_envelope_and_no_gentler_than_needed() {
        let robot = Model::fr3().joint_limits();
        let mut gentler = 0;
        for i in 0..7 {
            for acceleration in [0.5, 2.0, 10.0] {
                for velocity in [0.3, 2.0] {
                    for room in [0.02, 0.05, 0.2, 1.0] {
                        let target = robot.hard_upper[i] - room;
                        let plan = AxisLimits {
                            velocity,
                            acceleration,
                            jerk: 1000.0,
                        };
                        let made = limits(i, robot, READY[i], target, plan);
                        let case = (i + 1, plan, room, made);
                        assert!(clearance(i, target, &made) > -1e-9, "{case:?}");
                        if made != plan {
                            gentler += 1;
                            assert!(clearance(i, target, &plan) < 0.0, "{case:?}");
                        }
                    }
                }
            }
        }
        assert!(gentler > 20, "{gentler} plans were too fast");
    }

    #[test]
    fn range_of_plans_leaves_them_inside_the_envelope() {
        let robot = Model::fr3().joint_limits();
        let envelope = robot.envelope.as_ref().expect("one");
        for share in [0.1, 0.6, 0.9] {
            let acceleration = (envelope.deceleration * share).data.0[0];
            for (i, (_, upper)) in target_range_of(robot, &acceleration)
                .into_iter()
                .enumerate()
            {
                let plan = AxisLimits {
                    velocity: robot.velocity[i],
                    acceleration: acceleration[i],
                    jerk: 1000.0,
                };
                assert!(clearance(i, upper, &plan) > -1e-9, "joint {}", i + 1);
                if share < 0.9 && upper < robot.upper[i] - 1e-9 {
                    // The range is as large as possible.
                    assert!(clearance(i, upper + 1e-3, &plan) < 0.0, "joint {}", i + 1);
                }
            }
        }
    }

    #[test]
    fn a_range_without_room_is_its_middle() {
        let mut robot = *Model::fr3().joint_limits();
        (robot.hard_lower[0], robot.hard_upper[0]) = (1.0, 1.01);
        (robot.lower[0], robot.upper[0]) = (1.006, 1.004);
        assert_eq!(range(0, &robot), (1.005, 1.005));
        let mut robot = *Model::fr3().joint_limits();
        robot.envelope.as_mut().expect("one").deceleration[2] = GENTLEST;
        assert_eq!(range(2, &robot), (0.0, 0.0));
    }

    #[test]
    fn range_shrinks_slightly_unless_the_envelope_is_flat() {
        let robot = Model::fr3().joint_limits();
        for i in 0..7 {
            let (lower, upper) = range(i, robot);
            assert!(robot.upper[i] - upper < 0.012 && lower - robot.lower[i] < 0.012);
            let plan = AxisLimits {
                velocity: 0.5,
                acceleration: 2.0,
                jerk: 1000.0,
            };
            for end in [lower, upper] {
                let made = limits(i, robot, READY[i], end, plan);
                assert!(made.acceleration >= GENTLEST);
            }
            assert!(clearance(i, upper, &limits(i, robot, READY[i], upper, plan)) > -1e-9);
        }
        let flat = Model::fer().joint_limits();
        assert_eq!(range(0, flat), (flat.lower[0], flat.upper[0]));
    }
}

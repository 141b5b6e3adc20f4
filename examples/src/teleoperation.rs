//! Targets for [`Arm::follow`](franka_async::Arm::follow) from the devices of a person.

// ANCHOR: moved
use franka_async::Pose;
use franka_async::model::Twist;
use nalgebra::UnitQuaternion;

/// The target stays in this box, `[m]`, and the hand within some millimetres of it.
const LOW: [f64; 3] = [0.35, -0.25, 0.25];
const HIGH: [f64; 3] = [0.55, 0.25, 0.6];
/// Velocity per distance to the side of the box, `[1/s]`.
const SLOWING: f64 = 4.0;
/// Lead of the target over the hand at most, `[m]` and `[rad]`.
const AHEAD: (f64, f64) = (0.05, 0.2);

/// Returns the next target and its velocity, after `seconds` (above zero) of `velocity` in base
/// axes. `hand` is `robot.pose()`. Returns `None` if the device reports numbers that are not
/// finite.
pub fn moved(target: &Pose, velocity: &Twist, seconds: f64, hand: &Pose) -> Option<(Pose, Twist)> {
    if !velocity.iter().all(|v| v.is_finite()) {
        return None;
    }
    let mut twist = *velocity;
    for i in 0..3 {
        // Slower towards the sides of the box; from outside only back.
        let at = target.translation.vector[i];
        let (least, most) = (SLOWING * (LOW[i] - at), SLOWING * (HIGH[i] - at));
        twist[i] = twist[i].clamp(least.min(0.0), most.max(0.0));
    }
    let step = twist * seconds;
    let lead = target.translation.vector - hand.translation.vector;
    let turn = target.rotation / hand.rotation;
    // The step is cut short where it leads further ahead. A hand that is elsewhere does not draw
    // the target along.
    let shift = (lead + step.fixed_rows::<3>(0)).cap_magnitude(lead.norm().max(AHEAD.0));
    let turned = UnitQuaternion::from_scaled_axis(step.fixed_rows::<3>(3).into_owned()) * turn;
    let turned = turned
        .scaled_axis()
        .cap_magnitude(turn.angle().max(AHEAD.1));
    let rotation = UnitQuaternion::from_scaled_axis(turned) * hand.rotation;
    let next = Pose::from_parts((hand.translation.vector + shift).into(), rotation);
    // The velocity of what is left of the step.
    let moved = next.translation.vector - target.translation.vector;
    let turned = (next.rotation / target.rotation).scaled_axis();
    twist.fixed_rows_mut::<3>(0).copy_from(&(moved / seconds));
    twist.fixed_rows_mut::<3>(3).copy_from(&(turned / seconds));
    Some((next, twist))
}
// ANCHOR_END: moved

// ANCHOR: clutched
/// Returns the target for a tracked controller at `now`, in base axes. `hand` is `robot.pose()`,
/// and `then` the controller's pose, both from when the clutch was pressed.
pub fn clutched(hand: &Pose, then: &Pose, now: &Pose) -> Pose {
    let shift = now.translation.vector - then.translation.vector;
    let turn = now.rotation * then.rotation.inverse();
    Pose::from_parts(
        (hand.translation.vector + shift).into(),
        turn * hand.rotation,
    )
}
// ANCHOR_END: clutched

#[cfg(test)]
mod tests {
    use super::*;

    const AHEAD_IN_X: Twist = Twist::new(0.2, 0.0, 0.0, 0.0, 0.0, 0.1);

    #[test]
    fn target_slows_down_before_the_side_of_the_box() {
        let (mut target, mut slowest) = (Pose::translation(0.45, 0.0, 0.4), 0.2_f64);
        for _ in 0..600 {
            let (next, twist) = moved(&target, &AHEAD_IN_X, 1.0 / 60.0, &target).expect("finite");
            assert!(twist[0] <= slowest + 1e-9 && next.translation.x <= HIGH[0]);
            (target, slowest) = (next, twist[0]);
        }
        assert!(target.translation.x > HIGH[0] - 1e-3 && slowest < 1e-3);
        assert!((target.rotation.angle() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn target_waits_for_a_hand_that_is_held() {
        let hand = Pose::translation(0.45, 0.0, 0.4);
        let (mut target, mut speed) = (hand, 1.0);
        for _ in 0..600 {
            let (next, twist) = moved(&target, &AHEAD_IN_X, 1.0 / 60.0, &hand).expect("finite");
            (target, speed) = (next, twist.amax());
        }
        let lead = target.translation.x - hand.translation.x;
        assert!((lead - AHEAD.0).abs() < 1e-9 && speed < 1e-9);
        assert!((target.rotation.angle() - AHEAD.1).abs() < 1e-9);
    }

    #[test]
    fn target_is_not_drawn_along_by_a_hand_elsewhere() {
        let hand = Pose::translation(0.45, 0.0, 0.4);
        let aside = Pose::translation(0.45, 0.2, 0.4);
        let (next, twist) = moved(&aside, &Twist::zeros(), 0.01, &hand).expect("finite");
        assert!((next.translation.y - 0.2).abs() < 1e-9 && twist.amax() < 1e-9);
    }

    #[test]
    fn target_outside_of_the_box_only_moves_back() {
        let outside = Pose::translation(0.7, 0.0, 0.4);
        let speed = |velocity: Twist| {
            let (_, twist) = moved(&outside, &velocity, 0.01, &outside).expect("finite");
            twist[0]
        };
        assert!(speed(AHEAD_IN_X).abs() < 1e-9 && (speed(-AHEAD_IN_X) + 0.2).abs() < 1e-9);
    }

    #[test]
    fn velocity_that_is_not_finite_has_no_target() {
        let hand = Pose::translation(0.45, 0.0, 0.4);
        assert!(moved(&hand, &(AHEAD_IN_X * f64::NAN), 0.01, &hand).is_none());
    }

    #[test]
    fn clutched_hand_moves_as_the_controller_does() {
        let hand = Pose::translation(0.4, 0.0, 0.4);
        let turn = |yaw| UnitQuaternion::from_euler_angles(0.0, 0.0, yaw);
        let then = Pose::from_parts([1.0, 2.0, 3.0].into(), turn(1.0));
        let held = clutched(&hand, &then, &then);
        assert!((held.translation.vector - hand.translation.vector).norm() < 1e-12);
        let now = Pose::from_parts([1.1, 2.0, 3.0].into(), turn(1.5));
        let target = clutched(&hand, &then, &now);
        assert!((target.translation.x - 0.5).abs() < 1e-12);
        assert!((target.rotation.angle() - 0.5).abs() < 1e-12);
    }
}

//! Programs without async.

use std::time::Duration;

use franka_async::blocking::Wait;
use franka_async::error::{GoalError, PoseError};
use franka_async::nalgebra::Translation3;
use franka_async::{Engage, MotionError, Offset, Pose};

use crate::{alone, long_way, simulated};

#[test]
fn a_plain_thread_waits_for_whatever_can_be_awaited() {
    let _alone = alone();
    let (robot, _sim) = simulated().wait();
    let start = robot.pose();
    let up = Pose::translation(0.0, 0.0, 0.02) * start;
    robot.move_to(up).wait().unwrap();
    assert!(PoseError::between(&robot.pose(), &up).translation < 1e-3);

    let late = long_way(&robot).wait_for(Duration::from_millis(1));
    assert_eq!(late, None, "dropped, and so braked");
    robot.stop().wait().unwrap();
    assert!(!robot.state().motion_running());
    robot.shutdown().wait();
    let closed = robot.move_to(up).wait().unwrap_err();
    assert!(
        matches!(closed, MotionError::ConnectionClosed { .. }),
        "{closed}"
    );
}

#[test]
fn goals_are_set_without_waiting_and_the_newest_counts() {
    let _alone = alone();
    let (robot, _sim) = simulated().wait();
    let start = robot.pose();
    let arm = robot.engage(Engage::default()).wait().unwrap();
    let at = |step: u32| Pose::translation(0.0, 0.02e-3 * f64::from(step), 0.0) * start;
    for step in 0..=2000 {
        arm.try_set(at(step)).unwrap();
    }
    // Taken in order with what waits: the ones before have been taken by then.
    arm.set(Offset::base(Translation3::identity()))
        .wait()
        .unwrap();
    arm.at_rest().wait().unwrap();
    let error = PoseError::between(&robot.pose(), &at(2000));
    assert!(error.translation < 1e-3, "{error:?}");

    let far = Pose::translation(5.0, 0.0, 0.0) * start;
    let refused = arm.try_set(far).unwrap_err();
    assert!(
        matches!(refused, MotionError::Goal(GoalError::Unreachable { .. })),
        "{refused}"
    );
    let other = arm.clone();
    arm.disengage().wait().unwrap();
    assert_eq!(other.try_set(start), Err(MotionError::Disengaged));
    robot.shutdown().wait();
}

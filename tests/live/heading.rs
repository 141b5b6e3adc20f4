//! Information for a program about a motion under way, and goals relative to it.

use std::time::Duration;

use franka_async::error::{PathError, PoseError};
use franka_async::goal::{Destination, Target, Waypoint};
use franka_async::motion::{Progress, Reference};
use franka_async::nalgebra::{Translation3, UnitQuaternion};
use franka_async::{Engage, MotionError, Offset, Pose, Robot};
use franka_sim::{Sim, Tool};

use crate::{SOON, alone, at_the_clients_pace, by_the_clock, shown};

/// A little more than half of the step of a position in single precision.
const NEAR: f64 = 1e-6;

fn close(pose: &Pose, expected: &Pose) -> bool {
    let error = PoseError::between(pose, expected);
    error.translation < NEAR && error.rotation < NEAR
}

#[tokio::test(flavor = "multi_thread")]
async fn offsets_add_up_from_target_to_target() {
    let _alone = alone();
    let sim = Sim::fr3().tool(Tool::hand());
    let (robot, _sim) = at_the_clients_pace(sim).await;
    let start = robot.pose();
    let arm = robot.engage(Engage::default()).await.unwrap();
    arm.set(start).await.unwrap();
    assert_eq!(arm.target(), Some(Target::Pose(start)));
    // Each of them at once, while the arm has not followed the previous one.
    let step = Translation3::new(0.0, 0.01, 0.0);
    for _ in 0..5 {
        arm.set(Offset::base(step)).await.unwrap();
    }
    let expected = Pose::translation(0.0, 0.05, 0.0) * start;
    let Some(Target::Pose(target)) = arm.target() else {
        panic!("{:?}", arm.target());
    };
    assert!(close(&target, &expected), "{target:?}");
    // A dropped future changes nothing. Every state wakes it, so the number of wake-ups depends on
    // the machine.
    let dropped = tokio::time::timeout(Duration::ZERO, arm.at_rest()).await;
    assert!(dropped.is_err(), "under way");
    arm.at_rest().await.unwrap();
    let reference = shown(&robot, || arm.reference()).await;
    assert!(close(&reference.pose, &expected), "{reference:?}");
    assert!(
        reference.dq.iter().all(|dq| dq.abs() < 1e-9),
        "{reference:?}"
    );
    // A real arm is not quite there.
    let off = PoseError::between(&robot.pose(), &expected);
    assert!(off.translation < 1e-3, "{off:?}");

    let report = arm
        .move_by(Offset::tool(Translation3::new(0.0, 0.0, 0.03)))
        .await;
    report.unwrap();
    let lower = expected * Translation3::new(0.0, 0.0, 0.03);
    arm.move_to(Destination::position(start.translation.vector))
        .await
        .unwrap();
    let turned = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.2) * start.rotation;
    arm.move_to(Destination::orientation(turned)).await.unwrap();
    let expected = Pose::from_parts(start.translation, turned);
    let Some(Target::Pose(target)) = arm.target() else {
        panic!("{:?}", arm.target());
    };
    assert!(close(&target, &expected), "{target:?}, by way of {lower:?}");

    // From the arm, a zero offset leads to the arm's position.
    arm.set(Offset::base(Translation3::identity()).from_arm())
        .await
        .unwrap();
    arm.disengage().await.unwrap();
    assert_eq!(robot.reference(), None);
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn an_arm_that_is_disengaged_has_no_target_and_does_not_rest() {
    let _alone = alone();
    let (robot, _sim) = by_the_clock(ideal()).await;
    let arm = robot.engage(Engage::default().speed(SLOW)).await.unwrap();
    let other = arm.clone();
    let resting = tokio::spawn({
        let arm = arm.clone();
        async move {
            arm.set(Offset::base(Translation3::new(0.0, 0.2, 0.0)))
                .await?;
            arm.at_rest().await
        }
    });
    shown(&robot, || arm.reference().filter(is_moving)).await;
    arm.disengage().await.unwrap();
    assert_eq!(resting.await.unwrap(), Err(MotionError::Disengaged));
    assert_eq!((other.target(), other.reference()), (None, None));
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_handle_tells_how_far_a_motion_is_and_pauses_it() {
    let _alone = alone();
    let (robot, _sim) = by_the_clock(ideal()).await;
    let way = Offset::base(Translation3::new(0.0, 0.2, 0.0));
    let motion = robot.move_by(way).speed(SLOW);
    let handle = motion.handle();
    assert_eq!(handle.progress(), None, "not begun");
    handle.pause();
    let moving = tokio::spawn(motion.into_future());
    shown(&robot, || handle.progress()).await;
    stands(&robot).await;

    handle.resume();
    let under_way = |progress: &Progress| !progress.remaining.is_zero();
    let begun = shown(&robot, || handle.progress().filter(under_way)).await;
    assert!(begun.remaining > SOON, "{begun:?}");
    let further = |progress: &Progress| progress.fraction() > begun.fraction();
    shown(&robot, || handle.progress().filter(further)).await;

    handle.pause();
    let over = |progress: &Progress| progress.remaining.is_zero();
    shown(&robot, || handle.progress().filter(over)).await;
    stands(&robot).await;
    handle.resume();
    shown(&robot, || robot.reference().filter(is_moving)).await;
    handle.cancel();
    assert_eq!(moving.await.unwrap(), Err(MotionError::Stopped));
    assert_eq!(handle.progress(), None, "over");

    let motion = robot.move_by(Offset::base(Translation3::new(0.0, 0.02, 0.0)));
    let handle = motion.handle();
    handle.pause();
    let moving = tokio::spawn(motion.into_future());
    shown(&robot, || handle.progress()).await;
    handle.resume();
    moving.await.unwrap().expect("it arrives");
    assert_eq!(handle.progress(), None, "over");
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_motion_goes_through_several_places_with_one_outcome() {
    let _alone = alone();
    let (robot, _sim) = by_the_clock(ideal()).await;
    let start = robot.pose();
    let over = |y: f64, z: f64| Translation3::new(0.0, y, z) * start;
    let corner = Waypoint::new(over(0.05, 0.0)).blend(0.02);
    let report = robot.move_through([corner, over(0.05, 0.05).into()]).await;
    let off = report.unwrap().final_error.expect("it went to a pose");
    assert!(off.translation < 1e-3, "{off:?}");

    let arm = robot.engage(Engage::default()).await.unwrap();
    let [near, far] = [over(0.0, 0.05), Translation3::new(2.0, 0.0, 0.0) * start];
    let refused = arm.move_through([near, far]).await.unwrap_err();
    let MotionError::Path(PathError::Waypoint { waypoint: 2, .. }) = refused else {
        panic!("{refused:?}");
    };
    let motion = arm.move_through([corner, near.into()]).speed(SLOW);
    let handle = motion.handle();
    let moving = tokio::spawn(motion.into_future());
    let under_way = |progress: &Progress| !progress.remaining.is_zero();
    let begun = shown(&robot, || handle.progress().filter(under_way)).await;
    assert!(begun.remaining > SOON, "{begun:?}");
    assert_eq!(arm.target(), Some(Target::Pose(near)));
    handle.cancel();
    assert_eq!(moving.await.unwrap(), Err(MotionError::Stopped));
    // Dropped on its way, it brakes, and the arm is held.
    let dropped = arm.move_through([corner, over(0.05, 0.1).into()]);
    tokio::select! {
        ended = dropped.speed(SLOW).into_future() => panic!("{ended:?}"),
        _ = shown(&robot, || arm.reference().filter(is_moving)) => {}
    }
    arm.move_to(start).await.unwrap();
}

fn ideal() -> Sim {
    Sim::fr3().ideal().tool(Tool::hand())
}

fn is_moving(reference: &Reference) -> bool {
    reference.dq.iter().any(|dq| dq.abs() > 1e-6)
}

/// The reference stays where it is for 300 ms of the robot's time.
async fn stands(robot: &Robot) {
    let before = shown(robot, || robot.reference()).await;
    let later = |reference: &Reference| reference.time >= before.time + 300;
    let still = shown(robot, || robot.reference().filter(later)).await;
    for (still, before) in still.q.iter().zip(before.q) {
        assert!((still - before).abs() < 1e-9, "{still} rad after {before}");
    }
}

/// Speed of a motion that takes longer than [`SOON`] by the clock, so that every event meets it
/// under way.
const SLOW: f64 = 0.002;

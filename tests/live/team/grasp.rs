//! An object that both arms of a team hold. Each arm has a separate world here, without the object:
//! tests/lockstep/carrying has both in one.

use franka_async::Motion;
use franka_async::error::GoalError;
use franka_async::goal::{Backend, Setpoints};
use franka_async::team::Grasp;
use nalgebra::{Translation3, UnitQuaternion};

use super::*;

/// The bases, which face each other.
pub(super) fn bases() -> [Pose; 2] {
    let turned = UnitQuaternion::from_euler_angles(0.0, 0.0, std::f64::consts::PI);
    let other = Pose::from_parts(Translation3::new(1.2, 0.0, 0.0), turned);
    [Pose::identity(), other]
}

/// An object between the hands, in the frame of the bases.
pub(super) fn object() -> Pose {
    Pose::translation(0.6, 0.02, 0.5)
}

/// The pose of the second reference in the frame of the first.
fn between(two: &Two) -> Pose {
    let [left, right] = [0, 1].map(|i| {
        let reference = two.team.arms()[i].reference().expect("it is held");
        bases()[i] * reference.pose
    });
    left.inverse() * right
}

fn distance(one: &Pose, other: &Pose) -> f64 {
    (one.translation.vector - other.translation.vector).norm()
}

/// Fails unless both arms have the object here, by their measured joints. These arms stick: by less
/// than the tolerance at the hand, 1 mm, and by somewhat more at an object 0.3 m from it.
fn assert_there(grasp: &Grasp<'_, 2>, expected: &Pose) {
    for measured in grasp.measured() {
        let off = distance(&measured, expected);
        let turned = measured.rotation.angle_to(&expected.rotation);
        println!("off by {off:.5} m, {turned:.5} rad");
        assert!(off < 3e-3 && turned < 5e-3, "{off} m, {turned} rad");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_object_in_both_hands_goes_to_the_pose_that_is_asked_for() {
    let _alone = alone();
    let two = two().await;
    let grasp = two.team.grasp(bases(), object()).expect("both hold");
    assert_there(&grasp, &object());
    let begun = between(&two);
    let turn = UnitQuaternion::from_euler_angles(0.0, 0.1, 0.2);
    let to = Pose::from_parts(Translation3::new(0.6, 0.05, 0.58), turn);
    for to in [to, object()] {
        for outcome in grasp.move_with(to, |motion| motion.speed(0.7)).await {
            outcome.expect("nothing hinders it");
        }
        assert_there(&grasp, &to);
        let ended = between(&two);
        let gap = distance(&ended, &begun);
        let turned = ended.rotation.angle_to(&begun.rotation);
        assert!(gap < 1e-4 && turned < 1e-4, "{gap} m, {turned} rad");
    }
    assert_eq!(two.team.stopped(), None);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn object_in_motion_stops_with_its_future_or_a_stopper() {
    let _alone = alone();
    let two = two().await;
    let grasp = two.team.grasp(bases(), object()).expect("both hold");
    let begun = between(&two);
    let to = up(0.15) * object();
    let slow = |motion: Motion| motion.speed(0.1);

    let mut motion = Box::pin(grasp.move_with(to, slow));
    tokio::select! {
        biased;
        outcomes = &mut motion => panic!("too early: {outcomes:?}"),
        () = under_way(&two) => {}
    }
    drop(motion);
    assert_eq!(two.team.stopped(), Some(TeamStop::Requested));
    both_rest(&two).await;
    assert_on_its_way(&grasp, &to);

    let motion = tokio::spawn(grasp.move_with(to, slow));
    under_way(&two).await;
    two.team.stopper().stop();
    let outcomes = motion.await.expect("no panic");
    let requested = MotionError::Braked(Lapse::Team(TeamStop::Requested));
    let expected = [(); 2].map(|()| Some(requested.clone()));
    assert_eq!(outcomes.map(Result::err), expected);
    both_rest(&two).await;
    assert_on_its_way(&grasp, &to);
    // Both brake on the same line. In motion, one may be 2 mm ahead, twice here. Different clocks
    // of the robots add little at 3 cm/s.
    let gap = distance(&between(&two), &begun);
    assert!(gap < 6e-3, "{gap} m");

    // A single arm's position is no pose of the object: the next motion moves both to it.
    for outcome in grasp.move_to(object()).await {
        outcome.expect("nothing hinders it");
    }
    assert_there(&grasp, &object());
    let gap = distance(&between(&two), &begun);
    assert!(gap < 1e-4, "{gap} m");
}

async fn both_rest(two: &Two) {
    for robot in &two.robots {
        until(robot, |_| {
            robot.reference().is_some_and(|it| !moves(&it.dq))
        })
        .await;
        robot_time(robot, 500).await;
    }
}

/// Fails if an arm has the object near its target.
fn assert_on_its_way(grasp: &Grasp<'_, 2>, to: &Pose) {
    for measured in grasp.measured() {
        let left = distance(&measured, to);
        assert!(left > 0.02, "{left} m left");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_object_that_cannot_go_there_stays_in_all_hands() {
    let _alone = alone();
    let two = two().await;
    let grasp = two.team.grasp(bases(), object()).expect("both hold");
    let refused = Err(stopped_by(0, MemberFault::Refused));
    let nowhere = Pose::translation(f64::NAN, 0.0, 0.5);
    let nan_turn = UnitQuaternion::from_euler_angles(0.0, f64::NAN, 0.0);
    let twisted = Pose::from_parts(object().translation, nan_turn);
    for wrong in [nowhere, twisted] {
        // As a target, as the object, and as a base.
        let from = two.team.grasp(bases(), wrong).expect("both hold");
        let base = two.team.grasp([wrong, bases()[1]], object());
        let base = base.expect("both hold");
        for motion in [
            grasp.move_to(wrong),
            from.move_to(object()),
            base.move_to(object()),
        ] {
            let [first, _] = motion.await;
            let unlike = matches!(first, Err(MotionError::Goal(GoalError::NotFinite { .. })));
            assert!(unlike, "{first:?}");
        }
    }
    // Only the first arm has it out of its reach: the other one does not begin, either.
    let [first, second] = grasp
        .move_to(Pose::translation(0.5, 0.0, 0.0) * object())
        .await;
    let unreachable = matches!(first, Err(MotionError::Goal(GoalError::Unreachable { .. })));
    assert!(unreachable, "{first:?}");
    assert_eq!(second, refused);
    // Options are checked for each arm.
    let hasty = grasp.move_with(up(0.05) * object(), |motion| motion.speed(1e3));
    for outcome in hasty.await {
        let speed = matches!(outcome, Err(MotionError::Goal(GoalError::Speed { .. })));
        assert!(speed, "{outcome:?}");
    }
    assert_there(&grasp, &object());

    // Without its session an arm holds nothing.
    let [left, right] = two.team.arms();
    left.clone().disengage().await.expect("it was asked for");
    let gone = two.team.grasp(bases(), object());
    assert!(matches!(gone, Err(MotionError::Disengaged)), "{gone:?}");
    let [first, second] = grasp.move_to(up(0.05) * object()).await;
    assert_eq!(first, Err(MotionError::Disengaged));
    assert_eq!(second, refused);
    let alone = right.move_by(Offset::base(up(0.01)));
    alone.await.expect("it arrives");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_arm_under_the_robots_own_controller_carries_nothing() {
    let _alone = alone();
    let own = Engage::default().backend(Backend::joint_impedance(Setpoints::JointPositions));
    let two = two_with([Engage::default(), own]).await;
    let grasp = two.team.grasp(bases(), object()).expect("both hold");
    let [first, second] = grasp.move_to(up(0.05) * object()).await;
    assert_eq!(first, Err(stopped_by(1, MemberFault::Refused)));
    let backend = matches!(second, Err(MotionError::Goal(GoalError::Backend { .. })));
    assert!(backend, "{second:?}");
    assert_there(&grasp, &object());
}

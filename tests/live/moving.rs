//! Motions over sockets, as a program sees them.

use std::future::IntoFuture;
use std::time::Duration;

use franka_async::control::{Finish, Torques};
use franka_async::error::{CommandError, GoalError, PoseError};
use franka_async::settings::{CollisionBehavior, Load};
use franka_async::{Engage, MotionError, Pose, pose};
use franka_model::JointVector;
use franka_proto::{SetterStatus, Status};
use tokio::sync::watch;

use crate::{alone, robot_time, simulated, under_way};

#[tokio::test(flavor = "multi_thread")]
async fn a_pose_and_joints_are_reached() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let start = robot.pose();
    let up = Pose::translation(0.0, 0.0, 0.05) * start;
    let report = robot.move_to(up).await.unwrap();
    let error = PoseError::between(&robot.pose(), &up);
    assert!(
        error.translation < 1e-3 && error.rotation < 2e-3,
        "{error:?}"
    );
    assert!(
        report.final_error.is_some() && report.worst_turnaround > Duration::ZERO,
        "{report:?}"
    );
    let mut q = robot.state().q;
    q[0] += 0.2;
    robot.move_joints(q).await.unwrap();
    let error = PoseError::between(&robot.pose(), &robot.pose_at(q));
    assert!(
        error.translation < 1e-3 && error.rotation < 2e-3,
        "{error:?}"
    );
    robot.shutdown().await;
}

/// The straight line to this pose winds the joints to the ends of their ranges.
#[tokio::test(flavor = "multi_thread")]
async fn a_line_that_the_arm_cannot_follow_is_refused_at_rest() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let begin = [-0.4781, -0.8056, -0.3814, -2.3850, 0.2325, 3.4186, 0.5198];
    robot.move_joints(begin).await.unwrap();
    let there = pose::from_xyzw([0.6206, 0.0244, 0.1662], [0.4635, 0.8860, 0.0, 0.0]).unwrap();
    let refused = robot.move_to(there).await.unwrap_err();
    let MotionError::Goal(GoalError::NoLine { posture, .. }) = refused else {
        panic!("{refused}");
    };
    assert!(!robot.state().motion_running());
    let previewed = robot.move_to(there).preview().unwrap_err();
    assert_eq!(previewed, refused);

    let fallback = || robot.move_to(there).speed(0.8).joint_fallback();
    let previewed = fallback().preview().unwrap();
    fallback().await.unwrap();
    let error = PoseError::between(&robot.pose(), &there);
    assert!(error.translation < 1e-3, "{error:?}");
    for q in [previewed.end(), robot.state().q] {
        let off = JointVector::from(q) - JointVector::from(posture.unwrap());
        assert!(off.amax() < 0.01, "{off}");
    }
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_dropped_motion_brakes_and_a_new_one_takes_over() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let start = robot.pose();
    let far = Pose::translation(0.0, 0.1, 0.1) * start;
    let slow = || robot.move_to(far).speed(0.05).into_future();
    tokio::select! {
        outcome = slow() => panic!("{outcome:?}"),
        () = under_way(&robot) => {}
    }
    let report = robot.move_to(start).await.unwrap();
    assert!(report.final_error.unwrap().translation < 1e-3);

    let first = tokio::spawn(slow());
    under_way(&robot).await;
    robot.move_to(start).await.unwrap();
    assert_eq!(first.await.unwrap(), Err(MotionError::Superseded));
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_speed_that_no_motion_can_have_is_refused_as_a_speed() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let start = robot.pose();
    let (_targets, poses) = watch::channel(start);
    for factor in [0.0, 7.0] {
        let refused = MotionError::Goal(GoalError::Speed {
            got: factor,
            most: 1.709,
        });
        let moved = robot.move_to(start).speed(factor).await;
        assert_eq!(moved, Err(refused.clone()));
        let followed = robot.follow(poses.clone()).speed(factor).await;
        assert_eq!(followed, Err(refused.clone()));
        let engaged = robot.engage(Engage::default().speed(factor)).await;
        assert_eq!(engaged.map(drop), Err(refused));
    }
    let text = robot.move_to(start).speed(7.0).await.unwrap_err();
    assert!(
        text.to_string()
            .contains("speed is 7, expected between 0.0001 and 1.709"),
        "{text}"
    );
    robot.move_to(start).speed(1.5).await.unwrap();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn motion_waits_for_its_first_poll_and_handle_brakes_it() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let motion = crate::long_way(&robot);
    let handle = motion.handle();
    robot_time(&robot, 200).await;
    assert!(!robot.state().motion_running());
    let moving = tokio::spawn(motion.into_future());
    under_way(&robot).await;
    handle.cancel();
    assert_eq!(moving.await.unwrap(), Err(MotionError::Stopped));
    // Stopping an arm at rest is not an error.
    robot.stop().await.unwrap();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn cancel_before_first_poll_never_begins() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let motion = robot.move_to(Pose::translation(0.0, 0.0, 0.02) * robot.pose());
    motion.handle().cancel();
    assert_eq!(motion.await, Err(MotionError::Stopped));
    let control = robot.control_torques(|_, _| Torques([0.0; 7]).finish());
    control.canceller().cancel();
    assert_eq!(control.await, Err(MotionError::Stopped));
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_watch_is_followed_to_its_last_value() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let last = crate::follow_steps(&robot).await;
    let error = PoseError::between(&robot.pose(), &last);
    assert!(error.translation < 1e-3, "{error:?}");

    let (sender, targets) = watch::channel(robot.pose());
    let following = tokio::spawn(robot.follow(targets).into_future());
    under_way(&robot).await;
    sender.send(Pose::translation(5.0, 0.0, 0.0)).unwrap();
    let error = following.await.unwrap().unwrap_err();
    assert!(matches!(error, MotionError::Goal(_)), "{error:?}");
    assert!(
        !robot.state().motion_running(),
        "braked and ended before it said so"
    );
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn parameters_are_taken_at_rest_and_refused_in_motion() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    robot
        .set_collision_behavior(CollisionBehavior::uniform(
            [30.0; 7], [40.0; 7], [40.0; 6], [50.0; 6],
        ))
        .await
        .unwrap();
    robot.set_joint_impedance([3000.0; 7]).await.unwrap();
    robot
        .set_cartesian_impedance([2000.0, 2000.0, 2000.0, 100.0, 100.0, 100.0])
        .await
        .unwrap();
    robot.set_guiding_mode([true; 6], false).await.unwrap();
    robot
        .set_k(Pose::translation(0.0, 0.0, 0.02))
        .await
        .unwrap();
    robot
        .set_ee(Pose::translation(0.0, 0.0, 0.01))
        .await
        .unwrap();
    let load = Load {
        m_load: 0.2,
        F_x_Cload: [0.0, 0.0, 0.1],
        I_load: [1e-3, 0.0, 0.0, 0.0, 1e-3, 0.0, 0.0, 0.0, 1e-3],
    };
    robot.set_load(load).await.unwrap();
    robot.recover().await.unwrap();
    assert!(robot.urdf().await.unwrap().contains("<robot"));

    let load = Load {
        m_load: f64::NAN,
        ..load
    };
    let refused = robot.set_load(load).await.unwrap_err();
    assert_eq!(refused.to_string(), "number 1 of m_load is not finite");
    let invalid = robot.set_joint_impedance([-1.0; 7]).await.unwrap_err();
    assert_eq!(
        invalid.to_string(),
        "libfranka: Set Joint Impedance command rejected: invalid argument! (got [-1.0, -1.0, -1.0, \
         -1.0, -1.0, -1.0, -1.0] N m/rad, expected 0 to 14250 N m/rad for each joint)"
    );
    let load = Load {
        m_load: -1.0,
        ..load
    };
    let invalid = robot.set_load(load).await.unwrap_err();
    let CommandError::InvalidArgument { refusal, why } = invalid else {
        panic!("{invalid:?}")
    };
    assert_eq!(
        refusal.status(),
        Status::Setter(SetterStatus::InvalidArgumentRejected)
    );
    assert_eq!(why, "m_load is -1 kg, expected 0 or more");
    let refused = |m_load: f64, moments: [f64; 3]| {
        let robot = robot.clone();
        let [xx, yy, zz] = moments;
        let load = Load {
            m_load,
            I_load: [xx, 0.0, 0.0, 0.0, yy, 0.0, 0.0, 0.0, zz],
            ..load
        };
        async move { robot.set_load(load).await.expect_err("refused").to_string() }
    };
    assert_eq!(
        refused(0.2, [1e-4, 1e-4, 5e-3]).await,
        "libfranka: Set Load command rejected: invalid argument! (I_load has the principal moments \
         0.0001, 0.0001 and 0.005 kg m^2, expected no moment below 0 and no moment above the \
         sum of the other two)"
    );
    assert_eq!(
        refused(30.0, [1e-3, 1e-3, 2e-3]).await,
        "libfranka: Set Load command rejected: invalid argument! (m_load is 30 kg, expected 3 kg \
         at most; F_x_Cload is [0, 0, 0.1] m from the flange; the trace of I_load is 0.004 kg m^2; the vendor documents no ranges)"
    );
    let mut thresholds = CollisionBehavior::careful();
    thresholds.upper_force_thresholds_nominal[2] = -1.0;
    let invalid = robot.set_collision_behavior(thresholds).await.unwrap_err();
    assert_eq!(
        invalid.to_string(),
        "libfranka: Set Collision Behavior command rejected: invalid argument! (number 3 of \
         upper_force_thresholds_nominal is -1, expected 0 or more)"
    );

    crate::long_way(&robot).detach();
    under_way(&robot).await;
    let refused = robot.set_joint_impedance([3000.0; 7]).await.unwrap_err();
    assert_eq!(
        refused.to_string(),
        r#"libfranka: Set Joint Impedance command rejected: command not possible in the current mode ("Move")!"#
    );
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn five_robots_in_one_process_move_at_once() {
    let _alone = alone();
    let mut moving = tokio::task::JoinSet::new();
    for i in 0..5_u32 {
        moving.spawn(async move {
            let (robot, sim) = simulated().await;
            let target = Pose::translation(0.0, 0.01 * f64::from(i), 0.03) * robot.pose();
            let outcome = robot.move_to(target).await;
            let error = PoseError::between(&robot.pose(), &target);
            robot.shutdown().await;
            sim.stop().await;
            (i, outcome, error)
        });
    }
    while let Some(done) = moving.join_next().await {
        let (i, outcome, error) = done.unwrap();
        outcome.unwrap_or_else(|error| panic!("robot {i}: {error}"));
        assert!(error.translation < 1e-3, "robot {i}: {error:?}");
    }
}

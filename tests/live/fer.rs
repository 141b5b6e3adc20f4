//! The Franka Emika Robot: the same programs, over the protocol that negotiation finds.

use franka_async::connection::{Version, VersionPolicy};
use franka_async::error::{CommandError, ConnectError, GoalError, Hindrance, Party, PoseError};
use franka_async::settings::Filters;
use franka_async::{Engage, MotionError, Pose, Realtime, Robot};
use franka_model::RobotKind;
use franka_proto::RequestError;
use franka_sim::{Running, Sim, Tool};

use crate::{alone, at_the_clients_pace, simulated, under_way};

/// A simulated FER with a hand, and a handle on it.
async fn fer() -> (Robot, Running) {
    at_the_clients_pace(Sim::fer().ideal().tool(Tool::hand())).await
}

fn assert_near(robot: &Robot, target: &Pose) {
    let error = PoseError::between(&robot.pose(), target);
    assert!(
        error.translation < 1e-3 && error.rotation < 2e-3,
        "{error:?}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn the_version_is_negotiated_and_a_pose_and_joints_are_reached() {
    let _alone = alone();
    let (robot, _sim) = fer().await;
    assert_eq!(robot.version(), Version::V5);
    assert_eq!(robot.model().kind(), RobotKind::Fer);
    let up = Pose::translation(0.0, 0.0, 0.05) * robot.pose();
    robot.move_to(up).await.unwrap();
    assert_near(&robot, &up);
    let mut q = robot.state().q;
    q[0] += 0.2;
    q[6] -= 0.3;
    robot.move_joints(q).await.unwrap();
    assert_near(&robot, &robot.pose_at(q));
    robot.shutdown().await;
}

/// The straight line to the pose on the other side of the base collides with the arm itself.
#[tokio::test(flavor = "multi_thread")]
async fn the_joints_of_an_engaged_arm_go_where_it_has_no_line() {
    let _alone = alone();
    let (robot, _sim) = fer().await;
    let arm = robot.engage(Engage::default()).await.unwrap();
    let start = robot.pose();
    let there = Pose::translation(-2.0 * start.translation.x, 0.0, -0.2) * start;
    let refused = arm.move_to(there).await.unwrap_err();
    assert!(
        matches!(
            refused,
            MotionError::Goal(GoalError::NoLine {
                hindrance: Hindrance::Itself,
                ..
            })
        ),
        "{refused}"
    );
    arm.move_to(there).joint_fallback().await.unwrap();
    assert_near(&robot, &there);
    arm.disengage().await.unwrap();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_watch_is_followed_and_a_motion_stopped() {
    let _alone = alone();
    let (robot, _sim) = fer().await;
    let last = crate::follow_steps(&robot).await;
    assert_near(&robot, &last);

    let moving = tokio::spawn(crate::long_way(&robot).into_future());
    under_way(&robot).await;
    robot.stop().await.unwrap();
    assert!(moving.await.unwrap().is_err(), "stopped");
    assert!(!robot.state().motion_running());
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn commands_of_one_protocol_are_refused_on_the_other() {
    let _alone = alone();
    let (robot, _sim) = fer().await;
    robot.set_filters(Filters::uniform(100.0)).await.unwrap();
    let refused = robot.set_filters(Filters::uniform(0.5)).await.unwrap_err();
    assert_eq!(
        refused.to_string(),
        "libfranka: Set Filters command rejected: invalid argument! (got [0.5, 0.5, 0.5, 0.5, 0.5] Hz, \
         expected 1 to 1000 Hz for each filter)"
    );
    let wall = robot.virtual_wall(0).await.unwrap();
    assert!(!wall.object_activation);
    let lacking = robot.urdf().await.unwrap_err();
    assert_eq!(
        lacking.to_string(),
        "protocol 5 (Franka Emika Robot) has no Get Robot Model"
    );
    robot.shutdown().await;

    let (robot, _sim) = simulated().await;
    assert_eq!(robot.version(), Version::V10);
    for (error, what) in [
        (
            robot
                .set_filters(Filters::uniform(100.0))
                .await
                .unwrap_err(),
            "Set Filters",
        ),
        (
            robot.virtual_wall(0).await.unwrap_err(),
            "Get Cartesian Limit",
        ),
    ] {
        let version = Version::V10;
        let lacking = CommandError::Request(RequestError::Unsupported { what, version });
        assert_eq!(error, lacking);
    }
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_pinned_version_is_the_only_one_that_connects() {
    let _alone = alone();
    let sim = Sim::fer()
        .ideal()
        .start()
        .await
        .expect("a simulator starts");
    let pinned = |version| {
        Robot::builder(sim.addr())
            .realtime(Realtime::Ignore)
            .version(VersionPolicy::Exact(version))
            .connect()
    };
    let error = pinned(Version::V10).await.expect_err("refused");
    let ConnectError::IncompatibleVersion(incompatible) = &error else {
        panic!("{error:?}")
    };
    assert_eq!(incompatible.server_version, 5);
    assert_eq!(
        error.to_string(),
        "libfranka: Incompatible library version (server version: 5, library version: 10): a \
         Franka Emika Robot \
         (Panda) with system image 4.2.1 or later speaks version 5: connect with version 5, which this driver also \
         supports"
    );
    assert_eq!(error.party(), Party::Caller);
    let robot = pinned(Version::V5).await.expect("its own version");
    robot.shutdown().await;

    let sim = Sim::fr3()
        .ideal()
        .start()
        .await
        .expect("a simulator starts");
    let error = Robot::builder(sim.addr())
        .realtime(Realtime::Ignore)
        .version(VersionPolicy::Exact(Version::V5))
        .connect()
        .await
        .expect_err("refused");
    assert_eq!(
        error.to_string(),
        "libfranka: Incompatible library version (server version: 10, library version: 5): a \
         Franka Research 3 \
         with system image 5.9.0 or later speaks version 10: connect with version 10, which this driver also \
         supports"
    );
}

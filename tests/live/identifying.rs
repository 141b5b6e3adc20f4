//! Plans to identify an arm that fail, and knowledge that is refused. Lockstep tests cover the
//! results of identification; the examples run it to its end.

use franka_async::error::{ConnectError, IdentifyError, KnownError, Party};
use franka_async::identify::{Estimate, Identified, IdentifiedJoint, IdentifiedLoad};
use franka_async::{MotionError, Pose, Realtime, Robot};
use franka_model::RobotKind;

use crate::{alone, simulated, under_way, until};

#[tokio::test(flavor = "multi_thread")]
async fn an_arm_that_has_moved_since_the_plan_is_not_moved_again() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let identify = robot.identify();
    let up = Pose::translation(0.0, 0.0, 0.05) * robot.pose();
    robot.move_to(up).await.unwrap();
    let at = robot.state().q;
    let error = identify.run().await.expect_err("it has moved");
    assert!(matches!(error, IdentifyError::Moved { .. }), "{error}");
    assert_eq!(error.party(), Party::Caller);
    assert!(!robot.state().motion_running());
    assert!((0..7).all(|i| (robot.state().q[i] - at[i]).abs() < 1e-3));
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_run_that_is_dropped_or_stopped_brakes_the_arm() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    tokio::select! {
        outcome = robot.identify().run() => panic!("{outcome:?}"),
        () = under_way(&robot) => {}
    }
    until(&robot, |state| !state.motion_running()).await;
    let running = tokio::spawn(robot.identify().run());
    under_way(&robot).await;
    robot.stop().await.unwrap();
    let outcome = running.await.unwrap();
    let stopped = IdentifyError::Motion(MotionError::Stopped);
    assert_eq!(outcome, Err(stopped));
    let state = robot.state();
    assert!(state.reflex_reason.is_empty(), "{:?}", state.reflex_reason);
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn knowledge_of_another_arm_is_refused() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    robot.shutdown().await;
    let zero = Estimate {
        value: 0.0,
        deviation: 0.1,
    };
    let joint = IdentifiedJoint {
        friction: zero,
        bias: zero,
    };
    let mut known = Identified {
        kind: RobotKind::Fer,
        joints: [joint; 7],
        load: IdentifiedLoad {
            mass: zero,
            moment: [zero; 3],
        },
    };
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let error = builder.clone().known(known).connect().await;
    let error = error.expect_err("it is an FR3");
    let ConnectError::Known(KnownError::Kind { got, expected }) = error else {
        panic!("{error}");
    };
    assert_eq!((got, expected), (RobotKind::Fer, RobotKind::Fr3));
    known.kind = RobotKind::Fr3;
    known.joints[2].friction.value = f64::NAN;
    let error = builder.clone().known(known).connect().await;
    let error = error.expect_err("no arm has that");
    assert!(matches!(
        error,
        ConnectError::Known(KnownError::Number { .. })
    ));
    assert_eq!(error.party(), Party::Caller);
    known.joints[2] = joint;
    let robot = builder.known(known).connect().await.expect("an arm");
    robot.shutdown().await;
}

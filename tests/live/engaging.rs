//! Engaged sessions over sockets, as a program sees them.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use franka_async::error::{GoalError, Lapse, PoseError};
use franka_async::goal::{Chunk, Deadman, Deviation, Free, Leash, OnTimeout, Tuning};
use franka_async::record::{Activity, Record};
use franka_async::settings::CollisionBehavior;
use franka_async::{Engage, MotionError, Pose};
use franka_model::Wrench;
use franka_sim::{Sim, Tool};
use franka_tests::PATIENCE;
use tokio::runtime::{Builder, Runtime};
use tokio::sync::watch;

use crate::{SOON, alone, by_the_clock, connect, robot_time, simulated, under_way};

#[tokio::test(flavor = "multi_thread")]
async fn goals_of_every_kind_are_reached_within_one_session() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let start = robot.pose();
    let ready = robot.state().q;
    let arm = robot.engage(Engage::default().speed(1.5)).await.unwrap();
    let motion = robot.state().motion_generator_mode;

    let up = Pose::translation(0.0, 0.0, 0.05) * start;
    arm.move_to(up).await.unwrap();
    assert!(PoseError::between(&robot.pose(), &up).translation < 1e-3);
    arm.set(start).await.unwrap();
    robot_time(&robot, 100).await;
    arm.move_joints(ready).await.unwrap();

    let (sender, targets) = watch::channel(up);
    drop(sender);
    arm.follow(targets).await.unwrap();
    assert!(PoseError::between(&robot.pose(), &up).translation < 1e-3);
    let steps = tokio_stream::iter([up, start]);
    arm.follow_stream(steps).await.unwrap();
    assert!(PoseError::between(&robot.pose(), &start).translation < 1e-3);

    arm.guide(Free::ALL).await.unwrap();
    let mut q = ready;
    q[0] += 0.05;
    let chunk = Chunk::joints([(Duration::from_millis(300), q)]).unwrap();
    let observed = robot.state().message_id;
    arm.chunk(chunk.observed_at(observed)).await.unwrap();
    robot_time(&robot, 800).await;
    assert!((robot.state().q[0] - q[0]).abs() < 5e-3);
    arm.hold().await.unwrap();

    assert_eq!(robot.move_to(start).await, Err(MotionError::Busy));
    assert_eq!(robot.state().motion_generator_mode, motion, "one motion");
    let gains = arm.tune(Tuning {
        budget: Some(franka_async::goal::Budget::of(robot.model().joint_limits()).scaled(100.0)),
        ..Tuning::default()
    });
    let refused = gains.await;
    assert!(matches!(
        refused,
        Err(MotionError::Goal(GoalError::Budget { .. }))
    ));
    let other = arm.clone();
    arm.disengage().await.unwrap();
    assert_eq!(other.set(start).await, Err(MotionError::Disengaged));
    robot.move_to(start).await.unwrap();
    robot.shutdown().await;
}

/// A push that the springs bear at the usual length of the leash moves the arm on a short one.
#[tokio::test(flavor = "multi_thread")]
async fn tuning_is_kept_field_by_field_for_goals_to_come() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    let tolerant = CollisionBehavior::insensitive();
    robot.set_collision_behavior(tolerant).await.unwrap();
    let start = robot.pose();
    let arm = robot.engage(Engage::default()).await.unwrap();
    let made_before = arm.move_to(start);
    let short = Tuning {
        leash: Some(Leash::LEAST),
        ..Tuning::default()
    };
    tokio::select! {
        biased;
        tuned = arm.tune(short) => tuned.unwrap(),
        // Polled once and dropped.
        () = std::future::ready(()) => {}
    }
    let narrow = Tuning {
        deviation: Some(Deviation {
            translation: 0.1,
            ..Deviation::default()
        }),
        ..Tuning::default()
    };
    arm.tune(narrow).await.unwrap();
    let mut motion = made_before;
    for _ in 0..2 {
        let start = robot.pose();
        sim.with(|robot| {
            let push = Wrench::new(0.0, 15.0, 0.0, 0.0, 0.0, 0.0);
            robot.push_end_effector(push, 3000);
        })
        .await
        .unwrap();
        let pushed = motion.await;
        let away = PoseError::between(&robot.pose(), &start).translation;
        let displaced = Err(MotionError::Braked(Lapse::Displaced));
        assert_eq!(pushed, displaced, "{away} m");
        assert!(away < 0.2, "{away} m");
        robot_time(&robot, 4000).await;
        motion = arm.move_to(robot.pose());
    }
    robot.shutdown().await;
}

/// The task that accepts goals is delayed for a second of the robot's time, with the thread that it
/// shares with this test.
#[test]
fn at_rest_waits_for_a_goal_that_is_not_taken_yet() {
    let _alone = alone();
    let servers = Runtime::new().unwrap();
    let sim = Sim::fr3().ideal().virtual_time(PATIENCE).start();
    let sim = servers.block_on(sim).unwrap();
    let clients = Builder::new_current_thread().enable_all().build().unwrap();
    clients.block_on(async {
        let robot = connect(&sim).await;
        let arm = robot.engage(Engage::default()).await.unwrap();
        robot_time(&robot, 500).await;
        let aside = Pose::translation(0.0, 0.05, 0.0) * robot.pose();
        let mut at_rest = std::pin::pin!(arm.at_rest());
        // The task handles some of these inputs, which have no effect, and lets this test run.
        let other = robot.move_joints(robot.state().q).handle();
        for _ in 0..1000 {
            other.pause();
        }
        arm.try_set(aside).unwrap();
        tokio::select! {
            biased;
            rested = &mut at_rest => panic!("{rested:?}"),
            () = std::future::ready(()) => {}
        }
        let held_up = robot.state().message_id + 1000;
        while robot.state().message_id < held_up {
            std::thread::sleep(Duration::from_millis(1));
        }
        at_rest.await.unwrap();
        assert!(PoseError::between(&robot.pose(), &aside).translation < 1e-3);
        robot.shutdown().await;
    });
}

#[tokio::test(flavor = "multi_thread")]
async fn a_session_ends_with_its_last_handle_or_by_a_stop() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let arm = robot.engage(Engage::default()).await.unwrap();
    let ended = arm.ended();
    let far = Pose::translation(0.0, 0.1, 0.1) * robot.pose();
    let moving = tokio::spawn(arm.move_to(far).speed(0.05).into_future());
    drop(arm);
    under_way(&robot).await;
    assert!(!moving.is_finished(), "a motion is a handle too");
    moving.abort();
    ended.await.unwrap();

    let arm = robot.engage(Engage::default()).await.unwrap();
    let moving = tokio::spawn(arm.move_to(far).speed(0.05).into_future());
    robot_time(&robot, 300).await;
    robot.stop().await.unwrap();
    assert_eq!(moving.await.unwrap(), Err(MotionError::Stopped));
    assert_eq!(arm.ended().await, Err(MotionError::Stopped));
    assert_eq!(arm.set(far).await, Err(MotionError::Stopped));
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn lapse_of_stream_or_deadman_is_named_in_the_outcome() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let start = robot.pose();
    let far = Pose::translation(0.0, 0.1, 0.1) * start;
    let (token, monitor) = Deadman::new(Duration::from_secs(60));
    let arm = robot
        .engage(Engage::default().deadman(monitor))
        .await
        .unwrap();
    let (_sender, targets) = watch::channel(far);
    let silent = arm
        .follow(targets)
        .watchdog(Duration::from_millis(100), OnTimeout::Brake);
    let outcome = silent.await;
    let braked = matches!(outcome, Err(MotionError::Braked(Lapse::Silent { .. })));
    assert!(braked, "{outcome:?}");
    token.keep_alive();
    let moving = tokio::spawn(arm.move_to(far).speed(0.05).into_future());
    drop(token);
    let held = Err(MotionError::Held(Lapse::Deadman));
    assert_eq!(moving.await.unwrap(), held);
    assert_eq!(arm.move_to(start).await, held);
    arm.disengage().await.unwrap();
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_stream_that_has_no_target_yet_ends_with_its_session() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let arm = robot.engage(Engage::default()).await.unwrap();
    let nothing = || tokio_stream::pending::<Pose>();
    let waiting = tokio::spawn(arm.follow_stream(nothing()).into_future());
    robot_time(&robot, 50).await;
    assert!(!waiting.is_finished());
    robot.stop().await.unwrap();
    let outcome = tokio::time::timeout(SOON, waiting).await;
    let outcome = outcome.expect("its session has ended").unwrap();
    assert_eq!(outcome, Err(MotionError::Stopped));

    let arm = robot.engage(Engage::default()).await.unwrap();
    let over = arm.follow_stream(tokio_stream::empty::<Pose>()).await;
    assert_eq!(over, Err(GoalError::NoTarget.into()));
    arm.clone().disengage().await.unwrap();
    let outcome = arm.follow_stream(nothing()).await;
    assert_eq!(outcome, Err(MotionError::Disengaged));
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_session_says_why_it_ended_after_another_one_has() {
    let _alone = alone();
    let (robot, _sim) = simulated().await;
    let start = robot.pose();
    let stopped = robot.engage(Engage::default()).await.unwrap();
    robot.stop().await.unwrap();
    let newer = robot.engage(Engage::default()).await.unwrap();
    robot.stop().await.unwrap();
    for arm in [stopped, newer] {
        assert_eq!(arm.set(start).await, Err(MotionError::Stopped));
        assert_eq!(arm.move_to(start).await, Err(MotionError::Stopped));
    }
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn an_observer_sees_the_records_that_the_stream_has() {
    let _alone = alone();
    // At the client's pace, records come faster than a reader on a busy machine reads them.
    let (robot, _sim) = by_the_clock(Sim::fr3().ideal().tool(Tool::hand())).await;
    let mut records = robot.records();
    let streamed = tokio::spawn(async move {
        let mut streamed = Vec::new();
        while let Ok(record) = records.recv().await {
            streamed.push(record);
        }
        streamed
    });
    let observed = Arc::new(Mutex::new(Vec::with_capacity(10_000)));
    let noted = observed.clone();
    let engage = Engage::default().observer(move |record, state| {
        assert_eq!(record.q, state.q);
        noted.lock().unwrap().push(*record);
    });
    let arm = robot.engage(engage).await.unwrap();
    let up = Pose::translation(0.0, 0.0, 0.02) * robot.pose();
    arm.move_to(up).await.unwrap();
    arm.disengage().await.unwrap();
    robot.shutdown().await;
    let of_motion =
        |record: &Record| matches!(record.activity, Activity::Running | Activity::Finishing);
    let mut streamed = streamed.await.unwrap();
    streamed.retain(of_motion);
    let observed = observed.lock().unwrap();
    assert!(observed.len() > 500, "{}", observed.len());
    assert_eq!(streamed, *observed);
}

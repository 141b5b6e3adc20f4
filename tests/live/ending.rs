//! Ends of a robot, a client, a token, or a runtime, in every phase of a motion.

use std::future::IntoFuture as _;
use std::time::{Duration, Instant};

use franka_async::connection::{CancellationToken, Version};
use franka_async::error::{CloseReason, Party};
use franka_async::state::RobotMode;
use franka_async::{MotionError, Pose, Realtime, Robot};
use franka_proto::framing::next_message;
use franka_proto::{MoveControllerMode, MoveGeneratorMode, MoveRequest, Request, client};
use franka_sim::Sim;
use futures::future::join;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::{sleep, timeout};

use crate::{SOON, alone, at_the_clients_pace, connect, long_way, simulated, under_way};

/// Control threads of this process.
fn control_threads() -> usize {
    let tasks = std::fs::read_dir("/proc/self/task").unwrap();
    tasks
        .filter_map(|task| std::fs::read_to_string(task.ok()?.path().join("comm")).ok())
        .filter(|name| name.trim() == "franka-rt")
        .count()
}

/// For a delay: until the motion is under way.
const WAY: u64 = u64::MAX;

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_that_dies_in_any_phase_of_a_motion_resolves_it() {
    let _alone = alone();
    // Before the answer to `Move`, about the first commands, on the way, and braking.
    for (delay, braking) in [
        (0, false),
        (2, false),
        (30, false),
        (WAY, false),
        (WAY, true),
    ] {
        let (robot, sim) = simulated().await;
        let motion = long_way(&robot);
        let handle = motion.handle();
        let moving = tokio::spawn(motion.into_future());
        match delay {
            WAY => under_way(&robot).await,
            // Any phase will do, and few of them are shown by a state.
            _ => sleep(Duration::from_millis(delay)).await,
        }
        if braking {
            handle.cancel();
        }
        sim.stop().await;
        let outcome = timeout(SOON, moving).await.expect("no hang").unwrap();
        assert!(
            matches!(outcome, Err(MotionError::ConnectionClosed { .. })),
            "{delay} ms: {outcome:?}"
        );
        // The handle is kept, and keeps nothing running.
        timeout(SOON, async {
            while control_threads() > 0 {
                sleep(Duration::from_millis(5)).await;
            }
        })
        .await
        .expect("the thread has ended");
        drop(robot);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_client_that_vanishes_after_its_move_makes_room_at_once() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    robot.shutdown().await;
    for _ in 0..3 {
        let mut stream = TcpStream::connect(sim.addr()).await.unwrap();
        let mut session = client::Session::new(Version::V10);
        stream
            .write_all(session.connect(9).as_bytes())
            .await
            .unwrap();
        let mut received = Vec::new();
        while next_message(&received).unwrap().is_none() {
            assert!(stream.read_buf(&mut received).await.unwrap() > 0);
        }
        session
            .on_message(next_message(&received).unwrap().unwrap())
            .unwrap();
        let request = MoveRequest::new(
            MoveControllerMode::ExternalController,
            MoveGeneratorMode::None,
        );
        let request = session.request(&Request::Move(request)).unwrap();
        stream.write_all(request.as_bytes()).await.unwrap();
        drop(stream);
        let robot = connect(&sim).await;
        let served = timeout(SOON, async {
            while robot.state().robot_mode != RobotMode::Idle {
                robot.recover().await.unwrap();
            }
            robot.move_to(robot.pose()).await.unwrap();
        });
        served.await.expect("served at once");
        robot.shutdown().await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_cancelled_token_brakes_ends_and_closes() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    robot.shutdown().await;
    let token = CancellationToken::new();
    let builder = Robot::builder(sim.addr())
        .realtime(Realtime::Ignore)
        .cancellation(token.child_token());
    let robot = builder.connect().await.unwrap();
    let mut states = robot.states();
    let moving = tokio::spawn(long_way(&robot).into_future());
    under_way(&robot).await;
    token.cancel();
    assert_eq!(moving.await.unwrap(), Err(MotionError::Stopped));
    timeout(SOON, async { while states.changed().await.is_ok() {} })
        .await
        .expect("closed");
    let state = sim.state().await.unwrap();
    assert_eq!(state.robot_mode, RobotMode::Idle, "{}", state.reflex_reason);
    let error = robot.stop().await.unwrap_err();
    assert_eq!(error.to_string(), "this program has closed the connection");
    robot.shutdown().await;
    assert_eq!(control_threads(), 0);
}

#[tokio::test(flavor = "multi_thread")]
async fn the_end_of_a_connection_can_be_awaited_with_its_reason() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    let other = robot.clone();
    let closed = tokio::spawn(async move { other.closed().await });
    sim.stop().await;
    let reason = timeout(SOON, closed).await.expect("no hang").unwrap();
    assert_eq!(reason, CloseReason::ClosedByPeer);
    assert_eq!(reason.party(), Party::Link);

    let (robot, _sim) = simulated().await;
    robot.shutdown().await;
    assert_eq!(robot.closed().await, CloseReason::ClosedByUs);
}

/// The connection ends before the task that serves it reads the motion.
#[tokio::test]
async fn motion_asked_for_behind_a_shutdown_is_told_of_it() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    let motion = robot.move_joints(robot.state().q).into_future();
    let ((), outcome) = join(robot.shutdown(), motion).await;
    let reason = CloseReason::ClosedByUs;
    assert_eq!(outcome, Err(MotionError::ConnectionClosed { reason }));
    sim.stop().await;
}

#[tokio::test]
async fn one_thread_is_runtime_enough() {
    let _alone = alone();
    let (robot, sim) = simulated().await;
    let up = Pose::translation(0.0, 0.0, 0.02) * robot.pose();
    robot.move_to(up).await.unwrap();
    robot.shutdown().await;
    sim.stop().await;
}

#[test]
fn a_runtime_that_ends_in_mid_motion_leaves_nothing_running() {
    let _alone = alone();
    let build = || {
        tokio::runtime::Builder::new_multi_thread()
            .worker_threads(1)
            .enable_all()
            .build()
            .unwrap()
    };
    let (elsewhere, runtime) = (build(), build());
    let (first, sim) = elsewhere.block_on(at_the_clients_pace(Sim::fr3().ideal()));
    elsewhere.block_on(first.shutdown());
    let robot = runtime.block_on(connect(&sim));
    let moving = elsewhere.spawn(long_way(&robot).into_future());
    elsewhere.block_on(under_way(&robot));
    drop(runtime);
    let text = "the Tokio runtime that served the connection has ended";
    let outcome = elsewhere.block_on(moving).unwrap();
    assert_eq!(outcome.unwrap_err().to_string(), text);
    let error = elsewhere.block_on(robot.recover()).unwrap_err();
    assert_eq!(error.to_string(), text);
    let begun = Instant::now();
    while control_threads() > 0 || elsewhere.block_on(sim.with(|r| r.is_connected())).unwrap() {
        assert!(begun.elapsed() < SOON, "the thread or the socket lives on");
        std::thread::sleep(Duration::from_millis(5));
    }
    // The next one recovers the robot, which missed its commands.
    elsewhere.block_on(async {
        let robot = connect(&sim).await;
        robot.recover().await.unwrap();
        robot.move_to(robot.pose()).await.unwrap();
        robot.shutdown().await;
        sim.stop().await;
    });
}

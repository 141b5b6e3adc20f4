//! A supervised robot over real sockets: a simulator that is killed and started again at the same
//! port, its user stop, a network that is cut, motions that wait and that are refused.
//!
//! What the supervisor decides is tested in lockstep: `tests/lockstep/supervised`. Here it is
//! whether sockets, threads and futures follow.

use std::future::IntoFuture;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use franka_async::diagnosis::Diagnose;
use franka_async::error::{CloseReason, Unready};
use franka_async::state::{RobotError, RobotMode};
use franka_async::supervision::{
    Backoff, Condition, EventKind, Events, NotRecovered, Notification, Policy,
};
use franka_async::{Engage, MotionError, Pose, Realtime, Robot};
use franka_sim::{Running, Sim, Tool};
use franka_tests::PATIENCE;
use tokio::time::{sleep, timeout};

use crate::{SOON, alone, long_way, under_way};

/// Soon again, and for ever.
fn policy() -> Policy {
    Policy::default()
        .reconnect(Backoff {
            first: Duration::from_millis(10),
            most: Duration::from_millis(100),
            ..Backoff::default()
        })
        .recover(1000, Duration::from_secs(1))
}

async fn start(sim: Sim) -> Running {
    let sim = sim.ideal().tool(Tool::hand()).virtual_time(PATIENCE);
    sim.start().await.expect("a simulator starts")
}

/// A simulator in the place of one that was stopped.
async fn restart(address: SocketAddr) -> Running {
    timeout(SOON, async {
        loop {
            let sim = Sim::fr3().ideal().tool(Tool::hand());
            let sim = sim.virtual_time(PATIENCE).bind(address);
            match sim.start().await {
                Ok(sim) => return sim,
                // The port is not free at once.
                Err(_) => sleep(Duration::from_millis(5)).await,
            }
        }
    })
    .await
    .expect("the port is free again")
}

async fn supervised(sim: &Running, policy: Policy) -> Robot {
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let robot = builder.supervise(policy).connect().await;
    robot.expect("a simulator takes a client")
}

/// Waits for an event of which `is` finds something, and returns that.
async fn told<T>(events: &mut Events, mut is: impl FnMut(&EventKind) -> Option<T>) -> T {
    let found = async {
        loop {
            let Notification { event, missed, .. } = events.next().await.expect("it goes on");
            assert_eq!(missed, 0);
            if let Some(found) = is(&event.kind) {
                return found;
            }
        }
    };
    timeout(SOON, found).await.expect("it is told")
}

async fn condition(robot: &Robot, condition: Condition) {
    let mut health = robot.health();
    let shown = health.wait_for(|health| health.condition == condition);
    timeout(SOON, shown)
        .await
        .unwrap_or_else(|_| panic!("{:?} for {condition:?}", robot.health().newest()))
        .expect("it goes on");
}

async fn small_motion(robot: &Robot) -> Result<(), MotionError> {
    let up = Pose::translation(0.0, 0.0, 0.005) * robot.pose();
    let moving = robot.move_to(up).into_future();
    let outcome = timeout(SOON, moving).await.expect("it resolves");
    outcome.map(drop)
}

fn connected(kind: &EventKind) -> Option<Duration> {
    match kind {
        EventKind::Connected { after, .. } => *after,
        _ => None,
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_robot_that_was_restarted_is_there_again_and_stands_still() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy()).await;
    let mut events = robot.events();
    let mut states = robot.states();
    let (model, stats) = (robot.model() as *const _, robot.stats());

    let arm = robot.engage(Engage::default()).await.expect("it is ready");
    let up = Pose::translation(0.0, 0.0, 0.1) * robot.pose();
    let moving = tokio::spawn(arm.move_to(up).speed(0.05).into_future());
    under_way(&robot).await;
    sim.stop().await;
    let outcome = timeout(SOON, moving).await.expect("no hang").unwrap();
    assert!(
        matches!(outcome, Err(MotionError::ConnectionClosed { .. })),
        "{outcome:?}"
    );
    let lost = |kind: &EventKind| match kind {
        EventKind::Lost { reason } => Some(reason.clone()),
        _ => None,
    };
    assert_eq!(told(&mut events, lost).await, CloseReason::ClosedByPeer);
    assert_ne!(robot.health().newest().condition, Condition::Ready);
    // A command has no connection, and a motion does not wait.
    let error = robot.recover().await.unwrap_err();
    assert_eq!(error.to_string(), "libfranka: server closed connection");
    let why = Unready::Disconnected;
    let refused = robot.move_to(up).await.unwrap_err();
    let waited = Duration::ZERO;
    assert_eq!(refused, MotionError::NotReady { why, waited });

    let sim = restart(address).await;
    let after = told(&mut events, connected).await;
    condition(&robot, Condition::Ready).await;
    let health = robot.health().newest();
    assert_eq!(health.last_reconnect, Some(after));
    assert_eq!((health.reconnects, health.attempts), (1, 0));
    assert_eq!(robot.model() as *const _, model, "goals are made for it");
    assert!(!Arc::ptr_eq(&robot.stats(), &stats), "another thread");
    let seen = timeout(SOON, states.changed()).await.expect("no hang");
    seen.expect("the newest states go on");

    // The session of before answers with its end, and nothing moves.
    let ended = arm.set(up).await.unwrap_err();
    assert!(
        matches!(ended, MotionError::ConnectionClosed { .. }),
        "{ended}"
    );
    assert!(arm.ended().await.is_err());
    let before = sim.state().await.unwrap().q;
    crate::robot_time(&robot, 500).await;
    let state = sim.state().await.unwrap();
    assert_eq!(state.robot_mode, RobotMode::Idle);
    for (before, now) in before.iter().zip(state.q) {
        assert!((before - now).abs() < 1e-6, "the arm has moved");
    }
    small_motion(&robot).await.expect("the next one works");
    drop(arm);
    let closed = tokio::spawn({
        let robot = robot.clone();
        async move { robot.closed().await }
    });
    robot.shutdown().await;
    assert_eq!(closed.await.unwrap(), CloseReason::ClosedByUs);
    let end = async { while states.changed().await.is_ok() {} };
    timeout(SOON, end).await.expect("they end");
    let closed = |kind: &EventKind| matches!(kind, EventKind::Closed { .. }).then_some(());
    told(&mut events, closed).await;
    assert!(events.next().await.is_none());
    assert_eq!(robot.health().newest().condition, Condition::Closed);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_reflex_is_diagnosed_and_recovered_from_as_the_policy_says() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let trip = async || {
        let trip = |robot: &mut franka_sim::Robot| robot.trip(RobotError::CartesianReflex);
        sim.with(trip).await.expect("it runs");
    };
    let robot = supervised(&sim, policy()).await;
    let mut events = robot.events();
    let moving = tokio::spawn(long_way(&robot).into_future());
    under_way(&robot).await;
    trip().await;
    let outcome = timeout(SOON, moving).await.expect("no hang").unwrap();
    assert!(
        matches!(outcome, Err(MotionError::Control(_))),
        "{outcome:?}"
    );
    let reflex = |kind: &EventKind| match kind {
        EventKind::Reflex(reflex) => Some(reflex.clone()),
        _ => None,
    };
    let told_of = told(&mut events, reflex).await;
    assert!(told_of.errors.contains(RobotError::CartesianReflex));
    let diagnosis = told_of.diagnose().expect("it ended a motion");
    assert_eq!(diagnosis.error, Some(RobotError::CartesianReflex));
    let recovered = |kind: &EventKind| match kind {
        EventKind::Recovered {
            after,
            by_supervisor,
            ..
        } => Some((*after, *by_supervisor)),
        _ => None,
    };
    let (after, by_supervisor) = told(&mut events, recovered).await;
    assert!(by_supervisor);
    let health = robot.health().newest();
    assert_eq!(
        (health.condition, health.last_recovery),
        (Condition::Ready, Some(after))
    );
    small_motion(&robot).await.expect("the next one works");
    robot.shutdown().await;

    // A function is asked, and declines the first.
    let asked = Arc::new(AtomicU64::new(0));
    let count = asked.clone();
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let builder = builder
        .supervise(policy())
        .ask_before_recovery(move |reflex| {
            assert!(reflex.error.is_none(), "nothing moved");
            count.fetch_add(1, Ordering::Relaxed) > 0
        });
    let robot = builder.connect().await.expect("it takes a client");
    let mut events = robot.events();
    trip().await;
    let left = |kind: &EventKind| match kind {
        EventKind::NotRecovered { why, .. } => Some(*why),
        _ => None,
    };
    assert_eq!(told(&mut events, left).await, NotRecovered::Declined);
    condition(&robot, Condition::Unready(Unready::Reflex)).await;
    robot.recover().await.expect("by this program");
    let (_, by_supervisor) = told(&mut events, recovered).await;
    assert!(!by_supervisor);
    trip().await;
    assert!(told(&mut events, recovered).await.1);
    assert_eq!(asked.load(Ordering::Relaxed), 2);
    robot.shutdown().await;

    // A person is asked.
    let robot = supervised(&sim, policy().ask_first()).await;
    trip().await;
    condition(&robot, Condition::Unready(Unready::AgreementAwaited)).await;
    let number = robot.health().newest().reflex.expect("there is one");
    assert!(!robot.agree(number + 1, true));
    assert!(robot.agree(number, true));
    condition(&robot, Condition::Ready).await;
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_user_stop_ends_a_motion_and_its_release_starts_none() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let robot = supervised(&sim, policy().motions_wait(SOON)).await;
    let mut events = robot.events();
    let stop = |pressed| {
        move |kind: &EventKind| {
            let told = EventKind::UserStop { pressed };
            (*kind == told).then_some(())
        }
    };
    let moving = tokio::spawn(long_way(&robot).into_future());
    under_way(&robot).await;
    sim.with(|robot| robot.press_user_stop(true)).await.unwrap();
    let outcome = timeout(SOON, moving).await.expect("no hang").unwrap();
    assert!(
        matches!(outcome, Err(MotionError::Control(_))),
        "{outcome:?}"
    );
    told(&mut events, stop(true)).await;
    condition(&robot, Condition::Unready(Unready::UserStopped)).await;
    // The robot refuses it: it does not wait for the release.
    let refused = timeout(SOON, small_motion(&robot)).await.expect("at once");
    assert!(
        matches!(refused, Err(MotionError::Rejected(_))),
        "{refused:?}"
    );
    sim.with(|robot| robot.press_user_stop(false))
        .await
        .unwrap();
    told(&mut events, stop(false)).await;
    condition(&robot, Condition::Ready).await;
    crate::robot_time(&robot, 300).await;
    assert_eq!(robot.state().robot_mode, RobotMode::Idle);
    small_motion(&robot).await.expect("the next one works");
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn motions_wait_for_a_robot_and_begin_for_whoever_awaits_them_only() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy().motions_wait(SOON)).await;
    let q = robot.state().q;
    let target = |joint: usize| {
        let mut q = q;
        q[joint] += 0.05;
        q
    };
    sim.stop().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    let superseded = tokio::spawn(robot.move_joints(target(0)).into_future());
    until_waiting(&robot, &superseded).await;
    let stopped = tokio::spawn(robot.move_joints(target(1)).into_future());
    assert_eq!(superseded.await.unwrap(), Err(MotionError::Superseded));
    // Without a connection it is not known whether the arm rests.
    robot.stop().await.unwrap_err();
    assert_eq!(stopped.await.unwrap(), Err(MotionError::Stopped));
    // Dropped, detached, and cancelled.
    let dropped = tokio::spawn(robot.move_joints(target(2)).into_future());
    until_waiting(&robot, &dropped).await;
    dropped.abort();
    assert!(dropped.await.unwrap_err().is_cancelled());
    let motion = robot.move_joints(target(3));
    let handle = motion.handle();
    let cancelled = tokio::spawn(motion.into_future());
    until_waiting(&robot, &cancelled).await;
    handle.cancel();
    assert_eq!(cancelled.await.unwrap(), Err(MotionError::Stopped));
    robot.move_joints(target(4)).detach();

    let sim = restart(address).await;
    condition(&robot, Condition::Ready).await;
    crate::robot_time(&robot, 300).await;
    let state = sim.state().await.unwrap();
    assert_eq!(state.robot_mode, RobotMode::Idle);
    for (before, now) in q.iter().zip(state.q) {
        assert!((before - now).abs() < 1e-6, "nobody awaits a motion");
    }

    sim.stop().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    let waiting = tokio::spawn(robot.move_joints(target(5)).into_future());
    until_waiting(&robot, &waiting).await;
    let sim = restart(address).await;
    let outcome = timeout(SOON, waiting).await.expect("no hang").unwrap();
    outcome.expect("it arrives");
    let moved = sim.state().await.unwrap().q[5] - q[5];
    assert!((moved - 0.05).abs() < 2e-3, "{moved}");

    // A session waits likewise.
    sim.stop().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    let engaging = tokio::spawn({
        let robot = robot.clone();
        async move { robot.engage(Engage::default()).await }
    });
    let sim = restart(address).await;
    let arm = timeout(SOON, engaging).await.expect("no hang").unwrap();
    let arm = arm.expect("the session begins");
    arm.disengage().await.expect("it ends");
    robot.shutdown().await;
    sim.stop().await;
}

/// Gives a motion of another task the time to be asked for; it is there to stay.
async fn until_waiting<T>(robot: &Robot, motion: &tokio::task::JoinHandle<T>) {
    for _ in 0..50 {
        tokio::task::yield_now().await;
        sleep(Duration::from_millis(1)).await;
    }
    assert!(!motion.is_finished(), "{:?}", robot.health().newest());
}

/// While nothing is under way, so that the robot minds no missing command; longer than the link
/// timeout, and than the supervisor bears with it.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_network_that_is_cut_is_told_and_the_connection_given_up_for_it() {
    let _alone = alone();
    let mut network = franka_sim::Network::perfect();
    let cut = Duration::from_secs(2)..Duration::from_secs(4);
    network.to_client.cut(cut);
    let sim = Sim::fr3().ideal().tool(Tool::hand()).network(network);
    let sim = sim.start().await.expect("it starts");
    let builder = Robot::builder(sim.addr())
        .realtime(Realtime::Ignore)
        .link_timeout(Duration::from_millis(300))
        .connect_timeout(Duration::from_millis(300));
    let silence = Duration::from_millis(300);
    let robot = builder.supervise(policy().silence(silence)).connect().await;
    let robot = robot.expect("the network is there");
    let mut events = robot.events();
    let silent = |kind: &EventKind| matches!(kind, EventKind::Silent { .. }).then_some(());
    told(&mut events, silent).await;
    let lost = |kind: &EventKind| match kind {
        EventKind::Lost { reason } => Some(reason.clone()),
        _ => None,
    };
    let reason = told(&mut events, lost).await;
    assert!(matches!(reason, CloseReason::Silent { .. }), "{reason}");
    let after = told(&mut events, connected).await;
    assert!(after > silence, "{after:?}");
    condition(&robot, Condition::Ready).await;
    robot.shutdown().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn another_robot_in_the_place_of_the_first_is_refused() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy()).await;
    sim.stop().await;
    let other = timeout(SOON, async {
        loop {
            match Sim::fer().ideal().bind(address).start().await {
                Ok(other) => return other,
                Err(_) => sleep(Duration::from_millis(5)).await,
            }
        }
    });
    let _other = other.await.expect("the port is free again");
    let reason = timeout(SOON, robot.closed()).await.expect("it gives up");
    assert!(
        matches!(reason, CloseReason::AnotherRobot { .. }),
        "{reason}"
    );
    let error = robot.move_to(robot.pose()).await.unwrap_err();
    assert!(matches!(error, MotionError::ConnectionClosed { .. }));
}

/// Threads and open descriptors of this process.
fn resources() -> (usize, usize) {
    let count = |path| std::fs::read_dir(path).expect("Linux").count();
    (count("/proc/self/task"), count("/proc/self/fd"))
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_thread_and_no_descriptor_is_left_behind_by_mishaps() {
    let _alone = alone();
    let mut sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy()).await;
    small_motion(&robot).await.expect("it is ready");
    let mut before = resources();
    for round in 0..25 {
        if round == 5 {
            // Whatever the runtime has started for good by now.
            before = resources();
        }
        let moving = tokio::spawn(long_way(&robot).into_future());
        under_way(&robot).await;
        if round % 5 == 4 {
            sim.with(|robot| robot.trip(RobotError::JointReflex))
                .await
                .unwrap();
        } else {
            sim.stop().await;
            sim = restart(address).await;
        }
        let outcome = timeout(SOON, moving).await.expect("no hang").unwrap();
        outcome.expect_err("it was cut short");
        condition(&robot, Condition::Ready).await;
    }
    // The runtime ends idle threads of blocking work when it likes.
    let settled = timeout(SOON, async {
        while resources().0 > before.0 || resources().1 > before.1 {
            sleep(Duration::from_millis(20)).await;
        }
    });
    let left = settled.await.map_err(|_| resources());
    assert_eq!(left, Ok(()), "before: {before:?}");
    assert_eq!(robot.health().newest().reconnects, 20);
    robot.shutdown().await;
    let threads = std::fs::read_dir("/proc/self/task").unwrap();
    let control = threads
        .filter_map(|task| std::fs::read_to_string(task.ok()?.path().join("comm")).ok())
        .filter(|name| name.trim() == "franka-rt");
    assert_eq!(control.count(), 0);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_last_handle_ends_the_supervisor_also_without_a_connection() {
    let _alone = alone();
    let sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy()).await;
    let mut events = robot.events();
    drop(robot);
    let closed = |kind: &EventKind| match kind {
        EventKind::Closed { reason } => Some(reason.clone()),
        _ => None,
    };
    assert_eq!(told(&mut events, closed).await, CloseReason::ClosedByUs);

    let robot = supervised(&sim, policy()).await;
    let mut events = robot.events();
    sim.stop().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    drop(robot);
    assert_eq!(told(&mut events, closed).await, CloseReason::ClosedByUs);
    let sim = restart(address).await;
    sleep(Duration::from_millis(300)).await;
    assert!(!sim.with(|robot| robot.is_connected()).await.unwrap());

    let robot = supervised(&sim, policy()).await;
    sim.stop().await;
    condition(&robot, Condition::Unready(Unready::Disconnected)).await;
    timeout(SOON, robot.shutdown()).await.expect("no hang");
    assert_eq!(robot.closed().await, CloseReason::ClosedByUs);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_robot_that_is_not_supervised_tells_what_happens_and_stays_as_it_is() {
    let _alone = alone();
    let (robot, sim) = crate::simulated().await;
    let mut events = robot.events();
    small_motion(&robot).await.expect("it arrives");
    let ended = |kind: &EventKind| match kind {
        EventKind::MotionEnded { outcome, .. } => Some(outcome.is_ok()),
        _ => None,
    };
    assert!(told(&mut events, ended).await);
    sim.with(|robot| robot.trip(RobotError::JointReflex))
        .await
        .unwrap();
    let left = |kind: &EventKind| match kind {
        EventKind::NotRecovered { why, .. } => Some(*why),
        _ => None,
    };
    assert_eq!(told(&mut events, left).await, NotRecovered::Never);
    condition(&robot, Condition::Unready(Unready::Reflex)).await;
    robot.recover().await.expect("it recovers");
    condition(&robot, Condition::Ready).await;
    sim.stop().await;
    let closed = |kind: &EventKind| match kind {
        EventKind::Closed { reason } => Some(reason.clone()),
        _ => None,
    };
    assert_eq!(told(&mut events, closed).await, CloseReason::ClosedByPeer);
    assert_eq!(robot.health().newest().condition, Condition::Closed);
}

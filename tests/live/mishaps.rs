//! Each thing that a network does to datagrams, between the simulator's sockets and the driver's.
//!
//! In virtual time the same networks are in `tests/lockstep/mishaps.rs`, where what they do is
//! exact. Here a busy machine does some of its own, which loses no state but makes commands late:
//! the robots wait for commands, and bounds are wide.

use std::future::IntoFuture;
use std::time::{Duration, Instant};

use franka_async::{MotionError, MotionReport, Moving, Robot, RobotError, Version};
use franka_sim::{Network, Running, Sim, Tool};
use franka_tests::mishaps;
use futures::future::join_all;
use tokio::sync::broadcast::error::RecvError;
use tokio::time::timeout;

use crate::{alone, connect};

/// What the driver saw of a motion over such a network.
#[derive(Debug)]
struct Seen {
    version: Version,
    report: MotionReport,
    /// Of all states that should have come: those that never did.
    lost: f64,
    /// Those that were not newer than another one.
    stale: f64,
    /// Most states in a row that the control thread did not see.
    row: u64,
}

/// The robots, each with a network of its own.
async fn robots(strict: bool, network: impl Fn() -> Network) -> Vec<(Robot, Running)> {
    let mut robots = Vec::new();
    for sim in [Sim::fr3(), Sim::fer()] {
        let sim = sim.tool(Tool::hand()).enforce_communication(strict);
        let sim = sim.network(network()).start().await;
        let sim = sim.expect("a simulator starts");
        robots.push((connect(&sim).await, sim));
    }
    robots
}

/// A motion of some two seconds, and what was seen meanwhile.
async fn travel((robot, sim): (Robot, Running)) -> Seen {
    let count = || {
        let stats = robot.stats();
        [&stats.states, &stats.skipped, &stats.lost, &stats.stale].map(|counter| counter.get())
    };
    let mut records = robot.records();
    let row = tokio::spawn(async move {
        let mut row = 0;
        loop {
            match records.recv().await {
                Ok(record) => row = row.max(record.skipped),
                Err(RecvError::Lagged(_)) => {}
                Err(RecvError::Closed) => return row,
            }
        }
    });
    let before = count();
    let (motion, target) = turning(&robot);
    let outcome = timeout(LONGEST, motion).await.expect("it resolves");
    let report = outcome.expect("it arrives");
    let after = count();
    for (is, target) in robot.state().q.iter().zip(target) {
        assert!((is - target).abs() < 5e-3, "{is} for {target}");
    }
    let version = robot.version();
    robot.shutdown().await;
    sim.stop().await;
    let [states, skipped, lost, stale]: [u64; 4] = core::array::from_fn(|i| after[i] - before[i]);
    let all = (states + skipped + lost) as f64;
    let seen = Seen {
        version,
        report,
        lost: lost as f64 / all,
        stale: stale as f64 / all,
        row: row.await.expect("no panic"),
    };
    println!("{seen:?}");
    seen
}

/// A slow motion, and where it ends.
fn turning(robot: &Robot) -> (Moving, [f64; 7]) {
    let mut q = robot.state().q;
    q[0] += 0.4;
    q[5] += 0.2;
    (robot.move_joints(q).speed(0.5).into_future(), q)
}

/// Both robots over such a network, at once.
async fn both(network: impl Fn() -> Network) -> Vec<Seen> {
    let robots = robots(false, network).await;
    join_all(robots.into_iter().map(travel)).await
}

fn assert_about(value: f64, expected: f64, tolerance: f64, seen: &Seen) {
    let error = (value - expected).abs();
    assert!(error < tolerance, "{value} for {expected}: {seen:?}");
}

/// IPv4 packets of a state.
fn packets(version: Version) -> i32 {
    match version {
        Version::V5 => 2,
        Version::V10 => 1,
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_a_network_loses_is_counted_and_the_arm_arrives() {
    let _alone = alone();
    let (loss, bursts, halves) = tokio::join!(
        both(|| mishaps::loss(3)),
        both(|| mishaps::bursts(3)),
        both(|| mishaps::halves(3)),
    );
    for seen in &loss {
        let expected = 1.0 - (1.0 - mishaps::LOST).powi(packets(seen.version));
        assert_about(seen.lost, expected, 0.02, seen);
        assert!(seen.report.lost_states > 0, "{seen:?}");
    }
    for seen in &bursts {
        assert_about(seen.lost, mishaps::LOST, 0.03, seen);
        assert!(seen.lost > 0.0 && seen.row > 4, "{seen:?}");
    }
    for seen in &halves {
        // The tolerance tells one packet from two.
        let expected = 1.0 - (1.0 - mishaps::LOST_TO_CLIENT).powi(packets(seen.version));
        assert_about(seen.lost, expected, 0.025, seen);
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn what_a_network_delays_reorders_or_doubles_is_told_apart_and_the_arm_arrives() {
    let _alone = alone();
    let (delay, jitter, reordering, duplication) = tokio::join!(
        both(|| mishaps::delay(Duration::from_micros(150))),
        both(|| mishaps::jitter(3)),
        both(|| mishaps::reordering(3)),
        both(|| mishaps::duplication(3)),
    );
    for seen in delay.iter().chain(&jitter) {
        assert_eq!((seen.lost, seen.stale), (0.0, 0.0), "{seen:?}");
    }
    for seen in &jitter {
        assert!(seen.report.success_rate_avg < 0.95, "{seen:?}");
    }
    for seen in &reordering {
        // Each of them comes after all, unless it waits in the socket with what overtook it.
        assert_about(seen.lost, mishaps::OVERTAKEN, 0.06, seen);
        assert_about(seen.stale, mishaps::OVERTAKEN, 0.06, seen);
    }
    for seen in &duplication {
        assert_eq!(seen.lost, 0.0, "{seen:?}");
        assert_about(seen.stale, mishaps::DOUBLED, 0.1, seen);
    }
}

/// So late, no command is in time either.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn states_are_as_old_as_the_network_makes_them() {
    let _alone = alone();
    let delay = Duration::from_millis(30);
    for (robot, sim) in robots(true, || mishaps::delay(delay)).await {
        let (motion, _) = turning(&robot);
        let moving = tokio::spawn(motion);
        let mut states = robot.state_stream();
        for _ in 0..10 {
            let asked = Instant::now();
            let published = sim.state().await.expect("it runs").message_id;
            loop {
                let state = states.next().await.expect("states come").state;
                assert_eq!(state.control_command_success_rate, 0.0);
                if state.message_id > published {
                    break;
                }
            }
            assert!(asked.elapsed() >= delay, "{:?}", asked.elapsed());
        }
        moving.abort();
        robot.shutdown().await;
        sim.stop().await;
    }
}

/// Of 16 ms when robots wait for commands, and of 60 ms when they do not.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_cut_is_bridged_or_a_reflex() {
    let _alone = alone();
    // From the robot's start: a motion runs by then.
    let begin = Duration::from_millis(1000);
    let cut = |milliseconds| mishaps::cut(begin..begin + Duration::from_millis(milliseconds));
    for seen in both(|| cut(16)).await {
        // On a busy machine, the simulator sends fewer than one in a millisecond.
        assert!(seen.report.lost_states >= 6 && seen.row >= 6, "{seen:?}");
    }
    let strict = robots(true, || cut(60)).await;
    join_all(strict.into_iter().map(trip)).await;
}

/// A motion that ends in a reflex for want of commands, and a recovery from it.
async fn trip((robot, _sim): (Robot, Running)) {
    let (motion, _) = turning(&robot);
    let outcome = timeout(LONGEST, motion).await.expect("it resolves");
    let Err(MotionError::Control(error)) = outcome else {
        panic!("{outcome:?}")
    };
    let reasons = error.failure.reflex_reason;
    assert!(
        reasons.contains(RobotError::CommunicationConstraintsViolation),
        "{error}"
    );
    robot.recover().await.expect("it takes motions");
    robot.shutdown().await;
}

/// What resolves later than this is lost.
const LONGEST: Duration = Duration::from_secs(30);

//! The time until a supervised robot accepts motions again, over real sockets: after a reflex, and
//! after its simulator was killed and restarted at once.
//!
//! The supervisor itself reports the values. A simulated recovery takes 100 ms, chosen by the
//! simulator.

use std::net::SocketAddr;
use std::time::Duration;

use franka_async::state::RobotError;
use franka_async::supervision::{EventKind, Events, Policy};
use franka_async::{Realtime, Robot};
use franka_sim::{Running, Sim};

use super::{Benchmark, Statistic};

/// Number of reflexes in a round.
const REFLEXES: usize = 3;

/// Returns all benchmarks of supervision. Their samples are milliseconds.
pub fn all() -> Vec<Benchmark> {
    vec![
        Benchmark {
            key: "supervisor.recover_ms",
            statistics: &[Statistic::P50],
            round: Box::new(|| block_on(recoveries())),
        },
        Benchmark {
            key: "supervisor.reconnect_ms",
            statistics: &[Statistic::P50],
            round: Box::new(|| block_on(reconnects())),
        },
    ]
}

fn block_on(round: impl Future<Output = Vec<u64>>) -> Vec<u64> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .expect("a runtime");
    runtime.block_on(round)
}

async fn supervised() -> (Robot, Running) {
    let sim = Sim::fr3().start().await.expect("a simulator starts");
    let policy = Policy::default().recover(u32::MAX, Duration::from_secs(1));
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let robot = builder.supervise(policy).connect().await;
    (robot.expect("a simulator takes a client"), sim)
}

async fn recoveries() -> Vec<u64> {
    let (robot, sim) = supervised().await;
    let mut events = robot.events();
    let mut samples = Vec::new();
    for _ in 0..REFLEXES {
        sim.with(|robot| robot.trip(RobotError::CartesianReflex))
            .await
            .expect("it runs");
        let recovered = |kind: &EventKind| match kind {
            EventKind::Recovered { after, .. } => Some(*after),
            _ => None,
        };
        samples.push(told(&mut events, recovered).await);
    }
    robot.shutdown().await;
    samples
}

async fn reconnects() -> Vec<u64> {
    let (robot, sim) = supervised().await;
    let mut events = robot.events();
    // After a connection of less than a second, the next one is delayed.
    tokio::time::sleep(Duration::from_millis(1100)).await;
    let address = sim.addr();
    sim.stop().await;
    let _sim = restart(address).await;
    let connected = |kind: &EventKind| match kind {
        EventKind::Connected { after, .. } => *after,
        _ => None,
    };
    let sample = told(&mut events, connected).await;
    robot.shutdown().await;
    vec![sample]
}

async fn restart(address: SocketAddr) -> Running {
    loop {
        match Sim::fr3().bind(address).start().await {
            Ok(sim) => return sim,
            // The port is not free immediately.
            Err(_) => tokio::time::sleep(Duration::from_millis(1)).await,
        }
    }
}

/// Waits for the event for which `is` returns a duration, and returns it, `[ms]`.
async fn told(events: &mut Events, is: impl Fn(&EventKind) -> Option<Duration>) -> u64 {
    loop {
        let notification = events.next().await.expect("the robot is supervised");
        if let Some(after) = is(&notification.event.kind) {
            return u64::try_from(after.as_millis()).unwrap_or(u64::MAX).max(1);
        }
    }
}

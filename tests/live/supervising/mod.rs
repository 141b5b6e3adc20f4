//! A supervised robot over real sockets: a simulator that is killed and started again at the same
//! port, its user stop, a network that is cut, motions that wait and that are refused.
//!
//! The decisions of the supervisor are tested in lockstep: `tests/lockstep/supervised`. These tests
//! check that sockets, threads and futures follow.

mod connections;
mod leaks;
mod recoveries;
mod waiting;

use std::future::IntoFuture;
use std::net::{Ipv4Addr, SocketAddr};
use std::time::Duration;

use franka_async::supervision::{Backoff, Condition, EventKind, Events, Notification, Policy};
use franka_async::{MotionError, Pose, Realtime, Robot};
use franka_sim::{Running, Sim, Tool};
use franka_tests::PATIENCE;
use tokio::io::copy_bidirectional;
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinSet;
use tokio::time::{sleep, timeout};

use crate::SOON;

/// Retries soon, and indefinitely.
pub(crate) fn policy() -> Policy {
    Policy::default()
        .reconnect(Backoff {
            first: Duration::from_millis(10),
            most: Duration::from_millis(100),
            ..Backoff::default()
        })
        .recover(1000, Duration::from_secs(1))
}

pub(crate) async fn start(sim: Sim) -> Running {
    let sim = sim.ideal().tool(Tool::hand()).virtual_time(PATIENCE);
    sim.start().await.expect("a simulator starts")
}

/// A simulator in the place of a stopped one.
pub(crate) async fn restart(address: SocketAddr) -> Running {
    let sim = || Sim::fr3().ideal().tool(Tool::hand());
    started_at(address, || sim().virtual_time(PATIENCE)).await
}

/// This simulator in the place of a stopped one.
pub(crate) async fn started_at(address: SocketAddr, sim: impl Fn() -> Sim) -> Running {
    timeout(SOON, async {
        loop {
            match sim().bind(address).start().await {
                Ok(sim) => return sim,
                // The port is not free immediately.
                Err(_) => sleep(Duration::from_millis(5)).await,
            }
        }
    })
    .await
    .expect("the port is free again")
}

/// The way to a simulator's command port, which can be cut and mended: the robot stays the same.
pub(crate) struct Relay {
    address: SocketAddr,
    to: SocketAddr,
    passing: JoinSet<()>,
}

impl Relay {
    pub(crate) async fn open(to: SocketAddr) -> Self {
        let mut relay = Self {
            address: (Ipv4Addr::LOCALHOST, 0).into(),
            to,
            passing: JoinSet::new(),
        };
        relay.mend().await;
        relay
    }

    pub(crate) fn addr(&self) -> SocketAddr {
        self.address
    }

    /// Ends the connections, and refuses others.
    pub(crate) async fn cut(&mut self) {
        self.passing.shutdown().await;
    }

    pub(crate) async fn mend(&mut self) {
        let listener = timeout(SOON, async {
            loop {
                match TcpListener::bind(self.address).await {
                    Ok(listener) => return listener,
                    // The port is not free immediately.
                    Err(_) => sleep(Duration::from_millis(5)).await,
                }
            }
        });
        let listener = listener.await.expect("the port is free again");
        self.address = listener.local_addr().expect("it is bound");
        let to = self.to;
        self.passing.spawn(async move {
            loop {
                let (mut client, _) = listener.accept().await.expect("it listens");
                if let Ok(mut robot) = TcpStream::connect(to).await {
                    // Until one side closes.
                    let _ = copy_bidirectional(&mut client, &mut robot).await;
                }
            }
        });
    }
}

/// A simulator at no more than a thousand states per second, and the relay to it.
pub(crate) async fn relayed(sim: Sim) -> (Running, Relay) {
    let sim = sim.ideal().tool(Tool::hand()).wait_for_commands(PATIENCE);
    let sim = sim.start().await.expect("a simulator starts");
    let relay = Relay::open(sim.addr()).await;
    (sim, relay)
}

pub(crate) async fn supervised(sim: &Running, policy: Policy) -> Robot {
    supervised_at(sim.addr(), policy).await
}

pub(crate) async fn supervised_at(address: SocketAddr, policy: Policy) -> Robot {
    let builder = Robot::builder(address).realtime(Realtime::Ignore);
    let robot = builder.supervise(policy).connect().await;
    robot.expect("a simulator takes a client")
}

/// Waits for an event for which `is` returns a value, and returns the value.
pub(crate) async fn told<T>(events: &mut Events, mut is: impl FnMut(&EventKind) -> Option<T>) -> T {
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

pub(crate) async fn condition(robot: &Robot, condition: Condition) {
    let mut health = robot.health();
    let shown = health.wait_for(|health| health.condition == condition);
    timeout(SOON, shown)
        .await
        .unwrap_or_else(|_| panic!("{:?} for {condition:?}", robot.health().newest()))
        .expect("it goes on");
}

pub(crate) async fn small_motion(robot: &Robot) -> Result<(), MotionError> {
    let up = Pose::translation(0.0, 0.0, 0.005) * robot.pose();
    let moving = robot.move_to(up).into_future();
    let outcome = timeout(SOON, moving).await.expect("it resolves");
    outcome.map(drop)
}

pub(crate) fn connected(kind: &EventKind) -> Option<Duration> {
    match kind {
        EventKind::Connected { after, .. } => *after,
        _ => None,
    }
}

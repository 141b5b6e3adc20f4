//! Connects to a robot with the options of a builder.

use std::hash::{BuildHasher, RandomState};
use std::sync::Arc;

use franka_proto::RobotState;
use franka_rt::driver::{ControlLog, LinkTimeout};
use tokio::sync::{mpsc, watch};
use tokio_util::sync::CancellationToken;
use tracing::Instrument;

use crate::builder::Builder;
use crate::endpoint::Endpoint;
use crate::error::ConnectError;
use crate::open::{Opened, open};
use crate::reconnect::Reconnector;
use crate::robot::Robot;
use crate::supervisor::Supervisor;
use crate::world;

impl Robot {
    /// Connects with the default options of [`Robot::builder`].
    ///
    /// # Errors
    /// Returns [`ConnectError`] if there is no connection. On a host without a real-time kernel,
    /// this is [`ConnectError::Realtime`]: see [`Builder::realtime`].
    ///
    /// # Cancel safety
    /// Dropping the future closes everything that was opened.
    pub async fn connect(endpoint: impl Into<Endpoint>) -> Result<Self, ConnectError> {
        Self::builder(endpoint).connect().await
    }
}

impl Builder {
    /// Connects to the robot: real-time check, TCP, handshake, first state, and description. Call
    /// it on a Tokio runtime with I/O and time enabled, which then runs the two tasks of the
    /// connection, and a third one for supervision.
    ///
    /// # Errors
    /// Returns [`ConnectError`] if there is no connection. A failed step is not repeated, even with
    /// supervision.
    ///
    /// # Cancel safety
    /// Dropping the future closes everything that was opened.
    pub async fn connect(self) -> Result<Robot, ConnectError> {
        let span = tracing::info_span!("connect", endpoint = %self.endpoint);
        async {
            let connected = connect(self).await;
            match &connected {
                Ok(robot) => tracing::info!(
                    address = %robot.address(),
                    version = robot.version().number(),
                    "connected"
                ),
                Err(error) => tracing::warn!(%error, "not connected"),
            }
            connected
        }
        .instrument(span)
        .await
    }
}

async fn connect(mut builder: Builder) -> Result<Robot, ConnectError> {
    LinkTimeout::new(builder.link_timeout)?;
    if builder.log_size > ControlLog::CAPACITY_MAX {
        let got = builder.log_size;
        return Err(ConnectError::LogSize { got });
    }
    if builder.ask.is_some() && builder.policy.is_none() {
        return Err(ConnectError::Unsupervised);
    }
    if let Some(policy) = builder.policy.take() {
        let policy = policy.or_seed(RandomState::new().hash_one(()));
        let asks = builder.ask.is_some();
        builder.policy = Some(if asks { policy.ask_first() } else { policy });
    }
    let supervisor = Arc::new(Supervisor::new(builder.policy));
    let states = Arc::new(watch::Sender::new(RobotState::default()));
    let Opened {
        model,
        version,
        link,
        first,
        bridge,
    } = open(&builder, &states, &supervisor).await?;
    states.send_replace(first);
    let link = Arc::new(link);
    supervisor.on_connected(&link, &first, &link.granted.refusals);
    let span = tracing::info_span!(
        parent: None,
        "robot",
        address = %link.address,
        version = version.number()
    );
    let reconnector = supervisor.is_supervised().then(mpsc::unbounded_channel);
    let (shutdowns, requests) = reconnector.unzip();
    let alive = CancellationToken::new();
    let handles = alive.clone().drop_guard();
    let robot = Robot::new((model, version), link, supervisor, (shutdowns, handles));
    let cancellation = builder.cancellation.clone();
    span.in_scope(|| bridge.start(cancellation));
    if let Some(requests) = requests {
        let reconnector = Reconnector::new(&robot, builder, states);
        world::spawn(reconnector.run(requests, alive).instrument(span));
    }
    Ok(robot)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicUsize;
    use std::sync::atomic::Ordering::Relaxed;

    use franka_rt::sched::Realtime;
    use tokio::net::TcpListener;

    use super::*;

    #[test]
    fn real_time_rights_are_tried_out_on_a_thread_that_may_block() {
        let started = Arc::new(AtomicUsize::new(0));
        let counted = started.clone();
        // This runtime starts threads only for blocking work.
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .on_thread_start(move || _ = counted.fetch_add(1, Relaxed))
            .build()
            .expect("a runtime");
        runtime.block_on(async {
            let listener = TcpListener::bind("127.0.0.1:0").await.expect("a free port");
            let address = listener.local_addr().expect("bound");
            drop(listener);
            let builder = Robot::builder(address).realtime(Realtime::Ignore);
            let error = builder.connect().await.expect_err("nothing listens");
            assert!(matches!(error, ConnectError::Refused { .. }), "{error}");
        });
        assert_eq!(started.load(Relaxed), 1);
    }
}

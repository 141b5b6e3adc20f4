//! From an address to a running connection. If the robot refuses the version, the older one that it
//! names is tried.

use std::net::SocketAddr;
use std::sync::Arc;

use franka_proto::client::Session;
use franka_proto::{RobotState, Version};
use franka_rt::driver::{ControlLog, Driver, LinkTimeout, ReferenceReader};
use franka_rt::event_fd::EventFd;
use franka_rt::exchange;
use franka_rt::lifecycle::Lifecycle;
use franka_rt::thread::{self, Handle, Notice, ThreadConfig};
use tokio::io::unix::AsyncFd;
use tokio::net::TcpStream;
use tokio::sync::watch;
use tokio::time::timeout;
use tokio_util::codec::Framed;

use crate::bridge::{self, Bridge};
use crate::builder::{Builder, VersionPolicy};
use crate::codec::MessageCodec;
use crate::command_channel::Channel;
use crate::connected_model;
use crate::dial::{dial, dial_one, resolve};
use crate::endpoint::Endpoint;
use crate::error::ConnectError;
use crate::handshake::shake_hands;
use crate::link::Link;
use crate::newest_state::Newest;
use crate::progress::Course;
use crate::robot::Robot;
use crate::thresholds::Thresholds;

impl Robot {
    /// Connects with the options that [`Robot::builder`] begins with.
    ///
    /// # Errors
    /// [`ConnectError`]. Without a real-time kernel this is [`ConnectError::Realtime`]: see
    /// [`Builder::realtime`].
    ///
    /// # Cancel safety
    /// Dropping the future closes whatever was opened.
    pub async fn connect(endpoint: impl Into<Endpoint>) -> Result<Self, ConnectError> {
        Self::builder(endpoint).connect().await
    }
}

impl Builder {
    /// Connects: real-time check, TCP, handshake, first state, description. Must be called on a
    /// Tokio runtime with I/O and time enabled, which then runs the two tasks of the connection.
    ///
    /// # Errors
    /// [`ConnectError`]; nothing is left behind.
    ///
    /// # Cancel safety
    /// Dropping the future closes whatever was opened.
    pub async fn connect(self) -> Result<Robot, ConnectError> {
        connect(self).await
    }
}

async fn connect(builder: Builder) -> Result<Robot, ConnectError> {
    LinkTimeout::new(builder.link_timeout)?;
    if builder.log_size > ControlLog::CAPACITY_MAX {
        let got = builder.log_size;
        return Err(ConnectError::LogSize { got });
    }
    // Refused before anything is sent, as the reference client does; the thread asks again for
    // itself.
    let scheduling = builder.scheduling.clone();
    off_worker(move || scheduling.probe()).await??;

    let limit = builder.connect_timeout;
    let addresses = timeout(limit, resolve(&builder.endpoint, Version::TCP_PORT))
        .await
        .unwrap_or(Err(ConnectError::Timeout))?;
    let (tcp, address) = dial(&addresses, limit).await?;
    let opened = open(tcp, address, &builder).await?;
    let states = Arc::new(watch::Sender::new(opened.first));
    let (reader, state_wakeups) = (&opened.handle.states, &opened.handle.state_wakeups);
    let newest = Newest::new(reader.clone(), &states, state_wakeups.clone());
    let (channel, connection, reports) =
        Channel::start(opened.stream, opened.session, newest.clone());
    let course = Course::new(opened.references);
    let thresholds = Thresholds::default();
    let stats = opened.handle.stats.clone();
    let granted = Arc::new(opened.handle.granted.clone());
    let lender = opened.handle.lender.clone();
    let model = Arc::new(connected_model::of(opened.version, &channel, &builder).await?);
    let mut lifecycle =
        Lifecycle::new(model.clone(), opened.version).with_log_size(builder.log_size);
    if let Some(known) = builder.known {
        known.check(model.kind())?;
        lifecycle = lifecycle.knowing(*known);
    }
    let bridge = Bridge::new(
        lifecycle,
        opened.handle,
        opened.wake,
        (channel.clone(), connection),
        states,
        (course.clone(), thresholds.clone()),
    );
    let bridge = bridge.start(reports, builder.cancellation);
    let link = Link {
        address,
        bridge,
        channel,
        newest,
        course,
        thresholds,
        stats,
        granted,
        lender,
    };
    Ok(Robot::new(model, opened.version, link))
}

struct Opened {
    version: Version,
    stream: Framed<TcpStream, MessageCodec>,
    session: Session,
    handle: Handle,
    references: ReferenceReader,
    wake: AsyncFd<EventFd>,
    first: RobotState,
}

/// Opens a session on a new connection to `address`, with the version that the policy allows and
/// the robot accepts.
async fn open(
    tcp: TcpStream,
    address: SocketAddr,
    builder: &Builder,
) -> Result<Opened, ConnectError> {
    let announced = match builder.versions {
        VersionPolicy::Exact(version) => version,
        VersionPolicy::Negotiate => Version::V10,
    };
    match open_with(announced, tcp, address, builder).await {
        Err(ConnectError::IncompatibleVersion(refusal))
            if builder.versions == VersionPolicy::Negotiate =>
        {
            match Version::from_number(refusal.server_version) {
                Some(older) if older != announced => {
                    let tcp = dial_one(address, builder.connect_timeout).await?;
                    open_with(older, tcp, address, builder).await
                }
                _ => Err(refusal.into()),
            }
        }
        opened => opened,
    }
}

async fn open_with(
    version: Version,
    tcp: TcpStream,
    address: SocketAddr,
    builder: &Builder,
) -> Result<Opened, ConnectError> {
    let udp = exchange::bind(address.ip())?;
    let port = udp.local_addr()?.port();
    let mut stream = Framed::new(tcp, MessageCodec::ROBOT);
    let mut session = Session::new(version);
    timeout(
        builder.connect_timeout,
        shake_hands(&mut stream, &mut session, port),
    )
    .await
    .unwrap_or(Err(ConnectError::HandshakeTimeout))?;

    let config = ThreadConfig {
        scheduling: builder.scheduling.clone(),
        ..ThreadConfig::default()
    };
    let link_timeout = LinkTimeout::new(builder.link_timeout)?;
    let driver = Driver::new(version).with_link_timeout(link_timeout);
    let references = driver.references();
    let start = move || thread::spawn(config, driver, udp, address.ip(), version);
    let mut handle = off_worker(start).await??;
    let wake = bridge::attach(handle.event_fd.clone())?;
    let first = timeout(builder.connect_timeout, first_state(&mut handle, &wake))
        .await
        .map_err(|_| ConnectError::NoState)??;
    Ok(Opened {
        version,
        stream,
        session,
        handle,
        references,
        wake,
        first,
    })
}

/// Runs what blocks for milliseconds (threads that are started and joined, memory that is locked
/// and touched) where no other task waits for it. Dropping the future drops the result.
async fn off_worker<T: Send + 'static>(
    blocking: impl FnOnce() -> T + Send + 'static,
) -> std::io::Result<T> {
    let done = tokio::task::spawn_blocking(blocking).await;
    done.map_err(std::io::Error::other)
}

/// Waits for the first state: without one there is nothing to control.
async fn first_state(
    handle: &mut Handle,
    wake: &AsyncFd<EventFd>,
) -> Result<RobotState, ConnectError> {
    loop {
        bridge::woken(wake).await?;
        if let Some(state) = handle.states.newest() {
            return Ok(state);
        }
        while let Some(notice) = handle.notices.pop() {
            if let Notice::Link(fault) = notice {
                return Err(fault.into());
            }
        }
    }
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
        // Such a runtime starts a thread for what blocks, and for nothing else.
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
            assert!(matches!(error, ConnectError::Refused), "{error}");
        });
        assert_eq!(started.load(Relaxed), 1);
    }
}

//! From an address to a running connection.

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::time::Duration;

use franka_proto::client::{Event, Session};
use franka_proto::{Protocol, RobotState, Version};
use franka_rt::driver::Driver;
use franka_rt::exchange;
use franka_rt::lifecycle::Lifecycle;
use franka_rt::thread::{self, Handle, Notice, ThreadConfig};
use franka_rt::wake::Wake;
use futures::{SinkExt, StreamExt};
use socket2::{SockRef, TcpKeepalive};
use tokio::io::unix::AsyncFd;
use tokio::net::TcpStream;
use tokio::sync::watch;
use tokio::time::timeout;
use tokio_util::codec::Framed;

use crate::bridge::{self, Bridge};
use crate::builder::{Builder, Endpoint, VersionPolicy};
use crate::channel::{CLOSED_BY_PEER, Channel};
use crate::codec::{MessageCodec, StreamError, reason};
use crate::model;
use crate::robot::Shared;
use crate::{ConnectError, Robot};

/// Time for the TCP connection. Source: libfranka 0.21, `network.h`.
pub(crate) const TCP_TIMEOUT: Duration = Duration::from_secs(1);

/// Keepalive of the command connection: idle time, interval, count. Source: libfranka 0.21, `network.cpp`.
const KEEPALIVE: (Duration, Duration, u32) = (Duration::from_secs(1), Duration::from_secs(1), 3);

pub(crate) async fn connect(builder: Builder) -> Result<Robot, ConnectError> {
    // Refused before anything is sent, as the reference client does; the thread asks again for itself.
    let scheduling = builder.scheduling.clone();
    scheduling.probe()?;

    let address = timeout(
        builder.connect_timeout,
        resolve(&builder.endpoint, Version::TCP_PORT),
    )
    .await
    .unwrap_or(Err(ConnectError::Timeout))?;
    let opened = open(address, &builder).await?;
    let (states, published) = watch::channel(opened.first);
    let (channel, connection, reports) =
        Channel::start(opened.stream, opened.session, published.clone());
    let stats = opened.handle.stats.clone();
    let lender = opened.handle.lender.clone();
    let model = Arc::new(model::of(opened.version, &channel, &builder).await?);
    let lifecycle = Lifecycle::new(model.clone(), opened.version).with_log_size(builder.log_size);
    let bridge = Bridge::new(
        lifecycle,
        opened.handle,
        opened.bell,
        (channel.clone(), connection),
        states,
    );
    let inputs = bridge.start(reports, builder.cancellation);
    Ok(Robot::new(Shared {
        model,
        version: opened.version,
        address,
        inputs,
        channel,
        states: published,
        stats,
        lender,
        goals: AtomicU64::new(0),
    }))
}

struct Opened {
    version: Version,
    stream: Framed<TcpStream, MessageCodec>,
    session: Session,
    handle: Handle,
    bell: AsyncFd<Wake>,
    first: RobotState,
}

/// Opens a session, with the version that the policy allows and the robot accepts.
async fn open(address: SocketAddr, builder: &Builder) -> Result<Opened, ConnectError> {
    let announced = match builder.versions {
        VersionPolicy::Exact(version) => version,
        VersionPolicy::Negotiate => Version::V10,
    };
    match open_with(announced, address, builder).await {
        Err(ConnectError::IncompatibleVersion(refusal))
            if builder.versions == VersionPolicy::Negotiate =>
        {
            match Version::from_number(refusal.server_version) {
                Some(older) if older != announced => open_with(older, address, builder).await,
                _ => Err(refusal.into()),
            }
        }
        opened => opened,
    }
}

async fn open_with(
    version: Version,
    address: SocketAddr,
    builder: &Builder,
) -> Result<Opened, ConnectError> {
    let tcp = dial::<Version>(address, builder.connect_timeout).await?;
    let udp = exchange::bind()?;
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
    let driver = Driver::new(version).with_link_timeout(builder.link_timeout);
    let mut handle = thread::spawn(config, driver, udp, address.ip(), version)?;
    let bell = bridge::attach(handle.wake.clone())?;
    let first = timeout(builder.connect_timeout, first_state(&mut handle, &bell))
        .await
        .map_err(|_| ConnectError::NoState)??;
    Ok(Opened {
        version,
        stream,
        session,
        handle,
        bell,
        first,
    })
}

/// Finds the host; `port` is that of the device, for an endpoint without one.
pub(crate) async fn resolve<P: Protocol>(
    endpoint: &Endpoint,
    port: u16,
) -> Result<SocketAddr, ConnectError<P>> {
    let port = endpoint.port.unwrap_or(port);
    let network = |reason: &str| ConnectError::Network {
        reason: reason.into(),
    };
    let mut found = tokio::net::lookup_host((endpoint.host.as_str(), port))
        .await
        .map_err(|_| network("Host not found"))?;
    // The robot's datagrams are IPv4.
    found
        .find(SocketAddr::is_ipv4)
        .ok_or_else(|| network("No address found"))
}

pub(crate) async fn dial<P: Protocol>(
    address: SocketAddr,
    limit: Duration,
) -> Result<TcpStream, ConnectError<P>> {
    let stream = match timeout(limit, TcpStream::connect(address)).await {
        Ok(Ok(stream)) => stream,
        Ok(Err(error)) => {
            return Err(match error.kind() {
                std::io::ErrorKind::ConnectionRefused => ConnectError::Refused,
                std::io::ErrorKind::TimedOut => ConnectError::Timeout,
                _ => ConnectError::Network {
                    reason: reason(&error),
                },
            });
        }
        Err(_) => return Err(ConnectError::Timeout),
    };
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "small requests may be delayed");
    }
    let (idle, interval, count) = KEEPALIVE;
    let keepalive = TcpKeepalive::new()
        .with_time(idle)
        .with_interval(interval)
        .with_retries(count);
    if let Err(error) = SockRef::from(&stream).set_tcp_keepalive(&keepalive) {
        tracing::debug!(%error, "no keepalive on the command connection");
    }
    Ok(stream)
}

pub(crate) async fn shake_hands<P: Protocol>(
    stream: &mut Framed<TcpStream, MessageCodec>,
    session: &mut Session<P>,
    udp_port: u16,
) -> Result<(), ConnectError<P>> {
    stream
        .send(session.connect(udp_port))
        .await
        .map_err(broken)?;
    loop {
        let frame = match stream.next().await {
            Some(frame) => frame.map_err(broken)?,
            None => {
                return Err(ConnectError::Link {
                    reason: CLOSED_BY_PEER.into(),
                });
            }
        };
        match session.on_message(frame.message())? {
            Event::Connected { .. } => return Ok(()),
            Event::Incompatible(refusal) => return Err(refusal.into()),
            // Not for us; the answer may still come, until the time is up.
            _ => {}
        }
    }
}

fn broken<P: Protocol>(error: StreamError) -> ConnectError<P> {
    match error {
        StreamError::Frame(error) => error.into(),
        StreamError::Io(_) => ConnectError::Link {
            reason: error.to_string(),
        },
    }
}

/// Waits for the first state: without one there is nothing to control.
async fn first_state(
    handle: &mut Handle,
    bell: &AsyncFd<Wake>,
) -> Result<RobotState, ConnectError> {
    loop {
        bridge::hear(bell).await?;
        if let Some(state) = handle.states.newest() {
            return Ok(state);
        }
        while let Ok(notice) = handle.notices.pop() {
            if let Notice::Link(fault) = notice {
                return Err(fault.into());
            }
        }
    }
}

//! From an address to a running connection.

use std::net::{IpAddr, SocketAddr, SocketAddrV6};
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::time::Duration;

use franka_proto::client::{Event, Session};
use franka_proto::{Protocol, RobotState, Version};
use franka_rt::driver::{Driver, LinkTimeout};
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
use crate::builder::{Builder, VersionPolicy};
use crate::channel::{CLOSED_BY_PEER, Channel};
use crate::codec::{MessageCodec, StreamError, reason};
use crate::endpoint::{Endpoint, EndpointError, Host};
use crate::error::Attempt;
use crate::model;
use crate::newest::Newest;
use crate::robot::Shared;
use crate::{ConnectError, Robot};

/// Time for the TCP connection. Source: libfranka 0.21, `network.h`.
pub(crate) const TCP_TIMEOUT: Duration = Duration::from_secs(1);

/// Keepalive of the command connection: idle time, interval, count. Source: libfranka 0.21,
/// `network.cpp`.
const KEEPALIVE: (Duration, Duration, u32) = (Duration::from_secs(1), Duration::from_secs(1), 3);

pub(crate) async fn connect(builder: Builder) -> Result<Robot, ConnectError> {
    LinkTimeout::new(builder.link_timeout)?;
    // Refused before anything is sent, as the reference client does; the thread asks again for
    // itself.
    let scheduling = builder.scheduling.clone();
    scheduling.probe()?;

    let limit = builder.connect_timeout;
    let addresses = timeout(limit, resolve(&builder.endpoint, Version::TCP_PORT))
        .await
        .unwrap_or(Err(ConnectError::Timeout))?;
    let (tcp, address) = dial(&addresses, limit).await?;
    let opened = open(tcp, address, &builder).await?;
    let states = Arc::new(watch::Sender::new(opened.first));
    let (reader, audience) = (&opened.handle.states, &opened.handle.audience);
    let newest = Newest::new(reader.clone(), &states, audience.clone());
    let (channel, connection, reports) =
        Channel::start(opened.stream, opened.session, newest.clone());
    let stats = opened.handle.stats.clone();
    let granted = opened.handle.granted.clone();
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
        newest,
        stats,
        granted,
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

/// Finds the addresses of the host, each once, in the order in which to try them; `port` is that of
/// the device, for an endpoint without one.
pub(crate) async fn resolve<P: Protocol>(
    endpoint: &Endpoint,
    port: u16,
) -> Result<Vec<SocketAddr>, ConnectError<P>> {
    let port = endpoint.port().unwrap_or(port);
    let (name, interface) = match endpoint.host()? {
        Host::Address(IpAddr::V6(address), scope) => {
            return Ok(vec![SocketAddrV6::new(*address, port, 0, *scope).into()]);
        }
        Host::Address(address, _) => return Ok(vec![SocketAddr::new(*address, port)]),
        // The system knows its interfaces, and how such addresses are written.
        Host::Scoped(address, interface) => (format!("{address}%{interface}"), Some(interface)),
        Host::Name(name) => (name.clone(), None),
    };
    let Ok(found) = tokio::net::lookup_host((name, port)).await else {
        return Err(match interface.cloned() {
            Some(interface) => EndpointError::Interface { interface }.into(),
            None => network("Host not found"),
        });
    };
    let mut addresses: Vec<SocketAddr> = Vec::new();
    for address in found {
        if !addresses.contains(&address) {
            addresses.push(address);
        }
    }
    // The reference client knows nothing but IPv4: this is how a robot is reached, and an IPv6
    // address a special case.
    addresses.sort_by_key(SocketAddr::is_ipv6);
    if addresses.is_empty() {
        return Err(network("No address found"));
    }
    Ok(addresses)
}

fn network<P: Protocol>(reason: &str) -> ConnectError<P> {
    ConnectError::Network {
        reason: reason.into(),
    }
}

/// Connects to the first of `addresses` that takes a connection, and says which it is. `limit`
/// holds for each.
pub(crate) async fn dial<P: Protocol>(
    addresses: &[SocketAddr],
    limit: Duration,
) -> Result<(TcpStream, SocketAddr), ConnectError<P>> {
    let mut attempts = Vec::new();
    for &address in addresses {
        match dial_one(address, limit).await {
            Ok(stream) => return Ok((stream, address)),
            Err(error) => {
                if addresses.len() > 1 {
                    tracing::debug!(%address, %error, "no connection");
                }
                attempts.push(Attempt { address, error });
            }
        }
    }
    Err(match attempts.pop() {
        Some(only) if attempts.is_empty() => only.error,
        Some(last) => {
            attempts.push(last);
            ConnectError::NoAddress { attempts }
        }
        None => network("No address found"),
    })
}

async fn dial_one<P: Protocol>(
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

#[cfg(test)]
mod tests {
    use tokio::net::TcpListener;

    use super::*;
    use crate::error::Party;

    const LIMIT: Duration = Duration::from_secs(5);

    /// An address of this host that nobody listens on.
    async fn silent(ip: &str) -> SocketAddr {
        let ip: IpAddr = ip.parse().expect("an address");
        let listener = TcpListener::bind((ip, 0)).await.expect("a free port");
        listener.local_addr().expect("bound")
    }

    #[tokio::test]
    async fn the_addresses_of_a_host_are_tried_in_turn() {
        let listener = TcpListener::bind("[::1]:0").await.expect("a free port");
        let there = listener.local_addr().expect("bound");
        let gone = silent("127.0.0.1").await;
        let (stream, address) = dial::<Version>(&[gone, there], LIMIT)
            .await
            .expect("one listens");
        assert_eq!(
            (address, stream.peer_addr().expect("connected")),
            (there, there)
        );
    }

    #[tokio::test]
    async fn the_error_names_every_address_that_failed() {
        let gone = [silent("127.0.0.1").await, silent("::1").await];
        let error = dial::<Version>(&gone, LIMIT)
            .await
            .expect_err("nobody listens");
        let ConnectError::NoAddress { attempts } = &error else {
            panic!("{error}")
        };
        let tried: Vec<SocketAddr> = attempts.iter().map(|attempt| attempt.address).collect();
        assert_eq!(tried, gone);
        let text = error.to_string();
        for address in gone {
            let says = format!("{address}: libfranka: Connection to FCI refused.");
            assert!(text.contains(&says), "{text}");
        }
        assert_eq!(error.party(), Party::Robot);
        let error = dial::<Version>(&gone[..1], LIMIT)
            .await
            .expect_err("nobody listens");
        assert!(
            matches!(error, ConnectError::Refused),
            "one address alone: {error}"
        );
    }

    #[tokio::test]
    async fn texts_and_addresses_become_socket_addresses() {
        let found = async |endpoint: &str| {
            let addresses = resolve::<Version>(&endpoint.into(), 1337).await;
            addresses.map(|found| found.iter().map(ToString::to_string).collect::<Vec<_>>())
        };
        for (endpoint, address) in [
            ("172.16.0.2", "172.16.0.2:1337"),
            ("[fd00::2]:99", "[fd00::2]:99"),
            ("fe80::2%1", "[fe80::2%1]:1337"),
            // Every Linux has the interface, with the index 1.
            ("fe80::2%lo", "[fe80::2%1]:1337"),
        ] {
            assert_eq!(found(endpoint).await.expect("an address"), [address]);
        }
        let named = found("localhost:99")
            .await
            .expect("every host has that name");
        assert_eq!(named[0], "127.0.0.1:99", "IPv4 comes first");
        let error = found("fe80::2%nowhere0")
            .await
            .expect_err("no such interface");
        assert_eq!(
            error.to_string(),
            "there is no network interface `nowhere0`"
        );
        let error = found("robot:none").await.expect_err("no port");
        assert!(matches!(error, ConnectError::Endpoint(_)), "{error}");
        assert_eq!(error.party(), Party::Caller);
    }
}

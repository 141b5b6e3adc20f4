//! Connects to an endpoint by TCP.

use std::net::{IpAddr, SocketAddr, SocketAddrV6};
use std::time::Duration;

use franka_proto::Protocol;

use crate::codec::reason;
use crate::endpoint::{Endpoint, EndpointError, Host};
use crate::error::{Attempt, ConnectError};
use crate::world::{self, Stream, timeout};

/// Time limit for the TCP connection. Source: libfranka 0.21, `network.h`.
pub(crate) const TCP_TIMEOUT: Duration = Duration::from_secs(1);

/// Looks up the addresses of the host within `limit`. Returns each address once, in the order in
/// which to try them. `port` is used if the endpoint has none.
pub(crate) async fn resolve<P: Protocol>(
    endpoint: &Endpoint,
    port: u16,
    limit: Duration,
) -> Result<Vec<SocketAddr>, ConnectError<P>> {
    let port = endpoint.port().unwrap_or(port);
    let (name, interface) = match endpoint.host()? {
        Host::Address(IpAddr::V6(address), scope) => {
            return Ok(vec![SocketAddrV6::new(*address, port, 0, *scope).into()]);
        }
        Host::Address(address, _) => return Ok(vec![SocketAddr::new(*address, port)]),
        // The system knows its interfaces, and how to write such addresses.
        Host::Scoped(address, interface) => (format!("{address}%{interface}"), Some(interface)),
        Host::Name(name) => (name.clone(), None),
    };
    let look_up = world::look_up(&name, port);
    let Ok(Ok(found)) = timeout(limit, look_up).await else {
        return Err(match interface.cloned() {
            Some(interface) => EndpointError::Interface { interface }.into(),
            None => network(format!("Host not found ({name})")),
        });
    };
    let mut addresses: Vec<SocketAddr> = Vec::new();
    for address in found {
        if !addresses.contains(&address) {
            addresses.push(address);
        }
    }
    // libfranka supports only IPv4. Therefore robots are reached by IPv4, and an IPv6 address is a
    // special case.
    addresses.sort_by_key(SocketAddr::is_ipv6);
    if addresses.is_empty() {
        return Err(network("No address found"));
    }
    Ok(addresses)
}

fn network<P: Protocol>(reason: impl Into<String>) -> ConnectError<P> {
    ConnectError::Network {
        reason: reason.into(),
    }
}

/// Connects to the first of `addresses` that accepts a connection, and returns that address. Each
/// attempt may take `limit`.
pub(crate) async fn dial<P: Protocol>(
    addresses: &[SocketAddr],
    limit: Duration,
) -> Result<(Stream, SocketAddr), ConnectError<P>> {
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

pub(crate) async fn dial_one<P: Protocol>(
    address: SocketAddr,
    limit: Duration,
) -> Result<Stream, ConnectError<P>> {
    match timeout(limit, world::connect(address)).await {
        Ok(Ok(stream)) => Ok(stream),
        Ok(Err(error)) => Err(match error.kind() {
            std::io::ErrorKind::ConnectionRefused => ConnectError::Refused { address },
            std::io::ErrorKind::TimedOut => ConnectError::Timeout { address },
            _ => ConnectError::Network {
                reason: reason(&error),
            },
        }),
        Err(_) => Err(ConnectError::Timeout { address }),
    }
}

#[cfg(test)]
mod tests {
    use franka_proto::Version;
    use tokio::net::TcpListener;

    use super::*;
    use crate::error::Party;

    const LIMIT: Duration = Duration::from_secs(5);

    /// An address of this host where nothing listens.
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
        let (_stream, address) = dial::<Version>(&[gone, there], LIMIT)
            .await
            .expect("one listens");
        assert_eq!(address, there);
        listener.accept().await.expect("connected");
    }

    #[tokio::test]
    async fn the_error_names_every_address_that_failed() {
        let gone = [silent("127.0.0.1").await, silent("::1").await];
        let error = dial::<Version>(&gone, LIMIT)
            .await
            .expect_err("nothing listens");
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
            .expect_err("nothing listens");
        assert!(
            matches!(error, ConnectError::Refused { .. }),
            "one address alone: {error}"
        );
    }

    #[tokio::test]
    async fn texts_and_addresses_become_socket_addresses() {
        let found = async |endpoint: &str| {
            let addresses = resolve::<Version>(&endpoint.into(), 1337, LIMIT).await;
            addresses.map(|found| found.iter().map(ToString::to_string).collect::<Vec<_>>())
        };
        for (endpoint, address) in [
            ("172.16.0.2", "172.16.0.2:1337"),
            ("[fd00::2]:99", "[fd00::2]:99"),
            ("fe80::2%1", "[fe80::2%1]:1337"),
            // Every Linux system has this interface, with the index 1.
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

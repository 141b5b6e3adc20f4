//! Endpoints of devices: texts, addresses, and the errors in them.

use std::fmt;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr};
use std::str::FromStr;

/// Endpoint of a device: a host and a port. The default port depends on the device: 1337 for a
/// robot, 1338 for a Franka Hand. For a vacuum gripper, it is 1339.
///
/// It is made from an [`IpAddr`], from a [`SocketAddr`], or from text:
///
/// | text | means |
/// |---|---|
/// | `172.16.0.2`, `172.16.0.2:40123` | an IPv4 address, which robots use |
/// | `fd00::2`, `[fd00::2]`, `[fd00::2]:40123` | an IPv6 address; with a port, it needs brackets |
/// | `fe80::2%eth0`, `[fe80::2%3]:40123` | a link-local address with its interface, by name or index |
/// | `robot.lan`, `robot.lan:40123` | a host name; its addresses are tried in turn, IPv4 before IPv6 |
///
/// Any other text can also be converted, but connecting then refuses it as
/// [`ConnectError::Endpoint`](crate::error::ConnectError::Endpoint) before anything is sent. To
/// check a text at once, use `parse`.
///
/// ```
/// use franka_async::connection::Endpoint;
/// use franka_async::error::EndpointError;
///
/// let endpoint: Endpoint = "[fe80::2%eth0]:40123".parse()?;
/// let refused: Result<Endpoint, _> = "robot.lan:http".parse();
/// assert_eq!(refused, Err(EndpointError::Port { port: "http".into() }));
/// # Ok::<_, EndpointError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Endpoint {
    host: Result<Host, EndpointError>,
    port: Option<u16>,
}

/// Host to connect to, before any name is looked up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Host {
    /// An address, with the index of its interface, or 0.
    Address(IpAddr, u32),
    /// An address with the name of its interface.
    Scoped(Ipv6Addr, String),
    Name(String),
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let host = match &self.host {
            Ok(Host::Address(IpAddr::V6(address), 0)) => format!("[{address}]"),
            Ok(Host::Address(IpAddr::V6(address), scope)) => format!("[{address}%{scope}]"),
            Ok(Host::Address(address, _)) => address.to_string(),
            Ok(Host::Scoped(address, interface)) => format!("[{address}%{interface}]"),
            Ok(Host::Name(name)) => name.clone(),
            Err(error) => return error.fmt(f),
        };
        match self.port {
            Some(port) => write!(f, "{host}:{port}"),
            None => f.write_str(&host),
        }
    }
}

/// Error of the caller: a text is not an endpoint.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EndpointError {
    /// The text contains no host: it is empty, or begins with the port.
    #[error("`{text}` has no host: expected a host name or an IP address")]
    NoHost {
        /// The whole text.
        text: String,
    },
    /// The text after the colon is not a port.
    #[error("`{port}` is not a port: expected a number from 1 to 65535")]
    Port {
        /// Text in the place of the port.
        port: String,
    },
    /// The text looks like an address, but is not a valid one.
    #[error(
        "`{address}` is not an IP address: expected one like 172.16.0.2, fd00::2 or fe80::2%eth0; an IPv6 address with a \
         port needs brackets: [fd00::2]:1337"
    )]
    Address {
        /// Text in the place of the address.
        address: String,
    },
    /// A `[` is not closed, or text other than `:port` follows the `]`.
    #[error("`{text}` is incomplete: expected [address] or [address]:port")]
    Brackets {
        /// The whole text.
        text: String,
    },
    /// The text is not a possible host name.
    #[error(
        "`{name}` is not a host name: expected letters, digits, hyphens and dots, without a scheme, a path or blanks"
    )]
    Name {
        /// Text in the place of the name.
        name: String,
    },
    /// The address belongs to a network interface that this host does not have.
    #[error("there is no network interface `{interface}`")]
    Interface {
        /// Text after the percent sign.
        interface: String,
    },
}

impl Endpoint {
    /// Returns the same host with a different port, for example for an end effector of a robot.
    #[must_use]
    pub fn at_port(mut self, port: u16) -> Self {
        self.set_port(port);
        self
    }

    /// Returns the host, or the error in the text that the endpoint was made from.
    pub(crate) fn host(&self) -> Result<&Host, EndpointError> {
        self.host.as_ref().map_err(Clone::clone)
    }

    /// Returns the port, if the endpoint names one.
    pub fn port(&self) -> Option<u16> {
        self.port
    }

    pub(crate) fn set_port(&mut self, port: u16) {
        self.port = Some(port);
    }
}

impl EndpointError {
    /// Returns the name of this error's row in the book's `errors.md`.
    pub fn entry(&self) -> &'static str {
        match self {
            Self::NoHost { .. } => "endpoint-no-host",
            Self::Port { .. } => "endpoint-port",
            Self::Address { .. } => "endpoint-address",
            Self::Brackets { .. } => "endpoint-brackets",
            Self::Name { .. } => "endpoint-name",
            Self::Interface { .. } => "endpoint-interface",
        }
    }
}

impl FromStr for Endpoint {
    type Err = EndpointError;

    fn from_str(text: &str) -> Result<Self, EndpointError> {
        if text.contains("://") {
            return Err(EndpointError::Name { name: text.into() });
        }
        let (host, port) = if let Some(rest) = text.strip_prefix('[') {
            let brackets = || EndpointError::Brackets { text: text.into() };
            let (inside, after) = rest.split_once(']').ok_or_else(brackets)?;
            let port = match after {
                "" => None,
                after => Some(after.strip_prefix(':').ok_or_else(brackets)?),
            };
            (parse_v6(inside)?, port)
        } else {
            match text.split_once(':') {
                None => (parse_host(text, text)?, None),
                Some((_, rest)) if rest.contains(':') => (parse_v6(text)?, None),
                Some((host, port)) => (parse_host(host, text)?, Some(port)),
            }
        };
        Ok(Self {
            host: Ok(host),
            port: port.map(parse_port).transpose()?,
        })
    }
}

fn parse_port(text: &str) -> Result<u16, EndpointError> {
    match text.parse() {
        Ok(port) if port > 0 => Ok(port),
        _ => Err(EndpointError::Port { port: text.into() }),
    }
}

/// Parses a host name or an IPv4 address; `text` is the whole text.
fn parse_host(host: &str, text: &str) -> Result<Host, EndpointError> {
    if host.is_empty() {
        return Err(EndpointError::NoHost { text: text.into() });
    }
    if let Ok(address) = host.parse::<Ipv4Addr>() {
        return Ok(Host::Address(address.into(), 0));
    }
    // The system would read the mistyped address `172.16.2` as 172.16.0.2.
    if host
        .bytes()
        .all(|byte| byte.is_ascii_digit() || byte == b'.')
    {
        let address = host.into();
        return Err(EndpointError::Address { address });
    }
    let name = host.strip_suffix('.').unwrap_or(host);
    let allowed = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
    let is_label =
        |label: &str| (1..=LABEL_MAX).contains(&label.len()) && label.bytes().all(allowed);
    if name.len() > NAME_MAX || !name.split('.').all(is_label) {
        return Err(EndpointError::Name { name: host.into() });
    }
    Ok(Host::Name(host.into()))
}

/// Parses an IPv6 address, with its interface if it has one.
fn parse_v6(text: &str) -> Result<Host, EndpointError> {
    let (address, interface) = match text.split_once('%') {
        Some((address, interface)) => (address, Some(interface)),
        None => (text, None),
    };
    let Ok(address) = address.parse::<Ipv6Addr>() else {
        let address = text.into();
        return Err(EndpointError::Address { address });
    };
    match interface {
        None => Ok(Host::Address(IpAddr::V6(address).to_canonical(), 0)),
        Some("") => Err(EndpointError::Interface {
            interface: String::new(),
        }),
        Some(interface) => Ok(match interface.parse() {
            Ok(index) => Host::Address(address.into(), index),
            Err(_) => Host::Scoped(address, interface.into()),
        }),
    }
}

/// Largest length of a label and of a name. Source: RFC 1035, section 2.3.4.
const LABEL_MAX: usize = 63;
const NAME_MAX: usize = 253;

impl From<&str> for Endpoint {
    fn from(text: &str) -> Self {
        text.parse().unwrap_or_else(|error| Self {
            host: Err(error),
            port: None,
        })
    }
}

impl From<String> for Endpoint {
    fn from(text: String) -> Self {
        text.as_str().into()
    }
}

impl From<&String> for Endpoint {
    fn from(text: &String) -> Self {
        text.as_str().into()
    }
}

impl From<IpAddr> for Endpoint {
    fn from(ip: IpAddr) -> Self {
        Self {
            host: Ok(Host::Address(ip.to_canonical(), 0)),
            port: None,
        }
    }
}

impl From<SocketAddr> for Endpoint {
    fn from(address: SocketAddr) -> Self {
        let scope = match address {
            SocketAddr::V4(_) => 0,
            SocketAddr::V6(address) => address.scope_id(),
        };
        Self {
            host: Ok(Host::Address(address.ip().to_canonical(), scope)),
            port: Some(address.port()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_becomes_host_and_port() {
        let v4 = || Host::Address(Ipv4Addr::new(172, 16, 0, 2).into(), 0);
        let v6 = |text: &str, scope| Host::Address(IpAddr::V6(text.parse().expect("one")), scope);
        let named = |name: &str| Host::Name(name.into());
        let link = || Host::Scoped("fe80::1".parse().expect("one"), "eth0".into());
        for (text, host, port) in [
            ("172.16.0.2", v4(), None),
            ("172.16.0.2:40123", v4(), Some(40123)),
            ("::ffff:172.16.0.2", v4(), None),
            ("[::ffff:172.16.0.2]:1", v4(), Some(1)),
            ("::1", v6("::1", 0), None),
            ("::1:1337", v6("::1:1337", 0), None),
            ("[::1]", v6("::1", 0), None),
            ("[::1]:1337", v6("::1", 0), Some(1337)),
            ("fe80::1%eth0", link(), None),
            ("[fe80::1%eth0]:65535", link(), Some(65535)),
            ("fe80::1%7", v6("fe80::1", 7), None),
            ("robot", named("robot"), None),
            ("my-robot.lan:40123", named("my-robot.lan"), Some(40123)),
            ("robot_1.lan.", named("robot_1.lan."), None),
            ("10.0.0.7.nip.io", named("10.0.0.7.nip.io"), None),
        ] {
            let expected = Endpoint {
                host: Ok(host),
                port,
            };
            assert_eq!(text.parse(), Ok(expected.clone()), "{text}");
            assert_eq!(Endpoint::from(text), expected, "{text}");
            assert_eq!(Endpoint::from(text.to_owned()), expected, "{text}");
        }
    }

    #[test]
    fn invalid_endpoint_is_refused_with_the_reason() {
        for (text, says) in [
            ("", "`` has no host: expected a host name or an IP address"),
            (
                ":1337",
                "`:1337` has no host: expected a host name or an IP address",
            ),
            (
                "robot.lan:",
                "`` is not a port: expected a number from 1 to 65535",
            ),
            (
                "robot.lan:http",
                "`http` is not a port: expected a number from 1 to 65535",
            ),
            (
                "10.0.0.7:0",
                "`0` is not a port: expected a number from 1 to 65535",
            ),
            (
                "[::1]:65536",
                "`65536` is not a port: expected a number from 1 to 65535",
            ),
            (
                "172.16.2",
                "`172.16.2` is not an IP address: expected one like",
            ),
            (
                "172.16.0.256",
                "`172.16.0.256` is not an IP address: expected one like",
            ),
            ("1337", "`1337` is not an IP address: expected one like"),
            (
                "fe80:::1",
                "`fe80:::1` is not an IP address: expected one like",
            ),
            (
                "http://robot.lan:80",
                "`http://robot.lan:80` is not a host name: expected letters",
            ),
            (
                "http://172.16.0.2/",
                "`http://172.16.0.2/` is not a host name: expected letters",
            ),
            ("[robot.lan]:1337", "`robot.lan` is not an IP address"),
            (
                "[::1",
                "`[::1` is incomplete: expected [address] or [address]:port",
            ),
            (
                "[::1]1337",
                "`[::1]1337` is incomplete: expected [address] or [address]:port",
            ),
            ("fe80::1%", "there is no network interface ``"),
            (
                "robot.lan/fci",
                "`robot.lan/fci` is not a host name: expected letters",
            ),
            (
                " 172.16.0.2",
                "` 172.16.0.2` is not a host name: expected letters",
            ),
            ("robot..lan", "`robot..lan` is not a host name"),
            ("r\u{f6}bot", "`r\u{f6}bot` is not a host name"),
            (&"r".repeat(64), "is not a host name"),
            (&"r.".repeat(128), "is not a host name"),
        ] {
            let error = text.parse::<Endpoint>().expect_err(text);
            assert!(error.to_string().contains(says), "{text}: {error}");
            assert_eq!(Endpoint::from(text).host(), Err(error));
        }
    }

    #[test]
    fn an_address_is_taken_as_it_is() {
        let address: SocketAddr = "10.0.0.7:99".parse().expect("an address");
        assert_eq!(Endpoint::from(address), Endpoint::from("10.0.0.7:99"));
        assert_eq!(Endpoint::from(address.ip()), Endpoint::from("10.0.0.7"));
        let scoped: SocketAddr = "[fe80::1%3]:99".parse().expect("an address");
        assert_eq!(Endpoint::from(scoped), Endpoint::from("[fe80::1%3]:99"));
    }
}

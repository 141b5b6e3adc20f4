//! How to connect to a robot.

use std::net::{IpAddr, SocketAddr};
use std::time::Duration;

use franka_proto::Version;
use franka_rt::driver::ControlLog;
use franka_rt::sched::{Realtime, Scheduling};
use tokio_util::sync::CancellationToken;

use crate::connect;
use crate::{ConnectError, Robot};

/// Where a device listens: a host, and a port that is the usual one of the device unless given: 1337 of a robot, 1338 of a
/// Franka Hand, 1339 of a vacuum gripper.
///
/// Made from `"172.16.0.2"`, `"robot.lan"`, `"127.0.0.1:40123"`, an [`IpAddr`] or a [`SocketAddr`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Endpoint {
    pub(crate) host: String,
    pub(crate) port: Option<u16>,
}

impl From<&str> for Endpoint {
    fn from(text: &str) -> Self {
        let parts = text
            .rsplit_once(':')
            .and_then(|(host, port)| Some((host, port.parse().ok()?)));
        match parts {
            Some((host, port)) if !host.contains(':') => Self {
                host: host.to_owned(),
                port: Some(port),
            },
            _ => Self {
                host: text.to_owned(),
                port: None,
            },
        }
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
            host: ip.to_string(),
            port: None,
        }
    }
}

impl From<SocketAddr> for Endpoint {
    fn from(address: SocketAddr) -> Self {
        Self {
            host: address.ip().to_string(),
            port: Some(address.port()),
        }
    }
}

/// Which protocol versions to accept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VersionPolicy {
    /// Announce the newest version; if the robot refuses and names an older one that is known, announce that.
    #[default]
    Negotiate,
    /// This one and no other.
    Exact(Version),
}

/// Options of a connection. Made by [`Robot::builder`].
#[derive(Clone, Debug)]
#[must_use = "a builder does nothing until `connect` is awaited"]
pub struct Builder {
    pub(crate) endpoint: Endpoint,
    pub(crate) versions: VersionPolicy,
    pub(crate) scheduling: Scheduling,
    pub(crate) connect_timeout: Duration,
    pub(crate) link_timeout: Duration,
    pub(crate) nominal_model: bool,
    pub(crate) log_size: usize,
    pub(crate) cancellation: CancellationToken,
}

impl Builder {
    pub(crate) fn new(endpoint: Endpoint) -> Self {
        Self {
            endpoint,
            versions: VersionPolicy::default(),
            scheduling: Scheduling::default(),
            connect_timeout: connect::TCP_TIMEOUT,
            link_timeout: franka_rt::driver::LINK_TIMEOUT,
            nominal_model: false,
            log_size: ControlLog::DEFAULT_CAPACITY,
            cancellation: CancellationToken::new(),
        }
    }

    /// The TCP port; 1337 by default, as on a robot.
    pub fn port(mut self, port: u16) -> Self {
        self.endpoint.port = Some(port);
        self
    }

    /// Whether the control thread has to get what it asks the operating system for: `SCHED_FIFO` on a `PREEMPT_RT`
    /// kernel. [`Realtime::Enforce`] by default; [`Realtime::Ignore`] suits simulators.
    pub fn realtime(mut self, realtime: Realtime) -> Self {
        self.scheduling.realtime = realtime;
        self
    }

    /// `SCHED_FIFO` priority of the control thread, 1 to 99; the system's highest by default.
    pub fn priority(mut self, priority: i32) -> Self {
        self.scheduling.priority = Some(priority);
        self
    }

    /// The processor to run the control thread on; any by default.
    pub fn cpu(mut self, cpu: usize) -> Self {
        self.scheduling.cpu = Some(cpu);
        self
    }

    /// Locks the pages of the process into memory; off by default.
    pub fn lock_memory(mut self, lock: bool) -> Self {
        self.scheduling.lock_memory = lock;
        self
    }

    /// Which protocol versions to accept; negotiated by default.
    pub fn version(mut self, versions: VersionPolicy) -> Self {
        self.versions = versions;
        self
    }

    /// Time that each step of connecting may take: finding the host, the TCP connection, the handshake, the first state,
    /// the description. 1 s by default.
    pub fn connect_timeout(mut self, timeout: Duration) -> Self {
        self.connect_timeout = timeout;
        self
    }

    /// Silence of the robot after which a running motion fails with `LinkLost`. 1 s by default.
    pub fn link_timeout(mut self, timeout: Duration) -> Self {
        self.link_timeout = timeout;
        self
    }

    /// Whether to compute with the vendor's published constants whatever the robot says of itself; off by default, so that
    /// a Franka Research 3 is asked for its description, and keeps the limits in there. For a robot whose description this
    /// driver refuses, once it is known that its arm is that of the constants. A Franka Emika Robot has no description.
    pub fn nominal_model(mut self, nominal: bool) -> Self {
        self.nominal_model = nominal;
        self
    }

    /// How many of its last cycles an error carries when the robot ends a motion: see
    /// [`ControlError::log`](crate::ControlError::log). 50 by default; 0 for none, and then without the success rate in
    /// its text.
    pub fn log_size(mut self, cycles: usize) -> Self {
        self.log_size = cycles;
        self
    }

    /// Ends the connection when `token` is cancelled, as [`Robot::shutdown`] does: brakes, ends the motion, closes. For
    /// programs that end all their tasks by one token; await `shutdown` all the same, to know when it is done. Connecting
    /// itself goes on: drop its future to give it up.
    pub fn cancellation(mut self, token: CancellationToken) -> Self {
        self.cancellation = token;
        self
    }

    /// Connects: real-time check, TCP, handshake, first state, description. Must be called on a Tokio runtime with I/O and time
    /// enabled, which then runs the two tasks of the connection.
    ///
    /// # Errors
    /// [`ConnectError`]; nothing is left behind.
    ///
    /// # Cancel safety
    /// Dropping the future closes whatever was opened.
    pub async fn connect(self) -> Result<Robot, ConnectError> {
        connect::connect(self).await
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_endpoint_leaves_the_port_to_the_device_unless_one_is_given() {
        let of = |text: &str| {
            let Endpoint { host, port } = text.into();
            (host, port)
        };
        assert_eq!(of("172.16.0.2"), ("172.16.0.2".into(), None));
        assert_eq!(of("robot.lan"), ("robot.lan".into(), None));
        assert_eq!(of("127.0.0.1:40123"), ("127.0.0.1".into(), Some(40123)));
        assert_eq!(of("robot.lan:http"), ("robot.lan:http".into(), None));
        let address: SocketAddr = "10.0.0.7:99".parse().unwrap();
        assert_eq!(
            Endpoint::from(address),
            Endpoint {
                host: "10.0.0.7".into(),
                port: Some(99)
            }
        );
    }
}

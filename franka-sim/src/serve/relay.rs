//! The simulated network between the sockets and a device.

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use crate::network::Network;

/// A network in the time of the thread's clock, and where it leads.
#[derive(Debug)]
pub(super) struct Relay {
    network: Network,
    /// Where the network's time begins.
    origin: Instant,
    /// The latest time seen, since the network's must not run backwards.
    latest: Duration,
    /// Where the client listens, once a state has been sent there.
    listener: Option<SocketAddr>,
}

impl Relay {
    pub(super) fn new(network: Network) -> Self {
        Self {
            network,
            origin: Instant::now(),
            latest: Duration::ZERO,
            listener: None,
        }
    }

    fn time(&mut self, now: Instant) -> Duration {
        self.latest = self.latest.max(now.saturating_duration_since(self.origin));
        self.latest
    }

    /// A state for the client that listens there.
    pub(super) fn send_state(&mut self, now: Instant, datagram: &[u8], listener: SocketAddr) {
        self.listener = Some(listener);
        let time = self.time(now);
        self.network.to_client.send(time, datagram);
    }

    /// The next state that has arrived, and where.
    pub(super) fn take_state(&mut self, now: Instant) -> Option<(Vec<u8>, SocketAddr)> {
        let time = self.time(now);
        let delivery = self.network.to_client.take(time)?;
        Some((delivery.datagram, self.listener?))
    }

    /// A command, just read from the socket.
    pub(super) fn send_command(&mut self, now: Instant, datagram: &[u8]) {
        let time = self.time(now);
        self.network.to_robot.send(time, datagram);
    }

    /// The next command that has arrived.
    pub(super) fn take_command(&mut self, now: Instant) -> Option<Vec<u8>> {
        let time = self.time(now);
        let delivery = self.network.to_robot.take(time)?;
        Some(delivery.datagram)
    }

    /// Forgets what is under way: it was of a client that has gone.
    pub(super) fn clear(&mut self) {
        self.network.clear();
        self.listener = None;
    }

    /// How long nothing has to be done: until the next state arrives, and not long, since a command
    /// may come, whose time of arrival is when it is read.
    pub(super) fn pause(&self, now: Instant) -> Duration {
        let next = self.network.to_client.next_arrival();
        let left = next.map(|at| (self.origin + at).saturating_duration_since(now));
        left.unwrap_or(RELAY_POLL).min(RELAY_POLL)
    }
}

/// Time between two looks at the socket, and about what datagrams are later than the network has
/// it.
const RELAY_POLL: Duration = Duration::from_micros(100);

//! A network between the sockets and a device.

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use crate::network::Network;

/// A network in real time, and where it leads.
#[derive(Debug)]
pub(super) struct Between {
    network: Network,
    /// Where the network's time begins.
    origin: Instant,
    /// Where the client listens, once a state has been sent there.
    listener: Option<SocketAddr>,
}

impl Between {
    pub(super) fn new(network: Network) -> Self {
        Self {
            network,
            origin: Instant::now(),
            listener: None,
        }
    }

    /// A state for the client that listens there.
    pub(super) fn send_state(&mut self, datagram: &[u8], listener: SocketAddr) {
        self.listener = Some(listener);
        self.network.to_client.send(self.origin.elapsed(), datagram);
    }

    /// The next state that has arrived, and where.
    pub(super) fn take_state(&mut self) -> Option<(Vec<u8>, SocketAddr)> {
        let delivery = self.network.to_client.take(self.origin.elapsed())?;
        Some((delivery.datagram, self.listener?))
    }

    /// A command, just read from the socket.
    pub(super) fn send_command(&mut self, datagram: &[u8]) {
        self.network.to_robot.send(self.origin.elapsed(), datagram);
    }

    /// The next command that has arrived.
    pub(super) fn take_command(&mut self) -> Option<Vec<u8>> {
        let delivery = self.network.to_robot.take(self.origin.elapsed())?;
        Some(delivery.datagram)
    }

    /// Forgets what is under way: it was of a client that has gone.
    pub(super) fn clear(&mut self) {
        self.network.clear();
        self.listener = None;
    }

    /// How long nothing has to be done: until the next state arrives, and not long, since a command
    /// may come, whose time of arrival is when it is read.
    pub(super) fn pause(&self) -> Duration {
        let next = self.network.to_client.next_arrival();
        let left = next.map(|at| at.saturating_sub(self.origin.elapsed()));
        left.unwrap_or(GLANCE).min(GLANCE)
    }
}

/// Time between two looks at the socket, and about what datagrams are later than the network has
/// it.
const GLANCE: Duration = Duration::from_micros(100);

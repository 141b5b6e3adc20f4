//! The simulated network between the sockets and a device.

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use crate::network::Network;

/// A network whose time is the time of the thread's clock, and the client to which the network
/// delivers states.
#[derive(Debug)]
pub(super) struct Relay {
    network: Network,
    /// Start of the network's time.
    origin: Instant,
    /// Latest time so far, because the network's time must not decrease.
    latest: Duration,
    /// Address of the client, once a state has been sent to the client.
    listener: Option<SocketAddr>,
    /// `message_id` of the newest state that was sent.
    sent: Option<u64>,
    /// `message_id` of the first state of the current series that requires a command.
    asking: Option<u64>,
    /// `message_id` of the newest state that has reached the client.
    newest: Option<u64>,
    /// True if a command that answers the newest state has been read from the socket.
    answered: bool,
}

impl Relay {
    pub(super) fn new(network: Network) -> Self {
        Self {
            network,
            origin: Instant::now(),
            latest: Duration::ZERO,
            listener: None,
            sent: None,
            asking: None,
            newest: None,
            answered: false,
        }
    }

    /// Runs `job` on the network of a relay, if any, with the network's time. `job` may add or
    /// remove the network, which adds or removes the relay.
    pub(super) fn change<R>(
        relay: &mut Option<Self>,
        now: Instant,
        job: impl FnOnce(&mut Option<Network>, Duration) -> R,
    ) -> R {
        let Some(there) = relay else {
            let mut network = None;
            let result = job(&mut network, Duration::ZERO);
            *relay = network.map(|network| Self {
                origin: now,
                ..Self::new(network)
            });
            return result;
        };
        let time = there.time(now);
        let mut network = Some(std::mem::replace(&mut there.network, Network::perfect()));
        let result = job(&mut network, time);
        match network {
            Some(network) => there.network = network,
            None => *relay = None,
        }
        result
    }

    fn time(&mut self, now: Instant) -> Duration {
        self.latest = self.latest.max(now.saturating_duration_since(self.origin));
        self.latest
    }

    pub(super) fn send_state(&mut self, now: Instant, datagram: &[u8], listener: SocketAddr) {
        self.listener = Some(listener);
        self.sent = message_id(datagram);
        let time = self.time(now);
        self.network.to_client.send(time, datagram);
    }

    /// Records whether the last state requires a command.
    pub(super) fn note_asking(&mut self, asks: bool) {
        self.asking = if asks {
            self.asking.or(self.sent)
        } else {
            None
        };
    }

    /// Returns the next state that has arrived, and its destination.
    pub(super) fn take_state(&mut self, now: Instant) -> Option<(Vec<u8>, SocketAddr)> {
        let time = self.time(now);
        let delivery = self.network.to_client.take(time)?;
        let id = message_id(&delivery.datagram);
        if id > self.newest {
            (self.newest, self.answered) = (id, false);
        }
        Some((delivery.datagram, self.listener?))
    }

    /// Sends a command that was just read from the socket.
    pub(super) fn send_command(&mut self, now: Instant, datagram: &[u8]) {
        let time = self.time(now);
        self.answered |= message_id(datagram) == self.newest;
        self.network.to_robot.send(time, datagram);
    }

    pub(super) fn take_command(&mut self, now: Instant) -> Option<Vec<u8>> {
        let time = self.time(now);
        let delivery = self.network.to_robot.take(time)?;
        Some(delivery.datagram)
    }

    /// Discards the datagrams in transit, because their client has disconnected.
    pub(super) fn clear(&mut self) {
        self.network.clear();
        (self.listener, self.sent, self.asking) = (None, None, None);
        (self.newest, self.answered) = (None, false);
    }

    /// True if the client has received a state that requires a command, but has not answered the
    /// newest state that has reached the client.
    pub(super) fn is_unanswered(&self) -> bool {
        self.asking.is_some() && self.newest >= self.asking && !self.answered
    }

    /// Time at which the answer to the client's newest state arrives, if the answer is in transit
    /// and arrives soon.
    pub(super) fn answer_arrives(&mut self, now: Instant) -> Option<Instant> {
        let soon = self.time(now) + ON_ITS_WAY_MAX;
        let next = self
            .network
            .to_robot
            .next_arrival()
            .filter(|_| self.answered)?;
        (next <= soon).then(|| self.origin + next)
    }

    /// Time at which the next state arrives.
    pub(super) fn next_arrival(&self) -> Option<Instant> {
        let next = self.network.to_client.next_arrival();
        next.map(|at| self.origin + at)
    }

    /// Time until the relay must run again: at the latest, when the next state arrives. The time is
    /// always short, because a command's transit begins when the relay reads the command.
    pub(super) fn pause(&self, now: Instant) -> Duration {
        let next = self.next_arrival();
        let left = next.map(|at| at.saturating_duration_since(now));
        left.unwrap_or(RELAY_POLL).min(RELAY_POLL)
    }
}

/// The first field of states and commands of every version.
fn message_id(datagram: &[u8]) -> Option<u64> {
    datagram.first_chunk().map(|id| u64::from_le_bytes(*id))
}

/// Longest wait for a command in transit. A command that takes longer is late because of the
/// network, not because of the client.
const ON_ITS_WAY_MAX: Duration = Duration::from_micros(500);

/// Time between two checks of the socket. Datagrams are delayed by about this time.
const RELAY_POLL: Duration = Duration::from_micros(100);

//! A device on its sockets. It processes the client's requests once per cycle. `sessions` chooses
//! the client.

use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use bytes::Bytes;
use franka_proto::{RobotCommand, server};
use tokio::sync::mpsc;

use super::clock::Pace;
use super::device::Device;
use super::relay::Relay;
use crate::network::Network;
use crate::robot::Awaited;

/// Function that runs between two milliseconds.
pub(super) type Job<D> = Box<dyn FnOnce(Between<'_, D>) + Send>;

/// Objects that a job may read and change.
pub(super) struct Between<'a, D> {
    pub(super) device: &'a mut D,
    pub(super) relay: &'a mut Option<Relay>,
    pub(super) now: Instant,
    pub(super) pace: Pace,
}

/// Messages from the task of the stream to the thread.
pub(super) enum Order {
    /// A client has connected: its address, and the queue of its replies.
    Connect {
        peer: SocketAddr,
        replies: mpsc::Sender<Bytes>,
    },
    /// Bytes of the client's stream.
    Receive(Bytes),
    Disconnect,
}

/// Largest number of datagrams read per cycle, because a flood must not stop the clock.
const DATAGRAMS: usize = 64;

/// Largest number of orders per cycle, because a flood must not stop the clock.
const ORDERS: usize = 32;

/// Longest time for which the wait for a command may delay orders and jobs.
const JOB_POLL: Duration = Duration::from_millis(1);

/// Longest time that counts of one wait for a datagram. The kernel rounds such waits up to a few
/// milliseconds. During a longer wait, the host delayed this process, and perhaps the client.
const WAIT_MAX: Duration = Duration::from_millis(10);

/// Longest time of one wait that counts as silence. During a longer wait, this process was stopped.
const HELD_UP_MAX: Duration = Duration::from_millis(100);

/// Longest silence, unless the patience is longer. Without this limit, the waits for one answer
/// could add up to a second on a busy machine. A client considers the link lost after a second
/// without a state.
const SILENCE_MAX: Duration = Duration::from_millis(500);

/// Time for which the server has waited for an answer.
#[derive(Debug, Default)]
struct Wait {
    /// Time of silence, without the time for which this process was stopped.
    silence: Duration,
    /// Like `silence`, but also without most of the time for which this process waited for a
    /// processor.
    counted: Duration,
}

impl Wait {
    fn add(&mut self, took: Duration) {
        self.silence += took.min(HELD_UP_MAX);
        self.counted += took.min(WAIT_MAX);
    }

    /// True if the wait must end.
    fn is_over(&self, patience: Duration) -> bool {
        self.counted >= patience || self.silence >= patience.max(SILENCE_MAX)
    }
}

/// Capacity of the queue of replies. The server reads a request only if the queue has room for the
/// answers to this request and to all open requests. An answer may consist of two replies.
pub(super) const REPLIES: usize = 2 * ANSWERS;
const ANSWERS: usize = 2 + <server::Session>::PENDING_LIMIT;

/// A device, its UDP socket, the queues from its listener, and the simulated network, if any.
///
/// The queues are Tokio's, because one end is a task and the other end is this thread. The task can
/// wait for room or for a reply without blocking a worker. The thread never waits.
pub(super) struct DeviceServer<D> {
    device: Box<D>,
    socket: UdpSocket,
    orders: mpsc::Receiver<Order>,
    jobs: mpsc::Receiver<Job<D>>,
    client: Option<(SocketAddr, mpsc::Sender<Bytes>)>,
    relay: Option<Relay>,
}

impl<D: Device> DeviceServer<D> {
    pub(super) fn new(
        device: Box<D>,
        socket: UdpSocket,
        orders: mpsc::Receiver<Order>,
        jobs: mpsc::Receiver<Job<D>>,
    ) -> Self {
        Self {
            device,
            socket,
            orders,
            jobs,
            client: None,
            relay: None,
        }
    }

    /// Inserts this network between socket and device.
    pub(super) fn behind(mut self, network: Option<Network>) -> Self {
        self.relay = network.map(Relay::new);
        self
    }

    /// The device, for changes between two milliseconds.
    pub(super) fn device_mut(&mut self) -> &mut D {
        &mut self.device
    }

    /// Runs one millisecond at `now`: commands, orders, jobs, state, replies. Returns false if the
    /// simulation must end.
    pub(super) fn cycle(&mut self, now: Instant, pace: Pace) -> bool {
        self.take_commands(now);
        self.take_orders();
        if !self.run_jobs(now, pace) {
            return false;
        }
        self.send_replies();
        if let (Some(datagram), Some((peer, _))) = (self.device.tick(), &self.client) {
            // The address must include the interface of a link-local peer.
            let mut listener = *peer;
            listener.set_port(datagram.port);
            match &mut self.relay {
                Some(relay) => relay.send_state(now, datagram.bytes, listener),
                None => publish(&self.socket, datagram.bytes, listener),
            }
        }
        let asks = self.awaits() != Awaited::Nothing;
        if let Some(relay) = &mut self.relay {
            relay.note_asking(asks);
        }
        self.deliver_states(now);
        self.send_replies();
        true
    }

    /// Time until [`relay`](Self::relay) must run again; `None` without a network.
    pub(super) fn pause(&self, now: Instant) -> Option<Duration> {
        self.relay.as_ref().map(|relay| relay.pause(now))
    }

    /// Kind of command that the newest state still requires.
    pub(super) fn awaits(&self) -> Awaited {
        self.device.awaits()
    }

    /// Like [`awaits`](Self::awaits), but nothing if the client has answered all states that have
    /// reached the client.
    pub(super) fn awaits_answer(&self) -> Awaited {
        match &self.relay {
            Some(relay) if !relay.is_unanswered() => Awaited::Nothing,
            _ => self.awaits(),
        }
    }

    /// Time at which a network delivers the awaited command to the device, if the command is in
    /// transit.
    pub(super) fn answer_arrives(&mut self, now: Instant) -> Option<Instant> {
        let awaited = self.awaits() != Awaited::Nothing;
        let relay = self.relay.as_mut().filter(|_| awaited)?;
        relay.answer_arrives(now)
    }

    /// Time at which a network delivers the next state to the client.
    pub(super) fn next_arrival(&self) -> Option<Instant> {
        self.relay.as_ref().and_then(Relay::next_arrival)
    }

    /// Waits for the [awaited answer](Self::awaits_answer), at most for `patience` ([`Wait`]).
    /// `now` is the device's time. During the wait, this function processes orders and jobs.
    /// Returns false if the simulation must end.
    pub(super) fn await_command(&mut self, now: Instant, patience: Duration, pace: Pace) -> bool {
        let mut wait = Wait::default();
        loop {
            self.relay(now);
            if self.awaits_answer() == Awaited::Nothing || wait.is_over(patience) {
                return true;
            }
            self.take_orders();
            if !self.run_jobs(now, pace) {
                return false;
            }
            self.send_replies();
            let begun = Instant::now();
            self.wait_for_datagram(JOB_POLL);
            wait.add(begun.elapsed());
        }
    }

    /// Returns when a datagram has arrived, or after about `longest`.
    fn wait_for_datagram(&self, longest: Duration) {
        let socket = &self.socket;
        let wait = || {
            socket.set_nonblocking(false)?;
            socket.set_read_timeout(Some(longest))?;
            socket.peek_from(&mut [0])
        };
        // The next read from the socket reports the result, including errors.
        let _ = wait();
        let _ = socket.set_nonblocking(true);
    }

    pub(super) fn has_client(&self) -> bool {
        self.client.is_some()
    }

    /// Passes datagrams through the simulated network, between two milliseconds.
    pub(super) fn relay(&mut self, now: Instant) {
        self.take_commands(now);
        self.deliver_states(now);
    }

    fn deliver_states(&mut self, now: Instant) {
        let Some(relay) = &mut self.relay else {
            return;
        };
        while let Some((state, listener)) = relay.take_state(now) {
            publish(&self.socket, &state, listener);
        }
    }

    fn take_commands(&mut self, now: Instant) {
        let mut buffer = [0; RobotCommand::MAX_SIZE];
        for _ in 0..DATAGRAMS {
            match self.socket.recv_from(&mut buffer) {
                Ok((length, source)) => {
                    // Other sockets of the client's host are not the client.
                    let ip = self.client.as_ref().map(|(peer, _)| peer.ip());
                    let client = ip.zip(self.device.udp_port());
                    if client == Some((source.ip(), source.port())) {
                        match &mut self.relay {
                            Some(relay) => relay.send_command(now, &buffer[..length]),
                            None => self.device.command(&buffer[..length]),
                        }
                    }
                }
                // A closed port at the client causes an error of this socket.
                Err(error) if error.kind() == std::io::ErrorKind::ConnectionRefused => {}
                Err(_) => break,
            }
        }
        if let Some(relay) = &mut self.relay {
            while let Some(command) = relay.take_command(now) {
                self.device.command(&command);
            }
        }
    }

    fn take_orders(&mut self) {
        for _ in 0..ORDERS {
            if !self.has_room() {
                return;
            }
            match self.orders.try_recv() {
                Ok(Order::Connect { peer, replies }) => {
                    self.disconnect();
                    self.device.connect();
                    self.client = Some((peer, replies));
                }
                Ok(Order::Receive(bytes)) => {
                    let result = self.device.receive(&bytes);
                    self.send_replies();
                    if let Err(error) = result {
                        tracing::warn!(%error, "client of the {} disconnected", self.device.name());
                        self.forget_client();
                    }
                }
                Ok(Order::Disconnect) => self.disconnect(),
                Err(_) => return,
            }
        }
    }

    /// True if the queue has room for all answers to one more order. A disconnected client needs no
    /// room.
    fn has_room(&self) -> bool {
        let full =
            |replies: &mpsc::Sender<Bytes>| !replies.is_closed() && replies.capacity() < ANSWERS;
        !self
            .client
            .as_ref()
            .is_some_and(|(_, replies)| full(replies))
    }

    /// Runs the waiting jobs. Returns false if no more jobs can come, because the simulation must
    /// then end.
    fn run_jobs(&mut self, now: Instant, pace: Pace) -> bool {
        for _ in 0..ORDERS {
            match self.jobs.try_recv() {
                Ok(job) => job(Between {
                    device: &mut self.device,
                    relay: &mut self.relay,
                    now,
                    pace,
                }),
                Err(mpsc::error::TryRecvError::Empty) => return true,
                Err(mpsc::error::TryRecvError::Disconnected) => return false,
            }
        }
        true
    }

    fn send_replies(&mut self) {
        while let Some(reply) = self.device.take_reply() {
            let gone = match &self.client {
                Some((_, replies)) => replies.try_send(reply).is_err(),
                None => false,
            };
            if gone {
                // The queue is closed. The connection closes when the sender is dropped.
                self.disconnect();
            }
        }
    }

    fn disconnect(&mut self) {
        self.device.disconnect();
        self.forget_client();
    }

    /// Removes the client, and all datagrams in transit between client and device.
    fn forget_client(&mut self) {
        self.client = None;
        if let Some(relay) = &mut self.relay {
            relay.clear();
        }
    }
}

/// Sends a state to the client. A client that does not read loses states. TCP reports clients that
/// have disconnected.
fn publish(socket: &UdpSocket, state: &[u8], listener: SocketAddr) {
    let _ = socket.send_to(state, listener);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(waits: u32, each: Duration) -> Wait {
        let mut wait = Wait::default();
        (0..waits).for_each(|_| wait.add(each));
        wait
    }

    #[test]
    fn patience_outlasts_a_busy_host_but_not_long_silence() {
        const PATIENCE: Duration = Duration::from_millis(100);
        let held_up = Duration::from_millis(60);
        assert!(!after(8, held_up).is_over(PATIENCE));
        assert!(after(9, held_up).is_over(PATIENCE), "540 ms of silence");
        assert!(after(10, WAIT_MAX).is_over(PATIENCE));
        assert!(!after(9, held_up).is_over(Duration::from_secs(1)));
        assert!(!after(1, Duration::from_secs(2)).is_over(PATIENCE));
    }
}

//! End effectors with a separate server, as values without sockets. Bytes go in, bytes come out,
//! and each [`EndEffector::tick`] is one millisecond.
//!
//! ```text
//! TCP bytes ── receive() ──> session ──> requests ──> Mechanism ──> take_reply(): when it is done
//!                                                        tick() ──> states by UDP, 50 a second
//! ```
//!
//! This module has no clock, socket or thread. [`Hand`] and [`VacuumGripper`] differ only in their
//! [`Mechanism`].
//!
//! One action runs at a time. A new action or a stop aborts the running action, and the end
//! effector answers its request as aborted. When its client disconnects, the end effector stops the
//! action, but keeps holding its object.

mod finger_motion;
mod fingers;
mod suction;
#[cfg(test)]
mod tests;

pub use fingers::Fingers;
pub use suction::Suction;

use std::collections::VecDeque;

use bytes::Bytes;
use franka_proto::gripper::{Reply, Status, next_message};
use franka_proto::{CommandId, Protocol};

use crate::connection::{Connection, Datagram, SessionError};

/// A Franka Hand and its server.
pub type Hand = EndEffector<Fingers>;

/// A vacuum gripper and its server.
pub type VacuumGripper = EndEffector<Suction>;

/// Default time between two states `[ms]`. The vendor publishes no rate. Clients wait for a state
/// for at most a second.
pub const STATE_PERIOD: u32 = 20;

/// The mechanism that executes the requests of an end effector, independent of messages.
pub trait Mechanism {
    /// Protocol of the end effector's server.
    type Protocol: for<'a> Protocol<Reply<'a> = Reply> + Default;
    /// State that the end effector reports.
    type State;

    /// True if a request only ends the running action, without a new action.
    fn is_stop(request: &<Self::Protocol as Protocol>::Request) -> bool;

    /// Begins the requested action, which replaces the running action. Returns the answer if the
    /// action is already complete.
    fn begin(&mut self, request: &<Self::Protocol as Protocol>::Request) -> Option<Status>;

    /// Ends the running action and releases the object.
    fn halt(&mut self);

    /// Advances by one millisecond. Returns the answer if the action ends in this millisecond.
    fn tick(&mut self) -> Option<Status>;

    /// State to report, with `message_id` in milliseconds.
    fn state(&self, message_id: u32) -> Self::State;

    /// Encodes a state as a datagram.
    fn encode(state: &Self::State) -> Bytes;
}

/// A mechanism and its server. See the [module](self).
pub struct EndEffector<M: Mechanism> {
    mechanism: M,
    client: Option<Connection<M::Protocol>>,
    replies: VecDeque<Bytes>,
    /// The request whose action runs.
    running: Option<CommandId>,
    /// True if an action has ended since the last state.
    ended: bool,
    clock: u32,
    state_period: u32,
    datagram: Bytes,
}

impl<M: Mechanism> EndEffector<M> {
    /// A server for `mechanism`, without a client.
    pub fn new(mechanism: M) -> Self {
        Self {
            mechanism,
            client: None,
            replies: VecDeque::new(),
            running: None,
            ended: false,
            clock: 0,
            state_period: STATE_PERIOD,
            datagram: Bytes::new(),
        }
    }

    /// Sets the time between two states `[ms]`, at least 1, instead of [`STATE_PERIOD`].
    #[must_use]
    pub fn with_state_period(mut self, milliseconds: u32) -> Self {
        self.state_period = milliseconds.max(1);
        self
    }

    /// Connects a client. Returns false if another client is connected, because the server permits
    /// only one client.
    pub fn connect(&mut self) -> bool {
        if self.client.is_some() {
            return false;
        }
        self.replies.clear();
        self.client = Some(Connection::new(M::Protocol::default(), next_message));
        true
    }

    /// Disconnects the client. The running action ends, but the end effector continues to hold its
    /// object.
    pub fn disconnect(&mut self) {
        if self.running.take().is_some() {
            self.mechanism.halt();
        }
        self.client = None;
        self.replies.clear();
    }

    /// True if a client is connected.
    pub fn is_connected(&self) -> bool {
        self.client.is_some()
    }

    /// UDP port that the client announced for states.
    pub fn udp_port(&self) -> Option<u16> {
        self.client.as_ref()?.udp_port()
    }

    /// Accepts bytes of the client's stream, in pieces of any size.
    ///
    /// # Errors
    /// Returns [`SessionError`] if the client violated the protocol or uses another version. Send
    /// the remaining replies, and then close the connection.
    pub fn receive(
        &mut self,
        bytes: &[u8],
    ) -> Result<(), SessionError<<M::Protocol as Protocol>::Command>> {
        let Some(client) = &mut self.client else {
            return Ok(());
        };
        client.receive(bytes);
        let result = self.take_requests();
        if result.is_err() {
            let replies = std::mem::take(&mut self.replies);
            self.disconnect();
            self.replies = replies;
        }
        result
    }

    /// Returns the next message to write to the client's stream.
    pub fn take_reply(&mut self) -> Option<Bytes> {
        self.replies.pop_front()
    }

    /// Advances by one millisecond. Returns a state if a client is connected and a state is due.
    /// States are due once per [state period](Self::with_state_period) and after an action has
    /// ended.
    pub fn tick(&mut self) -> Option<Datagram<'_>> {
        self.clock = self.clock.wrapping_add(1);
        if let Some(status) = self.mechanism.tick()
            && let Some(id) = self.running.take()
        {
            self.reply(id, status);
        }
        let due = self.clock.is_multiple_of(self.state_period);
        if !std::mem::take(&mut self.ended) && !due {
            return None;
        }
        let port = self.client.as_ref()?.udp_port()?;
        self.datagram = M::encode(&self.state());
        Some(Datagram {
            port,
            bytes: &self.datagram,
        })
    }

    /// Returns the current state, as it would be reported.
    pub fn state(&self) -> M::State {
        self.mechanism.state(self.clock)
    }

    /// Returns the mechanism behind the server.
    pub fn mechanism(&self) -> &M {
        &self.mechanism
    }

    /// Returns a mutable reference to the mechanism, for example to add an object.
    pub fn mechanism_mut(&mut self) -> &mut M {
        &mut self.mechanism
    }

    fn take_requests(&mut self) -> Result<(), SessionError<<M::Protocol as Protocol>::Command>> {
        while let Some(client) = &mut self.client {
            let Some((id, request)) = client.next_request(&mut self.replies)? else {
                break;
            };
            self.answer(id, &request);
        }
        Ok(())
    }

    fn answer(&mut self, id: CommandId, request: &<M::Protocol as Protocol>::Request) {
        if let Some(aborted) = self.running.take() {
            self.reply(aborted, Status::Aborted);
        }
        if M::is_stop(request) {
            self.mechanism.halt();
            self.reply(id, Status::Success);
        } else if let Some(status) = self.mechanism.begin(request) {
            self.reply(id, status);
        } else {
            self.running = Some(id);
        }
    }

    fn reply(&mut self, id: CommandId, status: Status) {
        let Some(client) = &mut self.client else {
            return;
        };
        self.ended = true;
        // The session refuses a reply to which no request belongs.
        if let Ok(message) = client.session.reply(id, Reply::Done(status)) {
            let message = Bytes::copy_from_slice(message.as_bytes());
            self.replies.push_back(message);
        }
    }
}

/// Moves `value` towards `target` by `step` at most, and not beyond `target`.
fn towards(value: f64, target: f64, step: f64) -> f64 {
    let way = target - value;
    if way.abs() <= step {
        target
    } else {
        value + step.copysign(way)
    }
}

//! What the server needs of a device: the same of the robot and of what hangs on it.

use std::fmt::Display;

use bytes::Bytes;
use franka_proto::framing::{FrameError, MAX_REQUEST_SIZE, Message, next_message_within};
use franka_proto::{Protocol, gripper};

use crate::end_effector::{EndEffector, Mechanism};
use crate::robot::{Awaited, Datagram, Robot, SessionError};

/// A device as a value, with one client at a time. The methods are those of [`Robot`].
pub(super) trait Device: Send + 'static {
    /// Why it disconnects a client.
    type Error: Display;

    /// How much of a stream to give to [`receive`](Self::receive): the first message, or everything
    /// if it can never become one. `None` while that is open.
    fn portion(received: &[u8]) -> Option<usize>;

    fn name(&self) -> &'static str;
    fn connect(&mut self) -> bool;
    fn disconnect(&mut self);
    fn receive(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;
    fn command(&mut self, datagram: &[u8]);
    fn awaits(&self) -> Awaited;
    fn take_reply(&mut self) -> Option<Bytes>;
    fn tick(&mut self) -> Option<Datagram<'_>>;
}

impl Device for Robot {
    type Error = SessionError;

    fn portion(received: &[u8]) -> Option<usize> {
        length(received, next_message_within(received, MAX_REQUEST_SIZE))
    }

    fn name(&self) -> &'static str {
        "robot"
    }

    fn connect(&mut self) -> bool {
        self.connect()
    }

    fn disconnect(&mut self) {
        self.disconnect();
    }

    fn receive(&mut self, bytes: &[u8]) -> Result<(), Self::Error> {
        self.receive(bytes)
    }

    fn command(&mut self, datagram: &[u8]) {
        self.command(datagram);
    }

    fn awaits(&self) -> Awaited {
        self.awaits()
    }

    fn take_reply(&mut self) -> Option<Bytes> {
        self.take_reply()
    }

    fn tick(&mut self) -> Option<Datagram<'_>> {
        self.tick()
    }
}

impl<M: Mechanism + Send + 'static> Device for EndEffector<M>
where
    M::Protocol: Send,
    <M::Protocol as Protocol>::Command: Send,
{
    type Error = SessionError<<M::Protocol as Protocol>::Command>;

    fn portion(received: &[u8]) -> Option<usize> {
        length(received, gripper::next_message(received))
    }

    fn name(&self) -> &'static str {
        M::Protocol::default().device()
    }

    fn connect(&mut self) -> bool {
        self.connect()
    }

    fn disconnect(&mut self) {
        self.disconnect();
    }

    fn receive(&mut self, bytes: &[u8]) -> Result<(), Self::Error> {
        self.receive(bytes)
    }

    /// Nothing goes this way in their protocols.
    fn command(&mut self, _: &[u8]) {}

    fn awaits(&self) -> Awaited {
        Awaited::Nothing
    }

    fn take_reply(&mut self) -> Option<Bytes> {
        self.take_reply()
    }

    fn tick(&mut self) -> Option<Datagram<'_>> {
        self.tick()
    }
}

/// [`Device::portion`] of what has been cut like this.
fn length(received: &[u8], first: Result<Option<Message<'_>>, FrameError>) -> Option<usize> {
    match first {
        Ok(message) => message.map(|message| message.size()),
        Err(_) => Some(received.len()),
    }
}

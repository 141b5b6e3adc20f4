//! What the server needs of a device: the same of the robot and of what hangs on it.

use std::fmt::Display;

use bytes::Bytes;
use franka_proto::Protocol;

use crate::end_effector::{EndEffector, Mechanism};
use crate::robot::{Datagram, Robot, SessionError};

/// A device as a value, with one client at a time. The methods are those of [`Robot`].
pub(super) trait Device: Send + 'static {
    /// Why it disconnects a client.
    type Error: Display;

    fn name(&self) -> &'static str;
    fn connect(&mut self) -> bool;
    fn disconnect(&mut self);
    fn receive(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;
    fn command(&mut self, datagram: &[u8]);
    fn take_reply(&mut self) -> Option<Bytes>;
    fn tick(&mut self) -> Option<Datagram<'_>>;
}

impl Device for Robot {
    type Error = SessionError;

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

    fn take_reply(&mut self) -> Option<Bytes> {
        self.take_reply()
    }

    fn tick(&mut self) -> Option<Datagram<'_>> {
        self.tick()
    }
}

//! The interface of a device to the server, common to the robot and the end effectors.

use std::fmt::Display;

use bytes::Bytes;
use franka_proto::{Protocol, gripper};

use crate::connection::{Datagram, Framing, SessionError};
use crate::end_effector::{EndEffector, Mechanism};
use crate::robot::{Awaited, Robot, next_request};

/// A device as a value, with one client at a time. The methods are documented at [`Robot`].
pub(super) trait Device: Send + 'static {
    /// Reason why the device disconnects a client.
    type Error: Display;

    /// Function that splits the client's stream into messages.
    const FRAMING: Framing;

    fn name(&self) -> &'static str;
    fn connect(&mut self) -> bool;
    fn disconnect(&mut self);
    fn udp_port(&self) -> Option<u16>;
    fn receive(&mut self, bytes: &[u8]) -> Result<(), Self::Error>;
    fn command(&mut self, datagram: &[u8]);
    fn awaits(&self) -> Awaited;
    fn take_reply(&mut self) -> Option<Bytes>;
    fn tick(&mut self) -> Option<Datagram<'_>>;
}

/// Implements the methods that all devices have under the same names.
macro_rules! inherent {
    () => {
        fn connect(&mut self) -> bool {
            self.connect()
        }

        fn disconnect(&mut self) {
            self.disconnect();
        }

        fn udp_port(&self) -> Option<u16> {
            self.udp_port()
        }

        fn receive(&mut self, bytes: &[u8]) -> Result<(), Self::Error> {
            self.receive(bytes)
        }

        fn take_reply(&mut self) -> Option<Bytes> {
            self.take_reply()
        }

        fn tick(&mut self) -> Option<Datagram<'_>> {
            self.tick()
        }
    };
}

impl Device for Robot {
    type Error = SessionError;

    const FRAMING: Framing = next_request;

    inherent!();

    fn name(&self) -> &'static str {
        "robot"
    }

    fn command(&mut self, datagram: &[u8]) {
        self.command(datagram);
    }

    fn awaits(&self) -> Awaited {
        self.awaits()
    }
}

impl<M: Mechanism + Send + 'static> Device for EndEffector<M>
where
    M::Protocol: Send,
    <M::Protocol as Protocol>::Command: Send,
{
    type Error = SessionError<<M::Protocol as Protocol>::Command>;

    const FRAMING: Framing = gripper::next_message;

    inherent!();

    fn name(&self) -> &'static str {
        M::Protocol::default().device()
    }

    /// The protocols of the end effectors have no UDP commands.
    fn command(&mut self, _: &[u8]) {}

    fn awaits(&self) -> Awaited {
        Awaited::Nothing
    }
}

//! Differences between the devices: ports, framing, and command names.

use std::fmt;

use franka_proto::framing::{FrameError, Message, next_message};
use franka_proto::wire::service::ConnectRequest;
use franka_proto::{Protocol as _, Version, gripper, vacuum};
use zerocopy::FromBytes as _;

/// A device of the robot with a separate TCP service.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Device {
    /// The arm.
    Robot,
    /// The Franka Hand.
    Hand,
    /// The vacuum gripper.
    VacuumGripper,
}

impl Device {
    /// All devices, ordered by port.
    pub const ALL: [Self; 3] = [Self::Robot, Self::Hand, Self::VacuumGripper];

    /// Returns the TCP port of the device.
    #[must_use]
    pub fn port(self) -> u16 {
        match self {
            Self::Robot => Version::TCP_PORT,
            Self::Hand => gripper::Version::TCP_PORT,
            Self::VacuumGripper => vacuum::Version::TCP_PORT,
        }
    }

    /// Returns the device with this TCP port, if any.
    #[must_use]
    pub fn with_port(port: u16) -> Option<Self> {
        Self::ALL.into_iter().find(|device| device.port() == port)
    }

    /// Returns the first message of a stream; `None` if the message is incomplete.
    pub(crate) fn next_message(self, stream: &[u8]) -> Result<Option<Message<'_>>, FrameError> {
        match self {
            Self::Robot => next_message(stream),
            Self::Hand | Self::VacuumGripper => gripper::next_message(stream),
        }
    }

    /// Returns the `Connect` message at the beginning of a client's stream; `None` if the message
    /// is incomplete, or if the stream begins with another message.
    pub(crate) fn connect(self, stream: &[u8]) -> Option<ConnectRequest> {
        let message = self.next_message(stream).ok()??;
        let (request, _) = ConnectRequest::read_from_prefix(message.payload).ok()?;
        (message.header.command == 0).then_some(request)
    }

    /// Returns the byte range of a message's id. The id follows the command, which is shorter for
    /// the end effectors than for the arm.
    pub(crate) fn id_range(self) -> std::ops::Range<usize> {
        match self {
            Self::Robot => 4..8,
            Self::Hand | Self::VacuumGripper => 2..6,
        }
    }

    pub(crate) fn counter_size(self) -> usize {
        match self {
            Self::Robot => 8,
            Self::Hand | Self::VacuumGripper => 4,
        }
    }

    /// Returns the name of a request for error messages. `version` is the version in `Connect`.
    pub(crate) fn request_name(self, version: u16, message: &Message<'_>) -> String {
        let number = message.header.command;
        let known = match self {
            Self::Robot => Version::from_number(version)
                .and_then(|version| version.command_from_number(number))
                .map(|command| command.to_string()),
            Self::Hand => gripper::Version::V3
                .decode_request(message)
                .ok()
                .map(|request| gripper::Version::command_of(&request).to_string()),
            Self::VacuumGripper => vacuum::Version::V1
                .decode_request(message)
                .ok()
                .map(|request| vacuum::Version::command_of(&request).to_string()),
        };
        known.unwrap_or_else(|| format!("command {number}"))
    }
}

impl fmt::Display for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Robot => "robot",
            Self::Hand => "hand",
            Self::VacuumGripper => "vacuum gripper",
        })
    }
}

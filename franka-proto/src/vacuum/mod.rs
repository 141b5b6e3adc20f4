//! The protocol of the vacuum gripper: TCP port 1339, version 1. It is the same on both robots.
//!
//! The protocol works like the protocol of the [Hand](crate::gripper). The gripper replies to each
//! request after the action has ended, and sends its [`State`] over UDP.

mod request;
mod state;

use crate::{client, server};

pub use crate::end_effector::{Failure, Reply, Status, next_message};
pub use request::{Command, Profile, Request, UndefinedProfile, Vacuum};
pub use state::{DeviceStatus, State};

/// A version of the vacuum gripper's protocol. Only one version exists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Version {
    /// Version 1, which all vacuum grippers use with protocols 5 and 10 of the robot.
    #[default]
    V1,
}

impl Version {
    /// TCP port of the vacuum gripper.
    pub const TCP_PORT: u16 = 1339;
}

/// The client's side of a connection to a vacuum gripper.
pub type Client = client::Session<Version>;

/// The vacuum gripper's side of a connection.
pub type Server = server::Session<Version>;

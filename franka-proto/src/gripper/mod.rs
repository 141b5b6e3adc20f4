//! The protocol of the Franka Hand: TCP port 1338, version 3. It is the same on both robots.
//!
//! A client sends requests over TCP. The hand replies to each request when its action has ended.
//! The client can send `Stop` while another action runs. The hand then replies to the other action
//! with the status "aborted". It sends its [`State`] over UDP to the port in the handshake. The
//! client sends no UDP datagrams.
//!
//! ```
//! use franka_proto::gripper::{Client, Command, Request, Server, Status, Version, next_message};
//! use franka_proto::{client, gripper, server};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut client = Client::new(Version::V3);
//! let mut hand = Server::new(Version::V3);
//!
//! let hello = client.connect(4711);
//! let message = next_message(hello.as_bytes())?.expect("sent whole");
//! if let server::Event::Connect { reply, .. } = hand.on_message(message)? {
//!     client.on_message(next_message(reply.as_bytes())?.expect("sent whole"))?;
//! }
//!
//! let homing = client.request(&Request::Homing)?;
//! hand.on_message(next_message(homing.as_bytes())?.expect("sent whole"))?;
//! let answer = hand.reply(homing.id(), gripper::Reply::Done(Status::Success))?;
//! let event = client.on_message(next_message(answer.as_bytes())?.expect("sent whole"))?;
//! assert!(matches!(event, client::Event::Reply { command: Command::Homing, .. }));
//! # Ok(())
//! # }
//! ```

mod request;
mod state;

use crate::{client, server};

pub use crate::end_effector::{Failure, Reply, Status, next_message};
pub use request::{Command, Grasp, Move, Request};
pub use state::State;

/// A version of the Hand's protocol. Only one version exists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Version {
    /// Version 3, which all Hands use with protocols 5 and 10 of the robot.
    #[default]
    V3,
}

impl Version {
    /// TCP port of the Hand.
    pub const TCP_PORT: u16 = 1338;
}

/// The client's side of a connection to a Hand.
pub type Client = client::Session<Version>;

/// The Hand's side of a connection.
pub type Server = server::Session<Version>;

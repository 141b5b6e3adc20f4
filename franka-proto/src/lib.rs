//! The wire protocol (FCI) of Franka robots. This crate decodes and encodes the messages of both
//! sides.
//!
//! One crate contains protocol 10 (Franka Research 3) and protocol 5 (Franka Emika Robot). It only
//! converts bytes to values and values to bytes: it does no input or output, allocates nothing, and
//! has no clock or threads. The real-time thread, an asynchronous shell, a simulator and tests use
//! the same code.
//!
//! ```text
//!            TCP stream                                    UDP datagrams
//!  bytes -> framing::next_message -> Message     bytes <-> wire::RobotState<..>   <-> RobotState
//!        -> client::Session -> Event             bytes <-> wire::RobotCommand<..> <-> RobotCommand
//!  Request -> client::Session -> Outgoing
//!        -> server::Session -> Event; Reply -> Outgoing
//!                         \                          /
//!                          Version, and its one table
//! ```
//!
//! | part | contents |
//! |---|---|
//! | [`Version`] | the versions, and the table of their differences |
//! | [`wire`] | the packed structs, declared once, with their offsets asserted |
//! | [`RobotState`], [`RobotCommand`] | the datagrams as `f64`, the same for all versions |
//! | [`framing`] | splits byte streams into whole messages of limited size |
//! | [`Request`], [`Reply`] | the decoded messages |
//! | [`client`], [`server`] | the two sides of a connection as state machines |
//! | [`gripper`], [`vacuum`] | the protocols of the Franka Hand and of the vacuum gripper |
//! | [`Protocol`] | the interface between sessions and protocols; the same sessions run all three protocols |
//! | [`Refusal`], [`ControlFailure`], [`IncompatibleVersion`] | libfranka's texts, byte for byte |
//!
//! # Example
//!
//! This example runs a client and a robot in one thread:
//!
//! ```
//! use franka_proto::framing::next_message;
//! use franka_proto::{Reply, Request, StopStatus, Version, client, server};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut client = client::Session::new(Version::V10);
//! let mut robot = server::Session::new(Version::V10);
//!
//! let hello = client.connect(4711);
//! let message = next_message(hello.as_bytes())?.expect("sent whole");
//! if let server::Event::Connect { udp_port, reply, .. } = robot.on_message(message)? {
//!     assert_eq!(udp_port, 4711); // states go there from now on
//!     client.on_message(next_message(reply.as_bytes())?.expect("sent whole"))?;
//! }
//!
//! let stop = client.request(&Request::StopMove)?;
//! robot.on_message(next_message(stop.as_bytes())?.expect("sent whole"))?;
//! let answer = robot.reply(stop.id(), Reply::StopMove(StopStatus::Success))?;
//! let event = client.on_message(next_message(answer.as_bytes())?.expect("sent whole"))?;
//! assert!(matches!(event, client::Event::Reply { id, .. } if id == stop.id()));
//! # Ok(())
//! # }
//! ```
//!
//! # Panics and bad bytes
//!
//! Decoding never panics on any input. For a message that cannot be decoded, they return an error
//! with the received and the expected value. Decoders check lengths before they read data. They
//! refuse a message whose header announces more than [`framing::MAX_MESSAGE_SIZE`] before they
//! collect the message.
//!
//! # Features
//!
//! The feature `serde` (off by default, needs no allocator) serialises states, modes, commands,
//! statuses and parameters. Fields have the vendor's names, and sets of errors are lists of
//! libfranka's names.
//!
//! # What is not here
//!
//! This crate has no sockets, deadlines, limits or filters. The caller decides which states to
//! accept and when to answer.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod client;
mod command;
mod end_effector;
pub mod framing;
pub mod gripper;
mod number_text;
mod outgoing;
mod pending;
mod protocol;
mod robot;
pub mod server;
pub mod vacuum;
mod version;
pub mod wire;

pub use command::{Command, CommandId, ServiceCommand};
pub use number_text::General;
pub use outgoing::Outgoing;
pub use protocol::{
    ConnectStatus, DecodeError, EncodeError, Explanation, FieldDevice, IncompatibleVersion,
    Progress, Protocol, ReplyError, RequestError, Violation,
};
pub use robot::{
    Architecture, CollisionBehavior, ControlFailure, ControllerMode, Deviation, Errors, Filters,
    LibraryStatus, Load, ModelStatus, MotionGeneratorMode, MoveControllerMode, MoveGeneratorMode,
    MoveRequest, MoveStatus, RecoveryStatus, Refusal, Reply, Request, RobotCommand, RobotError,
    RobotMode, RobotState, SetterStatus, StateText, Status, StopStatus, SuccessRate, System,
    TotalLoad, VirtualWall,
};
pub use version::Version;

// Compiles the program in the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

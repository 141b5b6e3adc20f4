//! Wire protocol of Franka robots as values: bytes to meaning and back, for both sides.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod client;
mod command;
mod control_error;
mod error;
mod errors;
pub mod framing;
mod modes;
mod outgoing;
mod pending;
pub mod server;
mod service;
mod state;
mod version;
pub mod wire;

pub use command::RobotCommand;
pub use control_error::{ControlFailure, General, SuccessRate};
pub use error::{DecodeError, EncodeError, ReplyError, RequestError, Violation};
pub use errors::{Errors, RobotError};
pub use modes::{ControllerMode, MotionGeneratorMode, RobotMode};
pub use outgoing::Outgoing;
pub use service::{
    CollisionBehavior, Command, CommandId, ConnectStatus, Deviation, Load, ModelStatus,
    MoveControllerMode, MoveGeneratorMode, MoveRequest, MoveStatus, RecoveryStatus, Refusal, Reply,
    Request, SetterStatus, Status, StopStatus,
};
pub use state::{RobotState, TotalLoad};
pub use version::{IncompatibleVersion, Version};

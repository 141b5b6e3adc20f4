//! Payloads of requests and replies, one request family per file.
//!
//! A request without parameters has no struct: it is a header alone. Replies that are a status
//! alone are one byte.

mod connect;
mod motion;
mod setters;

pub use connect::{ConnectRequest, ConnectResponse};
pub use motion::{AsynchronousMotion, Deviation, MoveRequest};
pub use setters::{
    SetCartesianImpedance, SetCollisionBehavior, SetFrame, SetGuidingMode, SetJointImpedance,
    SetLoad,
};

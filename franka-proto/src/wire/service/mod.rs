//! Payloads of requests and replies, one request family per file.
//!
//! A request without parameters has no struct, because it is only a header. A reply that is only a
//! status has no struct either.

mod connect;
mod library;
mod limit;
mod motion;
mod setters;

pub use connect::{ConnectRequest, ConnectResponse};
pub use library::LoadModelLibrary;
pub use limit::{CartesianLimit, GetCartesianLimit};
pub use motion::{AsynchronousMotion, Deviation, MoveRequest};
pub use setters::{
    SetCartesianImpedance, SetCollisionBehavior, SetFilters, SetFrame, SetGuidingMode,
    SetJointImpedance, SetLoad,
};

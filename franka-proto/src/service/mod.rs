//! Requests and replies of the TCP service as meaning, whatever the version.

mod collision;
mod command;
mod motion;
mod refusal;
mod reply;
mod request;
mod status;

pub use collision::CollisionBehavior;
pub use command::{Command, CommandId};
pub(crate) use motion::{AsynchronousPart, MoveCodec};
pub use motion::{Deviation, MoveControllerMode, MoveGeneratorMode, MoveRequest};
pub use refusal::Refusal;
pub use reply::Reply;
pub(crate) use request::payload;
pub use request::{Load, Request};
pub use status::{
    ConnectStatus, ModelStatus, MoveStatus, RecoveryStatus, SetterStatus, Status, StopStatus,
};

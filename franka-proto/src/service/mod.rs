//! Requests and replies of the TCP service as meaning, whatever the version.

mod collision;
mod command;
mod filters;
mod library;
mod motion;
mod refusal;
mod reply;
mod request;
mod status;
mod wall;

pub use collision::CollisionBehavior;
pub use command::{Command, CommandId};
pub use filters::Filters;
pub use library::{Architecture, System};
pub(crate) use motion::{AsynchronousPart, MoveCodec};
pub use motion::{Deviation, MoveControllerMode, MoveGeneratorMode, MoveRequest};
pub use refusal::Refusal;
pub use reply::Reply;
pub(crate) use request::payload;
pub use request::{Load, Request};
pub use status::{
    ConnectStatus, LibraryStatus, ModelStatus, MoveStatus, RecoveryStatus, SetterStatus, Status,
    StopStatus,
};
pub use wall::VirtualWall;

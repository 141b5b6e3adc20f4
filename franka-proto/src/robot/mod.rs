//! The robot's protocol in all its versions: the version table, requests and replies of the TCP
//! service, and the datagrams.

mod collision;
mod control_failure;
#[cfg(feature = "serde")]
mod error_names;
mod filters;
mod library;
mod modes;
mod motion;
mod refusal;
mod reply;
mod request;
mod robot_command;
mod robot_error;
mod service;
mod state;
mod status;
mod table;
mod wall;

pub use collision::CollisionBehavior;
pub use control_failure::{ControlFailure, SuccessRate};
pub use filters::Filters;
pub use library::{Architecture, System};
pub use modes::{ControllerMode, MotionGeneratorMode, RobotMode};
pub use motion::{Deviation, MoveControllerMode, MoveGeneratorMode, MoveRequest};
pub use refusal::Refusal;
pub use reply::Reply;
pub use request::{Load, Request};
pub use robot_command::RobotCommand;
pub use robot_error::{Errors, RobotError};
pub use state::{RobotState, StateText, TotalLoad};
pub use status::{
    LibraryStatus, ModelStatus, MoveStatus, RecoveryStatus, SetterStatus, Status, StopStatus,
};
pub use wall::VirtualWall;

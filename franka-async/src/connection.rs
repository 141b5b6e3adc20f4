//! Options of a connection: see [`Robot::builder`](crate::Robot::builder). For the scheduling of
//! the control thread see [`realtime`](crate::realtime).

pub use crate::builder::{Builder, VersionPolicy};
pub use crate::endpoint::Endpoint;
pub use franka_proto::Version;
pub use tokio_util::sync::CancellationToken;

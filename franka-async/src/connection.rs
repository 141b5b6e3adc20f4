//! Options of a connection: see [`Robot::builder`](crate::Robot::builder). For the scheduling of
//! the control thread see [`realtime`](crate::realtime). Services that pass a robot on to their own
//! clients check the clients with `admission` (feature `admission`), and let one client at a time
//! move the arm by [`lease`].

#[cfg(feature = "admission")]
pub mod admission;
pub mod lease;

pub use crate::builder::{Builder, VersionPolicy};
pub use crate::endpoint::Endpoint;
pub use crate::geometry_check::GeometryCheck;
pub use franka_proto::Version;
pub use tokio_util::sync::CancellationToken;

//! Options of a connection: see [`Robot::builder`](crate::Robot::builder). For the scheduling of
//! the control thread, see [`realtime`](crate::realtime). A service through which clients move a
//! robot checks their requests with `admission` (feature `admission`). With a [`lease`], the
//! service lets one client at a time move the arm.

#[cfg(feature = "admission")]
pub mod admission;
pub mod lease;

pub use crate::builder::{Builder, VersionPolicy};
pub use crate::endpoint::Endpoint;
pub use crate::geometry_check::GeometryCheck;
pub use franka_proto::Version;
pub use tokio_util::sync::CancellationToken;

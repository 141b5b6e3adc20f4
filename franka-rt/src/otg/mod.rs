//! Jerk-limited online trajectory generation to targets at rest.

mod axis;
mod brake;
mod error;
mod generator;
mod given_duration;
mod least_time;
mod limits;
mod line;
mod plan;
mod profile;
mod state;
mod task;
mod transfer;
mod turn;

pub use error::{PlanError, Quantity};
pub use generator::{CYCLE, Generator};
pub use limits::{AxisLimits, Limits};
pub use plan::Synchronisation;
pub use state::{AxisState, State};

//! Records of every cycle, with its inputs and outputs ([`Robot::records`](crate::Robot::records),
//! [`Robot::cycles`](crate::Robot::cycles), [`Engage::observer`](crate::Engage::observer)), and the
//! log in an error.

pub use franka_proto::RobotCommand;
pub use franka_rt::driver::{
    Activity, Column, ColumnKind, ColumnSource, ControlLog, LogEntry, Record,
};
pub use franka_rt::session::{Bindings, Guard};
pub use franka_rt::thread::{AttachError, CapturedCycle, CycleFeed, CycleReader};

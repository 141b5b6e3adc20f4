//! Scheduling of the control thread, and how punctual it is: [`Realtime`](crate::Realtime) and the
//! options of a [`Builder`](crate::connection::Builder).

pub use franka_rt::sched::{Granted, Kernel, Scheduling};
pub use franka_rt::stats::{
    Counter, CycleTimes, Histogram, MotionStatistics, Phase, Phases, Quantiles, Slack, Stats,
};

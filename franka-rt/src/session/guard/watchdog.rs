//! The watchdog: if the targets of a goal stop arriving, the arm holds the last target or brakes.
//! (For late states see `stats::lateness`; for a robot that sends no states see
//! `driver::link_timeout`.)

use core::time::Duration;

/// Gives up a goal whose targets stop arriving.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Watchdog {
    /// The longest accepted time without a target, by the robot's clock in whole milliseconds.
    pub silence: Duration,
    /// Action of the arm after that time. The motion ends when the arm rests, unless its session
    /// lasts from goal to goal.
    pub on_timeout: OnTimeout,
}

/// Action of the arm when its targets have stopped arriving.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OnTimeout {
    /// Moves to the last target and holds it.
    Hold,
    /// Brakes at once, and holds the place where it stops.
    Brake,
}

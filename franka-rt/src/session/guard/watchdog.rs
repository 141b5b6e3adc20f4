//! The watchdog: a goal whose targets stop coming is held at the last one, or braked. (States that
//! come late: `stats::arrivals`. A silent robot: `driver::link_timeout`.)

use core::time::Duration;

/// Gives up a goal whose targets stop coming.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Watchdog {
    /// The longest time without a target, by the robot's clock in whole milliseconds.
    pub silence: Duration,
    /// What the arm does after that. The motion ends once it rests, unless its session goes from
    /// goal to goal.
    pub on_timeout: OnTimeout,
}

/// What the arm does when its targets have stopped coming.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OnTimeout {
    /// Goes on to the last target and holds it.
    Hold,
    /// Brakes at once, and holds where it comes to rest.
    Brake,
}

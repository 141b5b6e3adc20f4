//! A plan as its pieces, for whoever draws or records it.

use crate::state::AxisState;

/// A piece of the motion of one axis with constant jerk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// When it begins, in seconds from now; negative for what has begun already.
    pub start: f64,
    /// How long it lasts, in seconds.
    pub duration: f64,
    /// State where it begins.
    pub state: AxisState,
    /// Its jerk, in units per second cubed.
    pub jerk: f64,
}

//! Why a state, target or limit is refused at the door.

use core::fmt;

/// Why no plan is made. The generator keeps the plan that it has.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A number of a state or target is infinite or not a number.
    #[error("{quantity} of axis {axis} is not finite")]
    NotFinite {
        /// What the number describes.
        quantity: Quantity,
        /// Axis, counted from zero.
        axis: usize,
    },
    /// A limit is zero, negative, infinite or not a number.
    #[error("{quantity} limit {value} of axis {axis} is not a positive finite number")]
    Limit {
        /// What is limited.
        quantity: Quantity,
        /// Axis, counted from zero.
        axis: usize,
        /// The limit as given.
        value: f64,
    },
    /// The target's velocity and acceleration cannot be met inside the limits: the acceleration is
    /// larger than its limit, or the velocity would be on the way there or behind it.
    #[error("the motion of the target of axis {axis} does not fit its limits")]
    TargetMotion {
        /// Axis, counted from zero; 0 for a straight line, which is planned as one.
        axis: usize,
    },
    /// Distance or velocity and the limits lie so far apart that `f64` cannot hold the powers that
    /// the solution is made of: more than 100 decades in units of `A^3/J^2` or `A^2/J`.
    #[error("state, target and limits of axis {axis} lie too many orders of magnitude apart")]
    OutOfRange {
        /// Axis, counted from zero; 0 for a straight line, which is planned as one.
        axis: usize,
    },
}

/// The quantity that an error is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Quantity {
    /// Position of the state.
    Position,
    /// Velocity, or its limit.
    Velocity,
    /// Acceleration, or its limit.
    Acceleration,
    /// Jerk limit.
    Jerk,
    /// Target position.
    Target,
    /// Velocity of the target.
    TargetVelocity,
    /// Acceleration of the target.
    TargetAcceleration,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
            Self::Target => "target",
            Self::TargetVelocity => "target velocity",
            Self::TargetAcceleration => "target acceleration",
        })
    }
}

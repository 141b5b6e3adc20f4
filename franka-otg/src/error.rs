//! Errors of states, targets and limits.

use core::fmt;

/// Reason why the generator created no plan. The current motion continues.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A value in a state or target is not finite.
    #[error("{quantity} of axis {axis} is not finite")]
    NotFinite {
        /// The quantity that is not finite.
        quantity: Quantity,
        /// Number of the axis, from 1.
        axis: usize,
    },
    /// A limit is not positive and finite.
    #[error("{quantity} limit of axis {axis} is {value}, expected a positive finite number")]
    Limit {
        /// The limited quantity.
        quantity: Quantity,
        /// Number of the axis, from 1.
        axis: usize,
        /// The given limit.
        value: f64,
    },
    /// The limits do not allow the velocity and acceleration of the target. Either the acceleration
    /// exceeds its limit, or the velocity would exceed its limit shortly before or after the
    /// target.
    #[error(
        "the target of axis {axis} moves faster than the limits allow: expected |acceleration| \
         within its limit, and |velocity| + acceleration^2 / (2 jerk limit) within the velocity limit"
    )]
    TargetMotion {
        /// Number of the axis, from 1. It is 1 for a straight line, which is planned as one axis.
        axis: usize,
    },
    /// The distance, the velocity or a limit is too large or too small, so `f64` cannot represent
    /// the powers in the solution. In units of the acceleration and jerk limits, the bound is 100
    /// orders of magnitude.
    #[error(
        "the state, the target and the limits of axis {axis} differ by too many orders of magnitude \
         for a plan, expected similar magnitudes"
    )]
    OutOfRange {
        /// Number of the axis, from 1. It is 1 for a straight line, which is planned as one axis.
        axis: usize,
    },
}

/// Quantity to which an error refers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Quantity {
    /// Position of the state.
    Position,
    /// Velocity of the state, or its limit.
    Velocity,
    /// Acceleration of the state, or its limit.
    Acceleration,
    /// Jerk limit.
    Jerk,
    /// Position of the target.
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

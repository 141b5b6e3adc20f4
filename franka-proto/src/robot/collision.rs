//! Thresholds of contact and collision.

use crate::wire::{self, from_wire, to_wire};

/// Calls `$convert!` with the names of all thresholds.
macro_rules! for_thresholds {
    ($convert:ident) => {
        $convert!(
            lower_torque_thresholds_acceleration,
            upper_torque_thresholds_acceleration,
            lower_torque_thresholds_nominal,
            upper_torque_thresholds_nominal,
            lower_force_thresholds_acceleration,
            upper_force_thresholds_acceleration,
            lower_force_thresholds_nominal,
            upper_force_thresholds_nominal
        )
    };
}

/// Thresholds of contact (lower) and collision (upper), while accelerating and at constant velocity
/// (nominal).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CollisionBehavior {
    /// Contact, joint torques while accelerating `[N m]`.
    pub lower_torque_thresholds_acceleration: [f64; 7],
    /// Collision, joint torques while accelerating `[N m]`.
    pub upper_torque_thresholds_acceleration: [f64; 7],
    /// Contact, joint torques at constant velocity `[N m]`.
    pub lower_torque_thresholds_nominal: [f64; 7],
    /// Collision, joint torques at constant velocity `[N m]`.
    pub upper_torque_thresholds_nominal: [f64; 7],
    /// Contact, wrench while accelerating `[N, N m]`.
    pub lower_force_thresholds_acceleration: [f64; 6],
    /// Collision, wrench while accelerating `[N, N m]`.
    pub upper_force_thresholds_acceleration: [f64; 6],
    /// Contact, wrench at constant velocity `[N, N m]`.
    pub lower_force_thresholds_nominal: [f64; 6],
    /// Collision, wrench at constant velocity `[N, N m]`.
    pub upper_force_thresholds_nominal: [f64; 6],
}

impl CollisionBehavior {
    /// The same thresholds whether or not the arm accelerates.
    #[must_use]
    pub fn uniform(
        lower_torque: [f64; 7],
        upper_torque: [f64; 7],
        lower_force: [f64; 6],
        upper_force: [f64; 6],
    ) -> Self {
        Self {
            lower_torque_thresholds_acceleration: lower_torque,
            upper_torque_thresholds_acceleration: upper_torque,
            lower_torque_thresholds_nominal: lower_torque,
            upper_torque_thresholds_nominal: upper_torque,
            lower_force_thresholds_acceleration: lower_force,
            upper_force_thresholds_acceleration: upper_force,
            lower_force_thresholds_nominal: lower_force,
            upper_force_thresholds_nominal: upper_force,
        }
    }

    pub(super) fn to_wire(self) -> wire::service::SetCollisionBehavior {
        macro_rules! convert {
            ($($field:ident),*) => {
                wire::service::SetCollisionBehavior { $($field: to_wire(&self.$field),)* }
            };
        }
        for_thresholds!(convert)
    }

    pub(super) fn from_wire(wire: &wire::service::SetCollisionBehavior) -> Self {
        macro_rules! convert {
            ($($field:ident),*) => {
                Self { $($field: from_wire(&wire.$field),)* }
            };
        }
        for_thresholds!(convert)
    }
}

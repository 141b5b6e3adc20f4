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

/// Thresholds for contact (lower) and collision (upper), during acceleration and at constant
/// velocity (nominal).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CollisionBehavior {
    /// Contact threshold of the joint torques while accelerating `[N m]`.
    pub lower_torque_thresholds_acceleration: [f64; 7],
    /// Collision threshold of the joint torques while accelerating `[N m]`.
    pub upper_torque_thresholds_acceleration: [f64; 7],
    /// Contact threshold of the joint torques at constant velocity `[N m]`.
    pub lower_torque_thresholds_nominal: [f64; 7],
    /// Collision threshold of the joint torques at constant velocity `[N m]`.
    pub upper_torque_thresholds_nominal: [f64; 7],
    /// Contact threshold of the wrench while accelerating `[N, N m]`.
    pub lower_force_thresholds_acceleration: [f64; 6],
    /// Collision threshold of the wrench while accelerating `[N, N m]`.
    pub upper_force_thresholds_acceleration: [f64; 6],
    /// Contact threshold of the wrench at constant velocity `[N, N m]`.
    pub lower_force_thresholds_nominal: [f64; 6],
    /// Collision threshold of the wrench at constant velocity `[N, N m]`.
    pub upper_force_thresholds_nominal: [f64; 6],
}

impl CollisionBehavior {
    /// Returns thresholds that are the same during acceleration and during nominal motion.
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

    /// Returns thresholds at which a light push stops the robot: 10 N and 10 N m for contact and
    /// for collision, and twice these values while the arm accelerates. Use them for motions with
    /// the robot's own controllers. Compliant control exceeds them. The values come from the
    /// vendor's examples.
    #[must_use]
    pub fn careful() -> Self {
        Self {
            lower_torque_thresholds_acceleration: [20.0; 7],
            upper_torque_thresholds_acceleration: [20.0; 7],
            lower_force_thresholds_acceleration: [20.0; 6],
            upper_force_thresholds_acceleration: [20.0; 6],
            ..Self::uniform([10.0; 7], [10.0; 7], [10.0; 6], [10.0; 6])
        }
    }

    /// Returns thresholds with which a person can push an arm under compliant control. The contact
    /// threshold is 20 N and 20 N m, and the collision threshold is 60 N and 60 N m. This is more
    /// than the sum of the driver's default force limit and the apparent force of friction.
    #[must_use]
    pub fn compliant() -> Self {
        Self::uniform([20.0; 7], [60.0; 7], [20.0; 6], [60.0; 6])
    }

    /// Returns thresholds of 100 N and 100 N m, for tasks in which the arm presses on something.
    /// The values come from the vendor's examples of impedance control.
    #[must_use]
    pub fn insensitive() -> Self {
        Self::uniform([100.0; 7], [100.0; 7], [100.0; 6], [100.0; 6])
    }

    /// Returns the smallest force along an axis at which the robot stops itself, `[N]`.
    #[must_use]
    pub fn least_force(&self) -> f64 {
        let [moving, even] = [
            &self.upper_force_thresholds_acceleration,
            &self.upper_force_thresholds_nominal,
        ];
        let forces = moving[..3].iter().chain(&even[..3]);
        forces.copied().fold(f64::INFINITY, f64::min)
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

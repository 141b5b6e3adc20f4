//! The filters of a robot of protocol 5.

use crate::wire::service::SetFilters;

/// Cutoff frequencies of the robot's own low-pass filters, documented as 1 to 1000 Hz. A value of
/// 1000 disables a filter. Only protocol 5 has these filters. They are deprecated; filter in the
/// client instead.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Filters {
    /// Cutoff for commanded joint positions `[Hz]`.
    pub joint_position_filter_frequency: f64,
    /// Cutoff for commanded joint velocities `[Hz]`.
    pub joint_velocity_filter_frequency: f64,
    /// Cutoff for commanded poses `[Hz]`.
    pub cartesian_position_filter_frequency: f64,
    /// Cutoff for commanded twists `[Hz]`.
    pub cartesian_velocity_filter_frequency: f64,
    /// Cutoff of the controller's filter `[Hz]`.
    pub controller_filter_frequency: f64,
}

impl Filters {
    /// Returns filters that all have the same cutoff frequency `[Hz]`.
    #[must_use]
    pub fn uniform(frequency: f64) -> Self {
        Self {
            joint_position_filter_frequency: frequency,
            joint_velocity_filter_frequency: frequency,
            cartesian_position_filter_frequency: frequency,
            cartesian_velocity_filter_frequency: frequency,
            controller_filter_frequency: frequency,
        }
    }

    pub(super) fn to_wire(self) -> SetFilters {
        SetFilters {
            joint_position_filter_frequency: self.joint_position_filter_frequency.into(),
            joint_velocity_filter_frequency: self.joint_velocity_filter_frequency.into(),
            cartesian_position_filter_frequency: self.cartesian_position_filter_frequency.into(),
            cartesian_velocity_filter_frequency: self.cartesian_velocity_filter_frequency.into(),
            controller_filter_frequency: self.controller_filter_frequency.into(),
        }
    }

    pub(super) fn from_wire(wire: &SetFilters) -> Self {
        Self {
            joint_position_filter_frequency: wire.joint_position_filter_frequency.get(),
            joint_velocity_filter_frequency: wire.joint_velocity_filter_frequency.get(),
            cartesian_position_filter_frequency: wire.cartesian_position_filter_frequency.get(),
            cartesian_velocity_filter_frequency: wire.cartesian_velocity_filter_frequency.get(),
            controller_filter_frequency: wire.controller_filter_frequency.get(),
        }
    }
}

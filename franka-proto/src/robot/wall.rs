//! The virtual walls of a robot of protocol 5.

use crate::wire::service::CartesianLimit;
use crate::wire::{from_wire, to_wire};

/// A virtual wall: a cuboid that the robot must not leave, configured in Desk. Protocol 5 only.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VirtualWall {
    /// Corner of the cuboid, in the cuboid's frame `[m]`.
    pub object_world_size: [f64; 3],
    /// Pose of the cuboid in the base frame, column-major `[m]` (libfranka's `p_frame`).
    pub object_frame: [f64; 16],
    /// True if the wall is active.
    pub object_activation: bool,
}

impl VirtualWall {
    pub(super) fn to_wire(self, status: u8) -> CartesianLimit {
        CartesianLimit {
            status,
            object_world_size: to_wire(&self.object_world_size),
            object_frame: to_wire(&self.object_frame),
            object_activation: u8::from(self.object_activation),
        }
    }

    pub(super) fn from_wire(wire: &CartesianLimit) -> Self {
        Self {
            object_world_size: from_wire(&wire.object_world_size),
            object_frame: from_wire(&wire.object_frame),
            object_activation: wire.object_activation != 0,
        }
    }
}

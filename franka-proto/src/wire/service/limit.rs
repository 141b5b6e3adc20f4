//! The virtual walls of protocol 5.

use zerocopy::byteorder::little_endian::I32;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

use crate::wire::F64;

/// `GetCartesianLimit::Request`, protocol 5 only.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct GetCartesianLimit {
    /// Number of the wall.
    pub id: I32,
}

/// `GetCartesianLimit::Response`, protocol 5 only.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct CartesianLimit {
    /// Status of the request. The other fields are valid only after a success.
    pub status: u8,
    /// Corner of the cuboid in the cuboid's frame `[m]`.
    pub object_world_size: [F64; 3],
    /// Pose of the cuboid in the base frame, column-major `[m]`.
    pub object_frame: [F64; 16],
    /// Non-zero if the wall is active.
    pub object_activation: u8,
}

assert_layout!(GetCartesianLimit, size: 4, { id: 0 });
assert_layout!(CartesianLimit, size: 154, {
    status: 0, object_world_size: 1, object_frame: 25, object_activation: 153,
});

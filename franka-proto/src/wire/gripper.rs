//! The structs of the Franka Hand, protocol 3: payloads of its requests, and its datagram.

use zerocopy::byteorder::little_endian::{U16, U32};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

use super::F64;

/// Payload of a grasp request, `Grasp::Request`.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct Grasp {
    /// Width of the object `[m]`.
    pub width: F64,
    /// Tolerances of the final finger distance.
    pub epsilon: GraspEpsilon,
    /// Speed of the fingers `[m/s]`.
    pub speed: F64,
    /// Force of the grasp `[N]`.
    pub force: F64,
}

/// Tolerances of a grasp, `Grasp::GraspEpsilon`.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct GraspEpsilon {
    /// Tolerance below the width of the object `[m]`.
    pub inner: F64,
    /// Tolerance above the width of the object `[m]`.
    pub outer: F64,
}

/// Payload of a request to move the fingers, `Move::Request`.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct Move {
    /// Target width `[m]`.
    pub width: F64,
    /// Speed of the fingers `[m/s]`.
    pub speed: F64,
}

/// `GripperState`, the datagram of the hand.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct GripperState {
    /// Counter of milliseconds.
    pub message_id: U32,
    /// Distance between the fingers `[m]`.
    pub width: F64,
    /// Distance between the fully open fingers `[m]`, measured during homing.
    pub max_width: F64,
    /// Non-zero if the hand holds an object.
    pub is_grasped: u8,
    /// Temperature of the hand `[deg C]`.
    pub temperature: U16,
}

assert_layout!(Grasp, size: 40, {
    width: 0, epsilon.inner: 8, epsilon.outer: 16, speed: 24, force: 32,
});
assert_layout!(GraspEpsilon, size: 16, { inner: 0, outer: 8 });
assert_layout!(Move, size: 16, { width: 0, speed: 8 });
assert_layout!(GripperState, size: 23, {
    message_id: 0, width: 4, max_width: 12, is_grasped: 20, temperature: 21,
});

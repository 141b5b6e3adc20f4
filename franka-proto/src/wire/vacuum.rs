//! The structs of the vacuum gripper, protocol 1: payloads of its requests, and its datagram.

use zerocopy::byteorder::little_endian::{I32, I64, U32};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

/// Payload of a request to pick up an object, `Vacuum::Request`.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct Vacuum {
    /// Target vacuum, in units of 10 mbar.
    pub vacuum: u8,
    /// Production set-up profile, 0 to 3.
    pub profile: u8,
    /// Time limit `[ms]`.
    pub timeout: I64,
}

/// Payload of a request to drop the object, `DropOff::Request`.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct DropOff {
    /// Time limit `[ms]`.
    pub timeout: I64,
}

/// `VacuumGripperState`, the datagram of the gripper.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct VacuumGripperState {
    /// Counter of milliseconds.
    pub message_id: U32,
    /// Non-zero if the vacuum is within its range.
    pub in_control_range: u8,
    /// Non-zero if the object has been dropped off.
    pub part_detached: u8,
    /// Non-zero if the gripper holds an object.
    pub part_present: u8,
    /// Status light of the device.
    pub device_status: u8,
    /// Power of the pump `[%]`.
    pub actual_power: I32,
    /// Vacuum `[mbar]`.
    pub vacuum: I32,
}

assert_layout!(Vacuum, size: 10, { vacuum: 0, profile: 1, timeout: 2 });
assert_layout!(DropOff, size: 8, { timeout: 0 });
assert_layout!(VacuumGripperState, size: 16, {
    message_id: 0, in_control_range: 4, part_detached: 5, part_present: 6, device_status: 7,
    actual_power: 8, vacuum: 12,
});

//! The header of every message on a TCP stream.

use zerocopy::byteorder::little_endian::{U16, U32};
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

/// Header of a message: `CommandHeader` of the vendor's `service_types.h`, for the robot and for
/// its end effectors.
///
/// `N` is the type of the command's number: [`U32`] for the robot, [`U16`] for the Hand and the
/// vacuum gripper.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct CommandHeader<N> {
    /// Number of the command, which depends on the version.
    pub command: N,
    /// Id of the request.
    pub command_id: U32,
    /// Length of the message in bytes, including the header.
    pub size: U32,
}

/// Type of a command's number in a header. Its width depends on the service.
pub trait CommandNumber:
    Copy + FromBytes + IntoBytes + Immutable + KnownLayout + Unaligned + sealed::Sealed
{
    /// Returns the number as `u32`.
    fn get(self) -> u32;

    /// Converts a number to the wire. Higher bits are cut off, but no service has such large
    /// numbers.
    fn new(number: u32) -> Self;
}

impl CommandNumber for U32 {
    fn get(self) -> u32 {
        U32::get(self)
    }

    fn new(number: u32) -> Self {
        U32::new(number)
    }
}

impl CommandNumber for U16 {
    fn get(self) -> u32 {
        U16::get(self).into()
    }

    fn new(number: u32) -> Self {
        U16::new(number as u16)
    }
}

mod sealed {
    use super::{U16, U32};

    pub trait Sealed {}
    impl Sealed for U16 {}
    impl Sealed for U32 {}
}

assert_layout!(CommandHeader<U32>, size: 12, { command: 0, command_id: 4, size: 8 });
assert_layout!(CommandHeader<U16>, size: 10, { command: 0, command_id: 2, size: 6 });

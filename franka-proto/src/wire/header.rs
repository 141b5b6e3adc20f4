//! What precedes every message on the robot's TCP stream.

use zerocopy::byteorder::little_endian::U32;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

/// `CommandHeader` of `research_interface/robot/service_types.h`, protocols 5 and 10.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct CommandHeader {
    /// Number of the command, by version.
    pub command: U32,
    /// Counter of the client's requests.
    pub command_id: U32,
    /// Length of the message in bytes, with this header.
    pub size: U32,
}

assert_layout!(CommandHeader, size: 12, { command: 0, command_id: 4, size: 8 });

//! The wire format of the handshake. See `client::session` and `server::session` for its rules.

use zerocopy::byteorder::little_endian::U16;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

/// `Connect::Request`, the first message of a client.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct ConnectRequest {
    /// Protocol version of the client.
    pub version: U16,
    /// UDP port on which the client expects states.
    pub udp_port: U16,
}

/// `Connect::Response`. `S` is the status: a byte for the robot, [`U16`] for its end effectors.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct ConnectResponse<S> {
    /// Result of the version check.
    pub status: S,
    /// Protocol version of the device.
    pub version: U16,
}

assert_layout!(ConnectRequest, size: 4, { version: 0, udp_port: 2 });
assert_layout!(ConnectResponse<u8>, size: 3, { status: 0, version: 1 });
assert_layout!(ConnectResponse<U16>, size: 4, { status: 0, version: 2 });

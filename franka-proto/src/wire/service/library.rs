//! The model library of protocol 5. Its reply is a status and the bytes of a file.

use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

/// `LoadModelLibrary::Request`, protocol 5 only.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct LoadModelLibrary {
    /// Processor of the client.
    pub architecture: u8,
    /// Operating system of the client.
    pub system: u8,
}

assert_layout!(LoadModelLibrary, size: 2, { architecture: 0, system: 1 });

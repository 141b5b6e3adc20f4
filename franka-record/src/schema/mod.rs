//! The messages of a recording and their descriptors, generated from `schemas/` by
//! `cargo xtask schemas`.

mod arrays;
mod cycles;
mod events;
mod grippers;
mod numbers;
mod tool;
mod topic;

pub use prost::Message;
pub(crate) use topic::{CASSETTE_METADATA, METADATA, ROBOT_METADATA, Topic};

/// Foxglove's well-known messages that recordings use.
#[allow(missing_docs, reason = "documented in the definitions")]
pub mod foxglove {
    include!("generated/foxglove.rs");
}

/// Messages that this project defines.
#[allow(missing_docs, non_snake_case, reason = "documented in the definitions")]
pub mod franka {
    include!("generated/franka.rs");
}

/// The descriptors of all messages: a `google.protobuf.FileDescriptorSet`, as in a schema record of
/// an MCAP file.
pub const DESCRIPTORS: &[u8] = include_bytes!("generated/descriptors.bin");

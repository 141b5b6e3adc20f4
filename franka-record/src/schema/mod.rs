//! The messages of a recording, generated from `schemas/`, and their descriptors.

mod arrays;
mod cycles;
mod events;
mod grippers;
mod numbers;
mod tool;
mod topic;

pub use prost::Message;
pub(crate) use topic::{METADATA, ROBOT_METADATA, Topic};

/// Foxglove's well-known messages, as far as a recording has them.
#[allow(missing_docs, reason = "documented in the definitions")]
pub mod foxglove {
    include!(concat!(env!("OUT_DIR"), "/foxglove.rs"));
}

/// The messages of this project.
#[allow(missing_docs, non_snake_case, reason = "documented in the definitions")]
pub mod franka {
    include!(concat!(env!("OUT_DIR"), "/franka.rs"));
}

/// The descriptors of all messages: a `google.protobuf.FileDescriptorSet`, as a schema record of an
/// MCAP file holds it.
pub const DESCRIPTORS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/descriptors.bin"));

//! The protocol through its public interface.
//!
//! | module | content |
//! |---|---|
//! | [`any_bytes`] | the fuzz targets on mutated golden messages |
//! | [`end_effectors`] | sessions and states of the Hand and of the vacuum gripper |
//! | [`no_std`] | the crate uses neither the standard library nor an allocator |
//! | [`pair`] | a client session and a server session, through their bytes |
//! | [`properties`] | properties that hold for any bytes and any values |
//! | [`serde_forms`] | the serialised forms |
//! | [`texts`] | libfranka's texts, byte for byte |

mod any_bytes;
mod end_effectors;
mod no_std;
mod pair;
mod properties;
mod serde_forms;
mod texts;

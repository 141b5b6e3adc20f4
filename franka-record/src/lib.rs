//! Flight recorder for Franka robots. It records every cycle in an MCAP file, explains reflexes,
//! and replays sessions.

#![cfg_attr(docsrs, feature(doc_cfg))]

// Tests in modules share sources with the tests outside `src`.
#[cfg(test)]
extern crate self as franka_record;

pub mod cassette;
pub mod control_log;
mod cycle;
mod episodes;
pub mod event;
pub mod explain;
pub mod export;
mod recorded_model;
pub mod recorder;
pub mod recording;
pub mod replay;
mod sample;
pub mod schema;

pub use cycle::{Cycle, HostTime};
pub use episodes::{Episode, EpisodeError, Samples};
pub use event::{Event, EventKind, GripperState};
pub use recorded_model::{ModelFallback, RecordedModel};
pub use recorder::Recorder;
pub use recording::Recording;
pub use sample::Sample;

// Compiles the program in the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

//! Flight recorder for Franka robots: every cycle in an MCAP file, every reflex explained, every
//! session replayed.

#[cfg(feature = "export")]
pub mod export;
mod sample;

pub use sample::Sample;

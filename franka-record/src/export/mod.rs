//! Recordings as tables and datasets of other programs.
//!
//! * `parquet`: tables as Parquet files (feature `export`).
//! * [`lerobot`]: episodes for training (feature `export`).

mod error;
#[cfg(feature = "export")]
pub mod lerobot;
#[cfg(feature = "export")]
mod parquet;

pub use error::ExportError;

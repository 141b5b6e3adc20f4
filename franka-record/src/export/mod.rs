//! Recordings as tables and datasets of other programs (feature `export`).
//!
//! * `parquet`: tables as Parquet files.
//! * [`lerobot`]: episodes for training.

mod error;
pub mod lerobot;
mod parquet;

pub use error::ExportError;

//! Recordings written to files and read back.

mod any_bytes;
mod damaged;
mod explaining;
mod exporting;
mod feed;
mod files;
mod live;
mod memory;
mod reading;
mod standard;
mod viewers;

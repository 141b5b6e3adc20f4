//! Recordings written to files and read back.

mod any_bytes;
mod damaged;
mod feed;
mod files;
mod reading;
mod standard;
mod viewers;

//! Recordings written to files and read back.

mod damaged;
mod feed;
mod files;
mod reading;

//! Recordings written to files and read back.

mod feed;
mod files;

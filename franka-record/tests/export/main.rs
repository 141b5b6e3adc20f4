//! Exports of made-up motions, read back with a reader of the format.

mod lerobot;
mod tables;

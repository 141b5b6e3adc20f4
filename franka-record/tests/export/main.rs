//! Exports of synthetic motions, read with a reader of the format.

mod lerobot;
mod tables;

//! The time from one command to the next.

/// Time from one command to the next, in seconds: one nominal cycle of a robot with 1 kHz control.
///
/// The generator advances by this time per command, even if a state was lost. If one command
/// contained two milliseconds of motion, the robot would see twice the velocity.
pub const CYCLE: f64 = 1e-3;

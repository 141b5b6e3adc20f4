//! The time from one command to the next.

/// Time from one command to the next, in seconds: one nominal cycle of a robot with 1 kHz control.
///
/// The generator advances by this time per command, regardless of the time between two states. Two
/// milliseconds of motion in one command would be a doubled velocity for the robot.
pub const CYCLE: f64 = 1e-3;

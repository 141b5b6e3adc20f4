//! The time from one command to the next.

/// Seconds from one command to the next: one nominal cycle of a robot with 1 kHz control.
///
/// The generator advances by this per command, regardless of the time between two states: two
/// milliseconds' motion in one command would be a doubled velocity for the robot.
pub const CYCLE: f64 = 1e-3;

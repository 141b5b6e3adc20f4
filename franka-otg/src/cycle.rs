//! The time from one command to the next.

/// Seconds from one command to the next: one nominal cycle of a robot that is commanded at 1 kHz.
///
/// The generator advances by this per command, whatever the time between two states: to the robot,
/// two milliseconds' motion in one command is a doubled velocity.
pub const CYCLE: f64 = 1e-3;

//! What the motor of a hand is told.

/// Fingers on their way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FingerDrive {
    /// Where to: distance of the fingers, `[m]`.
    pub width: f64,
    /// How fast the width may change, `[m/s]`.
    pub speed: f64,
    /// How strongly each finger may push, `[N]`.
    pub force: f64,
}

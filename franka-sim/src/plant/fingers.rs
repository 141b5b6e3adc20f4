//! The motor of a hand: its setpoint and its limits.

/// The setpoint of the motor of a hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FingerDrive {
    /// Where to: distance of the fingers, `[m]`.
    pub width: f64,
    /// How fast the width may change, `[m/s]`.
    pub speed: f64,
    /// How strongly each finger may push, `[N]`.
    pub force: f64,
}

impl FingerDrive {
    /// Distance of the open fingers `[m]`. Source: Franka Hand, technical data.
    pub const STROKE: f64 = 0.08;

    /// The fastest that the width changes `[m/s]`: 0.05 for each finger. Source: Franka Hand,
    /// technical data.
    pub const MAX_SPEED: f64 = 0.1;

    /// The least and the largest force of a squeeze `[N]`. The least is reported by users of real
    /// hands, whatever they ask for; the largest is that of the technical data.
    pub const FORCE: [f64; 2] = [30.0, 140.0];
}

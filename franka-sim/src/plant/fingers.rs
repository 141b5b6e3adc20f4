//! The motor of a hand: its setpoint and its limits.

/// The setpoint of the motor of a hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FingerDrive {
    /// Target distance of the fingers, `[m]`.
    pub width: f64,
    /// Largest speed of the width, `[m/s]`.
    pub speed: f64,
    /// Largest force of each finger, `[N]`.
    pub force: f64,
}

impl FingerDrive {
    /// Distance of the open fingers `[m]`. Source: Franka Hand, technical data.
    pub const STROKE: f64 = 0.08;

    /// The highest speed of the width `[m/s]`: 0.05 for each finger. Source: Franka Hand, technical
    /// data.
    pub const MAX_SPEED: f64 = 0.1;

    /// Smallest and largest force of a grasp `[N]`. Users report that real hands apply the smallest
    /// force if a request is below it. The largest force is from the technical data.
    pub const FORCE: [f64; 2] = [30.0, 140.0];
}

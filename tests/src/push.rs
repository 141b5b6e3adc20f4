//! The path of a hand that pushes an arm while the arm holds its pose.

/// Velocity of the hand, `[m/s]`.
pub const PACE: f64 = 0.25;

/// Time in which the hand accelerates to [`PACE`], `[s]`.
pub const START: f64 = 0.1;

/// Duration of the push, `[ms]`: over 16 cm.
pub const PUSH: u64 = 700;

/// Stiffness of the hand, `[N/m]`.
pub const STIFFNESS: f64 = 5000.0;

/// The distance that the hand has moved after `t` seconds, `[m]`.
pub fn hand(t: f64) -> f64 {
    if t < START {
        let turn = core::f64::consts::PI / START;
        PACE / 2.0 * (t - (turn * t).sin() / turn)
    } else {
        PACE * (t - START / 2.0)
    }
}

//! A hand that pushes an arm which is to stay where it is.

/// Its pace, `[m/s]`.
pub const PACE: f64 = 0.25;

/// How long it takes to come to that pace, `[s]`.
pub const START: f64 = 0.1;

/// How long it pushes, `[ms]`: over 16 cm.
pub const PUSH: u64 = 700;

/// Stiffness of the hand, `[N/m]`.
pub const STIFFNESS: f64 = 5000.0;

/// Where the hand is after so many seconds, `[m]`.
pub fn hand(t: f64) -> f64 {
    if t < START {
        let turn = core::f64::consts::PI / START;
        PACE / 2.0 * (t - (turn * t).sin() / turn)
    } else {
        PACE * (t - START / 2.0)
    }
}

//! What the external torques read while nothing touches.

use crate::JointVector;
use crate::scalar::tanh;

/// A running baseline of the external torques, to be taken off them.
///
/// Per joint it is an offset, which follows slowly what the torques read while nothing touches, and
/// a friction, which changes its sign with the velocity. Torques that leave the baseline by more
/// than a gate are a contact: until they are back, and for a while after, nothing is learned.
///
/// The first state counts as free of contact. A push that grows by less than the gate over the time
/// constant (0.4 N·m/s at joint 1) is taken for drift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tare {
    offset: JointVector,
    friction: JointVector,
    /// How long it has learned, `[s]`, at most the time constant.
    learned: f64,
    /// How long nothing has touched, `[s]`.
    free: f64,
    started: bool,
}

impl Tare {
    /// Before the first state.
    pub fn new() -> Self {
        Self {
            offset: JointVector::zeros(),
            friction: JointVector::zeros(),
            learned: 0.0,
            free: QUIET,
            started: false,
        }
    }

    /// Takes in the torques of one state, `[N·m]`, its joint velocities, `[rad/s]`, and the time
    /// since the one before, `[s]`; returns the torques less the baseline. Non-finite numbers are
    /// returned as they come and change nothing.
    pub fn update(&mut self, torque: &JointVector, dq: &JointVector, dt: f64) -> JointVector {
        let usable = torque.iter().chain(dq).all(|x| x.is_finite());
        if usable && !self.started {
            self.started = true;
            self.offset = *torque;
        }
        let direction = dq.map(|v| tanh(v / SLIDING));
        let left = torque - self.offset - self.friction.component_mul(&direction);
        if !usable || dt.is_nan() || dt <= 0.0 {
            return left;
        }
        if (0..7).any(|i| left[i].abs() > GATE[i]) {
            self.free = 0.0;
            return left;
        }
        self.free += dt;
        if self.free >= QUIET {
            self.learned = (self.learned + dt).min(TIME_CONSTANT);
            let rate = (dt / self.learned).min(1.0);
            self.offset += left * rate;
            let moved = left.component_mul(&direction);
            self.friction += moved * (dt / TIME_CONSTANT).min(1.0);
        }
        left
    }

    /// Whether the last state was taken for one of a contact, or came shortly after one.
    pub fn is_touched(&self) -> bool {
        self.free < QUIET
    }

    /// Over how long the baseline was learned, `[s]`, at most its time constant of 1.5 s.
    pub fn learned(&self) -> f64 {
        self.learned
    }
}

impl Default for Tare {
    fn default() -> Self {
        Self::new()
    }
}

/// Of the offset, `[s]`: longer than a push takes to come, shorter than a motion takes to another
/// posture, where the arm's model has another error.
const TIME_CONSTANT: f64 = 1.5;

/// How long after a contact the baseline stays as it is, `[s]`.
const QUIET: f64 = 0.3;

/// The velocity beyond which friction is that of sliding, `[rad/s]`.
const SLIDING: f64 = 0.02;

/// Per joint, `[N·m]`: what changes of friction and posture do to the torques of an arm that
/// nothing touches. FER at one posture before and after a motion: up to 0.6 N·m on joint 2.
const GATE: [f64; 7] = [0.6, 0.75, 0.6, 0.9, 0.6, 0.4, 0.35];

//! Baseline of the external torques without contact.

use crate::JointVector;
use crate::scalar::tanh;

/// A running baseline of the external torques: their values without contact.
///
/// The baseline of a joint is an offset plus a friction torque. The offset slowly follows the
/// torques measured without contact, and the friction torque has the sign of the velocity. Torques
/// that deviate from the baseline by more than a threshold indicate a contact. During a contact,
/// and for a short time afterwards, the baseline does not change.
///
/// The tare assumes that the first state has no contact. It treats a push that grows by less than
/// the threshold per time constant (0.4 N·m/s at joint 1) as drift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tare {
    offset: JointVector,
    friction: JointVector,
    /// Time during which the baseline has learned, `[s]`, at most the time constant.
    learned: f64,
    /// Time since the last contact, `[s]`.
    free: f64,
    started: bool,
}

impl Tare {
    /// Creates a baseline without data.
    pub fn new() -> Self {
        Self {
            offset: JointVector::zeros(),
            friction: JointVector::zeros(),
            learned: 0.0,
            free: QUIET,
            started: false,
        }
    }

    /// Updates the baseline with the torques of one state, `[N·m]`, its joint velocities,
    /// `[rad/s]`, and the time since the previous state, `[s]`. Returns the torques minus the
    /// baseline. If a torque or velocity is not finite, the torques are returned unchanged, and the
    /// baseline stays unchanged.
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

    /// Returns true if the last state indicated a contact, or came shortly after a contact.
    pub fn is_touched(&self) -> bool {
        self.free < QUIET
    }

    /// Returns the time during which the baseline has learned, `[s]`, at most its time constant of
    /// 1.5 s.
    pub fn learned(&self) -> f64 {
        self.learned
    }
}

impl Default for Tare {
    fn default() -> Self {
        Self::new()
    }
}

/// Time constant of the offset, `[s]`. It is longer than the onset of a push. It is shorter than a
/// motion to another posture, at which the arm's model has another error.
const TIME_CONSTANT: f64 = 1.5;

/// Time after a contact in which the baseline stays frozen, `[s]`.
const QUIET: f64 = 0.3;

/// Velocity above which friction is sliding friction, `[rad/s]`.
const SLIDING: f64 = 0.02;

/// Threshold per joint, `[N·m]`. It exceeds the effect of changing friction and posture on an arm
/// without contact. An FER at one posture before and after a motion showed up to 0.6 N·m on joint
/// 2.
const GATE: [f64; 7] = [0.6, 0.75, 0.6, 0.9, 0.6, 0.4, 0.35];

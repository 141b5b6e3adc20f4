//! Baseline of the external torques without contact.

use crate::JointVector;
use crate::scalar::tanh;

/// A running baseline of the external torques: their values without contact.
///
/// Each joint has an offset, which slowly follows the torques measured without contact, and a
/// friction, which changes its sign with the velocity. Torques that deviate from the baseline by
/// more than a threshold indicate a contact. Until they return, and for a short time afterwards,
/// the baseline does not change.
///
/// The first state counts as free of contact. A push that grows by less than the threshold per time
/// constant (0.4 N·m/s at joint 1) is treated as drift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tare {
    offset: JointVector,
    friction: JointVector,
    /// Learning time, `[s]`, at most the time constant.
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
    /// baseline. Torques that are not finite are returned unchanged and do not change the baseline.
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

    /// True if the last state was classified as a contact, or came shortly after one.
    pub fn is_touched(&self) -> bool {
        self.free < QUIET
    }

    /// Learning time of the baseline, `[s]`, at most its time constant of 1.5 s.
    pub fn learned(&self) -> f64 {
        self.learned
    }
}

impl Default for Tare {
    fn default() -> Self {
        Self::new()
    }
}

/// Time constant of the offset, `[s]`: longer than the onset of a push, shorter than a motion to
/// another posture with another error of the arm's model.
const TIME_CONSTANT: f64 = 1.5;

/// Time after a contact in which the baseline stays frozen, `[s]`.
const QUIET: f64 = 0.3;

/// Velocity above which friction is sliding friction, `[rad/s]`.
const SLIDING: f64 = 0.02;

/// Threshold per joint, `[N·m]`, above the effect of changing friction and posture on an arm
/// without contact. An FER at one posture before and after a motion showed up to 0.6 N·m on joint
/// 2.
const GATE: [f64; 7] = [0.6, 0.75, 0.6, 0.9, 0.6, 0.4, 0.35];

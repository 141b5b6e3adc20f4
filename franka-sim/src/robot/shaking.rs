//! Detection of oscillating joints, for the error `instability_detected`.

use franka_model::JointVector;

use crate::config::Instability;

/// Counts the reversals of each joint's velocity.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shaking {
    joints: [Reversals; 7],
}

/// Reversals of one joint in the last 128 milliseconds, with the newest in the lowest bit.
#[derive(Debug, Clone, Copy, Default)]
struct Reversals {
    history: u128,
    /// Side of the last large velocity: −1, 0 or 1.
    side: i8,
}

impl Shaking {
    pub(super) fn new() -> Self {
        Self {
            joints: [Reversals::default(); 7],
        }
    }

    /// Records the velocities of a millisecond, `[rad/s]`. Returns true if a joint shakes.
    pub(super) fn is_seen(&mut self, dq: &JointVector, what: &Instability) -> bool {
        let window = u128::MAX >> (128 - what.window.clamp(1, 128));
        let mut shakes = false;
        for (joint, dq) in self.joints.iter_mut().zip(dq.iter()) {
            let side = if dq.abs() < what.velocity {
                joint.side
            } else if *dq > 0.0 {
                1
            } else {
                -1
            };
            let reversed = joint.side != 0 && side != joint.side;
            joint.side = side;
            joint.history = joint.history << 1 | u128::from(reversed);
            shakes |= (joint.history & window).count_ones() >= what.reversals.max(1);
        }
        shakes
    }
}

#[cfg(test)]
mod tests {
    use franka_model::CYCLE;

    use super::*;

    /// Returns the number of milliseconds until the detection of a joint that swings with this
    /// frequency, `[Hz]`.
    fn swing(frequency: f64, velocity: f64) -> Option<usize> {
        let mut shaking = Shaking::new();
        (0..2000).find(|k| {
            let phase = core::f64::consts::TAU * frequency * (*k as f64) * CYCLE;
            let mut dq = JointVector::zeros();
            dq[4] = velocity * phase.sin();
            shaking.is_seen(&dq, &Instability::default())
        })
    }

    #[test]
    fn wide_fast_swings_are_found_and_slow_or_narrow_ones_are_not() {
        assert!(swing(60.0, 0.5).is_some_and(|after| after < 100));
        assert_eq!(swing(20.0, 0.5), None);
        assert_eq!(swing(60.0, 0.1), None);
    }
}

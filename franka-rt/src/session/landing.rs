//! When a goal has been reached, and how the arm is let go afterwards.

use core::time::Duration;

use franka_model::{JointVector, rotation};
use nalgebra::Isometry3;

use crate::session::{Settlement, Tolerance};

/// Joint velocity below which the arm counts as resting, `[rad/s]`.
pub(super) const REST_VELOCITY: f64 = 0.01;

/// Time that the arm gets to settle once its reference has arrived.
pub const SETTLE_TIMEOUT: Duration = Duration::from_secs(5);

/// Cycles that the arm has to stay at the target and at rest: a swing through the target does not
/// count.
const HOLD_AT_TARGET: u64 = 250;

/// The same for coming to rest without a target.
const HOLD_AT_REST: u64 = 100;

/// Cycles over which the spring is let go.
const RELEASE: u32 = 100;

/// Time after which the motion is finished even if the joints do not rest.
pub const RELEASE_TIMEOUT: Duration = Duration::from_secs(5);

/// Distance of the measured end effector from its target.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PoseError {
    /// Distance, `[m]`.
    pub translation: f64,
    /// Angle, `[rad]`.
    pub rotation: f64,
}

impl PoseError {
    /// How far `pose` is from `target`.
    pub fn between(pose: &Isometry3<f64>, target: &Isometry3<f64>) -> Self {
        Self {
            translation: (pose.translation.vector - target.translation.vector).norm(),
            rotation: rotation::error(&target.rotation, &pose.rotation).norm(),
        }
    }

    fn within(&self, tolerance: &Tolerance) -> bool {
        self.translation <= tolerance.translation && self.rotation <= tolerance.rotation
    }
}

/// Judges, cycle by cycle, whether the arm has settled.
#[derive(Debug)]
pub(super) struct Landing {
    target: Option<Isometry3<f64>>,
    tolerance: Tolerance,
    cycles: u64,
    held: u64,
}

pub(super) enum Verdict {
    Settling,
    /// How it settled, and how many cycles ago.
    Settled(Settlement, u64),
}

impl Landing {
    /// For a target of the end effector; without one, coming to rest is enough.
    pub(super) fn new(target: Option<Isometry3<f64>>, tolerance: Tolerance) -> Self {
        Self {
            target,
            tolerance,
            cycles: 0,
            held: 0,
        }
    }

    pub(super) fn judge(&mut self, measured: &Isometry3<f64>, at_rest: bool) -> Verdict {
        let error = self
            .target
            .map(|target| PoseError::between(measured, &target));
        let there = at_rest && error.is_none_or(|error| error.within(&self.tolerance));
        self.cycles += 1;
        self.held = if there { self.held + 1 } else { 0 };
        let settlement = match error {
            None if self.held >= HOLD_AT_REST => Settlement::AtRest,
            Some(error) if self.held >= HOLD_AT_TARGET => Settlement::Arrived(error),
            _ if u128::from(self.cycles) < SETTLE_TIMEOUT.as_millis() => return Verdict::Settling,
            // An arm that does not rest after all this time is being moved from outside; the
            // reference rests.
            None => Settlement::AtRest,
            Some(error) => Settlement::TargetNotReached(error),
        };
        Verdict::Settled(settlement, self.held)
    }
}

/// Releases the spring: the reference moves to where the arm was, so that the motion ends without a
/// step in torque. An arm whose load is not what was declared still hangs on the spring then, and
/// does not fall.
#[derive(Debug)]
pub(super) struct Release {
    arm: JointVector,
    length: JointVector,
    cycle: u32,
}

impl Release {
    /// For a spring that reaches from the arm at `arm` to the reference, both `[rad]`.
    pub(super) fn new(arm: JointVector, reference: &JointVector) -> Self {
        Self {
            arm,
            length: reference - arm,
            cycle: 0,
        }
    }

    /// The reference in this cycle.
    pub(super) fn reference(&mut self) -> JointVector {
        self.cycle += 1;
        let remaining = RELEASE.saturating_sub(self.cycle);
        self.arm + self.length * (f64::from(remaining) / f64::from(RELEASE))
    }

    pub(super) fn is_over(&self, at_rest: bool) -> bool {
        self.cycle >= RELEASE && at_rest || u128::from(self.cycle) >= RELEASE_TIMEOUT.as_millis()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judge_for(
        landing: &mut Landing,
        cycles: u64,
        pose: &Isometry3<f64>,
        at_rest: bool,
    ) -> Option<Settlement> {
        for _ in 0..cycles {
            if let Verdict::Settled(settlement, _) = landing.judge(pose, at_rest) {
                return Some(settlement);
            }
        }
        None
    }

    #[test]
    fn a_swing_through_the_target_is_no_arrival() {
        let mut landing = Landing::new(Some(Isometry3::identity()), Tolerance::default());
        let there = Isometry3::translation(0.0, 0.0, 0.9e-3);
        let away = Isometry3::translation(0.0, 0.0, 1.1e-3);
        assert_eq!(
            judge_for(&mut landing, HOLD_AT_TARGET - 1, &there, true),
            None
        );
        assert_eq!(judge_for(&mut landing, 1, &away, true), None);
        assert_eq!(judge_for(&mut landing, 1000, &there, false), None);
        let arrived = judge_for(&mut landing, HOLD_AT_TARGET, &there, true);
        assert!(matches!(arrived, Some(Settlement::Arrived(error)) if error.translation == 0.9e-3));
    }

    #[test]
    fn an_arm_held_short_of_its_target_is_reported_after_the_timeout() {
        let mut landing = Landing::new(Some(Isometry3::identity()), Tolerance::default());
        let away = Isometry3::translation(0.02, 0.0, 0.0);
        let cycles = SETTLE_TIMEOUT.as_millis() as u64;
        assert_eq!(judge_for(&mut landing, cycles - 1, &away, true), None);
        let short = judge_for(&mut landing, 1, &away, true);
        assert!(
            matches!(short, Some(Settlement::TargetNotReached(error)) if error.translation == 0.02)
        );
    }

    #[test]
    fn the_spring_is_let_go_evenly_and_only_at_rest() {
        let arm = JointVector::repeat(-0.5);
        let mut release = Release::new(arm, &JointVector::repeat(-0.49));
        let mut last = 0.01;
        for _ in 0..RELEASE {
            assert!(!release.is_over(true));
            let length = release.reference()[0] - arm[0];
            assert!((last - length - 1e-4).abs() < 1e-12);
            last = length;
        }
        assert_eq!(release.reference(), arm);
        assert!(release.is_over(true));
        assert!(!release.is_over(false));
    }
}

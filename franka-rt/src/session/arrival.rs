//! Arrival at a goal, and release of the arm after it.

use core::time::Duration;

use franka_model::{JointVector, rotation};
use nalgebra::Isometry3;

use crate::session::{LimitedTorque, Settlement, Tolerance};

/// Joint velocity below which the arm counts as resting, `[rad/s]`.
pub(crate) const REST_VELOCITY: f64 = 0.01;

/// Conditions under which an arm counts as settled at its target, after its reference has arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settling {
    /// Time for which the arm must stay within the tolerance and at rest, in whole milliseconds, at
    /// least 1. A swing through the target does not count as settled.
    pub hold: Duration,
    /// Longest time for settling, from `hold` to [`Self::TIMEOUT_MAX`]. A goal that makes no
    /// progress is given up earlier.
    pub timeout: Duration,
}

impl Default for Settling {
    /// Returns a hold of 250 ms and a timeout of 5 s.
    fn default() -> Self {
        Self {
            hold: Duration::from_millis(250),
            timeout: Duration::from_secs(5),
        }
    }
}

impl Settling {
    /// The longest accepted timeout.
    pub const TIMEOUT_MAX: Duration = Duration::from_secs(60);
}

/// Cycles of rest after which an arm without a target counts as stopped.
const HOLD_AT_REST: u64 = 100;

/// Longest time until an arm without a target must have stopped. The reference rests, so if the arm
/// still moves, something outside moves it. The timeout of a goal does not extend this time.
const REST_TIMEOUT: Duration = Duration::from_secs(1);

/// Cycles without progress after which an arm at rest counts as stuck short of its target.
const STUCK: u64 = 500;

/// Least progress, in parts of the tolerance.
const PROGRESS: f64 = 0.02;

/// Cycles over which the spring between arm and reference is released.
const RELEASE: u32 = 100;

/// Time after which the robot must stop a released arm that still moves. If the motion finished
/// while the arm moved, it would end in a reflex.
pub const RELEASE_TIMEOUT: Duration = Duration::from_secs(1);

/// Distance between the measured end effector and its target.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PoseError {
    /// Distance, `[m]`.
    pub translation: f64,
    /// Angle, `[rad]`.
    pub rotation: f64,
}

impl PoseError {
    /// Returns the distance between `pose` and `target`.
    pub fn between(pose: &Isometry3<f64>, target: &Isometry3<f64>) -> Self {
        Self {
            translation: (pose.translation.vector - target.translation.vector).norm(),
            rotation: rotation::error(&target.rotation, &pose.rotation).norm(),
        }
    }

    pub(super) fn within(&self, tolerance: &Tolerance) -> bool {
        self.in_parts_of(tolerance) <= 1.0
    }

    /// Returns the greater of the two errors, each divided by its tolerance.
    fn in_parts_of(&self, tolerance: &Tolerance) -> f64 {
        let translation = self.translation / tolerance.translation;
        translation.max(self.rotation / tolerance.rotation)
    }
}

/// State of an arm that rests away from its target.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Shortfall {
    /// Distance from the target.
    pub error: PoseError,
    /// Wrench that pulls the end effector toward the target, in base axes, `[N, N m]`. An obstacle
    /// exerts the opposite wrench. `None` if the robot's controller turns setpoints into torques.
    pub pull: Option<[f64; 6]>,
    /// Torque limit of the goal that keeps the arm from pulling harder, if any.
    pub limited: Option<LimitedTorque>,
}

impl core::fmt::Display for Shortfall {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let PoseError {
            translation,
            rotation,
        } = self.error;
        write!(
            f,
            "{:.1} mm and {:.1} mrad from the target",
            translation * 1e3,
            rotation * 1e3
        )?;
        if let Some([x, y, z, about_x, about_y, about_z]) = self.pull {
            write!(
                f,
                ", and pulls towards it with {x:.1} {y:.1} {z:.1} N and {about_x:.1} {about_y:.1} \
                 {about_z:.1} N m (base axes x y z)",
            )?;
        }
        match self.limited {
            Some(limited) => write!(f, ": {limited}"),
            None => write!(
                f,
                ": something holds or moves the arm, its load differs from the declared load, or \
                 its posture is nearly singular"
            ),
        }
    }
}

/// Decides in each cycle whether the arm has settled.
#[derive(Debug)]
pub(super) struct Landing {
    target: Option<Isometry3<f64>>,
    tolerance: Tolerance,
    settling: Settling,
    cycles: u64,
    held: u64,
    /// The least error so far, divided by the tolerance, and the number of cycles since it last
    /// fell.
    nearest: f64,
    stuck: u64,
}

pub(super) enum Verdict {
    Settling,
    /// Result of the settling, and the number of cycles since then.
    Settled(Settlement, u64),
}

impl Landing {
    /// Creates a landing at a target of the end effector. Without a target, the arm only has to
    /// stop.
    pub(super) fn new(
        target: Option<Isometry3<f64>>,
        tolerance: Tolerance,
        settling: Settling,
    ) -> Self {
        Self {
            target,
            tolerance,
            settling,
            cycles: 0,
            held: 0,
            nearest: f64::INFINITY,
            stuck: 0,
        }
    }

    pub(super) fn target(&self) -> Option<Isometry3<f64>> {
        self.target
    }

    /// True if the arm, measured at one pose, rests at the pose of its `reference` while the
    /// reference is still away from the target.
    pub(super) fn is_short_at(
        &self,
        reference: &Isometry3<f64>,
        measured: &Isometry3<f64>,
    ) -> bool {
        let near =
            |pose: &Isometry3<f64>| PoseError::between(pose, reference).within(&self.tolerance);
        near(measured) && self.target.is_some_and(|target| !near(&target))
    }

    /// Evaluates one cycle. `working` is true while the law still increases its torques to move an
    /// arm at rest.
    pub(super) fn judge(
        &mut self,
        measured: &Isometry3<f64>,
        at_rest: bool,
        working: bool,
    ) -> Verdict {
        let error = self
            .target
            .map(|target| PoseError::between(measured, &target));
        let there = at_rest && error.is_none_or(|error| error.within(&self.tolerance));
        self.cycles += 1;
        self.held = if there { self.held + 1 } else { 0 };
        let parts = error.map_or(0.0, |error| error.in_parts_of(&self.tolerance));
        let nearer = parts < self.nearest - PROGRESS;
        self.nearest = if nearer { parts } else { self.nearest };
        let changing = nearer || working || !at_rest || there;
        self.stuck = if changing { 0 } else { self.stuck + 1 };
        let Settling { hold, timeout } = self.settling;
        let timeout = error.map_or(REST_TIMEOUT, |_| timeout);
        let given_up = self.stuck >= STUCK || u128::from(self.cycles) >= timeout.as_millis();
        let settlement = match error {
            None if self.held >= HOLD_AT_REST => Settlement::AtRest,
            Some(error) if u128::from(self.held) >= hold.as_millis() => Settlement::Arrived(error),
            _ if !given_up => return Verdict::Settling,
            None => Settlement::AtRest,
            Some(error) => Settlement::TargetNotReached(Shortfall {
                error,
                pull: None,
                limited: None,
            }),
        };
        Verdict::Settled(settlement, self.held)
    }
}

/// Releases the spring between arm and reference. The reference moves to the arm's position, so
/// that the motion ends without a step in torque. The springs stay active: if the load differs from
/// the declared load, they keep the arm from falling.
#[derive(Debug)]
pub(super) struct Release {
    target: Option<Isometry3<f64>>,
    arm: JointVector,
    length: JointVector,
    cycle: u32,
}

impl Release {
    /// Creates the release for an arm at `arm` and its reference, both in `[rad]`, for a goal with
    /// this target.
    pub(super) fn new(
        target: Option<Isometry3<f64>>,
        arm: JointVector,
        reference: &JointVector,
    ) -> Self {
        Self {
            target,
            arm,
            length: reference - arm,
            cycle: 0,
        }
    }

    pub(super) fn reference(&mut self) -> JointVector {
        self.cycle += 1;
        let remaining = RELEASE.saturating_sub(self.cycle);
        self.arm + self.length * (f64::from(remaining) / f64::from(RELEASE))
    }

    pub(super) fn error(&self, pose: &Isometry3<f64>) -> Option<PoseError> {
        self.target.map(|target| PoseError::between(pose, &target))
    }

    pub(super) fn is_over(&self, at_rest: bool) -> bool {
        self.cycle >= RELEASE && at_rest
    }

    /// True if the arm has not stopped in time.
    pub(super) fn is_in_vain(&self) -> bool {
        u128::from(self.cycle) >= RELEASE_TIMEOUT.as_millis()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn landing(settling: Settling) -> Landing {
        Landing::new(Some(Isometry3::identity()), Tolerance::default(), settling)
    }

    fn judge_for(
        landing: &mut Landing,
        cycles: u64,
        pose: &Isometry3<f64>,
        (at_rest, working): (bool, bool),
    ) -> Option<Settlement> {
        for _ in 0..cycles {
            if let Verdict::Settled(settlement, _) = landing.judge(pose, at_rest, working) {
                return Some(settlement);
            }
        }
        None
    }

    #[test]
    fn a_swing_through_the_target_is_no_arrival() {
        let mut landing = landing(Settling::default());
        let there = Isometry3::translation(0.0, 0.0, 0.9e-3);
        let away = Isometry3::translation(0.0, 0.0, 1.1e-3);
        assert_eq!(judge_for(&mut landing, 249, &there, RESTS), None);
        assert_eq!(judge_for(&mut landing, 1, &away, RESTS), None);
        assert_eq!(judge_for(&mut landing, 1000, &there, MOVES), None);
        let arrived = judge_for(&mut landing, 250, &there, RESTS);
        assert!(matches!(arrived, Some(Settlement::Arrived(error)) if error.translation == 0.9e-3));
    }

    const RESTS: (bool, bool) = (true, false);
    const MOVES: (bool, bool) = (false, false);
    const WORKING: (bool, bool) = (true, true);

    #[test]
    fn arm_without_progress_falls_short_after_half_a_second() {
        let mut landing = landing(Settling::default());
        let at = |x: f64| Isometry3::translation(x, 0.0, 0.0);
        // The arm creeps, the arm moves, and the law works on the arm.
        for i in 0..20 {
            let on_its_way = at(0.03 - 1e-4 * f64::from(i));
            assert_eq!(judge_for(&mut landing, 50, &on_its_way, RESTS), None);
        }
        assert_eq!(judge_for(&mut landing, 600, &at(0.03), MOVES), None);
        assert_eq!(judge_for(&mut landing, 600, &at(0.03), WORKING), None);
        assert_eq!(judge_for(&mut landing, STUCK - 1, &at(0.03), RESTS), None);
        let short = judge_for(&mut landing, 1, &at(0.03), RESTS);
        assert!(
            matches!(short, Some(Settlement::TargetNotReached(short)) if short.error.translation == 0.03)
        );
    }

    #[test]
    fn arm_that_keeps_moving_falls_short_at_the_timeout() {
        let mut landing = landing(Settling::default());
        let away = Isometry3::translation(0.02, 0.0, 0.0);
        let cycles = 5000;
        assert_eq!(judge_for(&mut landing, cycles - 1, &away, MOVES), None);
        let short = judge_for(&mut landing, 1, &away, MOVES);
        assert!(
            matches!(short, Some(Settlement::TargetNotReached(short)) if short.error.translation == 0.02)
        );
    }

    #[test]
    fn settling_is_as_long_as_it_is_asked_for() {
        let settling = Settling {
            hold: Duration::from_millis(1200),
            timeout: Duration::from_secs(2),
        };
        let (there, away) = (
            Isometry3::identity(),
            Isometry3::translation(0.02, 0.0, 0.0),
        );
        let mut long = landing(settling);
        assert_eq!(judge_for(&mut long, 1199, &there, RESTS), None);
        let arrived = judge_for(&mut long, 1, &there, RESTS);
        assert!(matches!(arrived, Some(Settlement::Arrived(_))));
        let mut short = landing(settling);
        assert_eq!(judge_for(&mut short, 1999, &away, MOVES), None);
        let given_up = judge_for(&mut short, 1, &away, MOVES);
        assert!(matches!(given_up, Some(Settlement::TargetNotReached(_))));
    }

    #[test]
    fn the_spring_is_let_go_evenly_and_only_at_rest() {
        let arm = JointVector::repeat(-0.5);
        let mut release = Release::new(None, arm, &JointVector::repeat(-0.49));
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

    #[test]
    fn restless_arm_is_released_in_vain_and_does_not_finish() {
        let mut release = Release::new(None, JointVector::zeros(), &JointVector::zeros());
        let cycles = RELEASE_TIMEOUT.as_millis() as u32;
        for _ in 0..cycles {
            assert!(!release.is_in_vain());
            release.reference();
        }
        assert!(release.is_in_vain());
        assert!(!release.is_over(false));
    }

    #[test]
    fn a_patient_goal_makes_no_patient_brake() {
        let settling = Settling {
            timeout: Settling::TIMEOUT_MAX,
            ..Settling::default()
        };
        let mut brake = Landing::new(None, Tolerance::default(), settling);
        let here = Isometry3::identity();
        let cycles = REST_TIMEOUT.as_millis() as u64;
        assert_eq!(judge_for(&mut brake, cycles - 1, &here, MOVES), None);
        let rests = judge_for(&mut brake, 1, &here, MOVES);
        assert_eq!(rests, Some(Settlement::AtRest));
    }
}

//! The motions that identify an arm.

use core::fmt;
use core::time::Duration;

use franka_model::{EndEffector, Frame, JointVector, Model, transform};
use franka_otg::{Generator, Limits, State};
use franka_proto::RobotState;
use nalgebra::Vector3;

use crate::session::{Budget, Tolerance};

/// Motions around the current joint positions of the arm. In each of a few poses, all joints move
/// back and forth twice. Then they return to the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    start: [f64; 7],
    motions: Vec<PlannedMotion>,
    budget: Budget,
    reach: Reach,
}

/// One motion of a `Plan`, from rest to rest. `Display` prints a line that announces it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedMotion {
    /// Joint positions before the motion, `[rad]`.
    pub from: [f64; 7],
    /// Joint positions after the motion, `[rad]`.
    pub to: [f64; 7],
    /// Duration of the motion, including the arrival.
    pub duration: Duration,
}

impl fmt::Display for PlannedMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "joints 1 to 7 by")?;
        for (from, to) in self.from.iter().zip(self.to) {
            write!(f, " {:+.2}", to - from)?;
        }
        write!(f, " rad in {:.1} s", self.duration.as_secs_f64())
    }
}

/// Largest distances of the planned motions from the arm's current position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reach {
    /// Largest distance of each joint, in either direction, `[rad]`.
    pub joints: [f64; 7],
    /// Largest distance of the end effector, `[m]`.
    pub end_effector: f64,
    /// Largest distance by which the end effector moves down, in the base frame, `[m]`.
    pub down: f64,
}

impl Plan {
    /// Velocity of the joints in steady motion, `[rad/s]`.
    pub const SPEED: f64 = 0.2;

    /// Distance from the target within which a motion counts as arrived. It is large, because the
    /// arm may be inaccurate before its friction, bias and load are known.
    pub const TOLERANCE: Tolerance = Tolerance {
        translation: 0.02,
        rotation: 0.05,
    };

    /// Returns the plan for an arm of this model in this state. Joints near a limit first move away
    /// from it.
    pub fn new(model: &Model, state: &RobotState) -> Self {
        let limits = model.joint_limits();
        let mut budget = Budget::of(limits);
        for joint in &mut budget.joints {
            joint.velocity = Self::SPEED;
        }
        let start = JointVector::from(state.q);
        let center = JointVector::from_fn(|i, _| {
            let away = SHIFT[i] + STROKE / 2.0 + MARGIN;
            start[i]
                .max(limits.lower[i] + away)
                .min(limits.upper[i] - away)
        });
        let strokes = POSES.iter().flat_map(|signs| {
            let shift = JointVector::from(SHIFT).component_mul(&JointVector::from(*signs));
            let half = JointVector::from(WAY) * (STROKE / 2.0);
            [-half, half, -half, half, -half].map(|stroke| center + shift + stroke)
        });
        let mut from = state.q;
        let motions: Vec<_> = strokes
            .chain([start])
            .map(|to| {
                let motion = PlannedMotion::new(from, to.into(), &budget);
                from = motion.to;
                motion
            })
            .collect();
        Self {
            start: state.q,
            reach: Reach::of(&motions, model, state),
            motions,
            budget,
        }
    }

    /// Returns the joint positions at which the plan begins and ends, `[rad]`.
    pub fn start(&self) -> &[f64; 7] {
        &self.start
    }

    /// Returns the motions of the plan, in order.
    pub fn motions(&self) -> &[PlannedMotion] {
        &self.motions
    }

    /// Returns the velocity, acceleration and jerk limits of the motions.
    pub fn budget(&self) -> Budget {
        self.budget
    }

    /// Returns how far the motions move the arm from its current position.
    pub fn reach(&self) -> Reach {
        self.reach
    }

    /// Returns the approximate duration of all motions together.
    pub fn duration(&self) -> Duration {
        let durations = self.motions.iter().map(|motion| motion.duration);
        durations.fold(Duration::ZERO, Duration::saturating_add)
    }
}

impl PlannedMotion {
    fn new(from: [f64; 7], to: [f64; 7], budget: &Budget) -> Self {
        let limits = Limits::per_axis(budget.joints);
        let planned = limits.and_then(|limits| {
            let generator = Generator::towards(State::at_rest(from), limits, Some(&to))?;
            Ok(generator.duration())
        });
        // If the state is not finite, nothing is planned; the session refuses such a goal.
        let duration = planned.unwrap_or_default() + ARRIVAL;
        Self {
            from,
            to,
            duration: Duration::try_from_secs_f64(duration).unwrap_or(Duration::MAX),
        }
    }
}

impl Reach {
    fn of(motions: &[PlannedMotion], model: &Model, state: &RobotState) -> Self {
        let ee = transform::isometry_from_array(&state.F_T_EE).unwrap_or_default();
        let ee = EndEffector {
            f_t_ee: transform::matrix(&ee),
            ..EndEffector::default()
        };
        let at = |q: &JointVector| {
            let pose = model.pose(Frame::EndEffector, q, &ee);
            Vector3::new(pose[(0, 3)], pose[(1, 3)], pose[(2, 3)])
        };
        let start = JointVector::from(state.q);
        let home = at(&start);
        let mut reach = Self::default();
        for PlannedMotion { from, to, .. } in motions {
            let (from, to) = (JointVector::from(*from), JointVector::from(*to));
            for step in 1..=STEPS {
                let q = from.lerp(&to, f64::from(step) / f64::from(STEPS));
                let off = at(&q) - home;
                reach.end_effector = reach.end_effector.max(off.norm());
                reach.down = reach.down.max(-off.z);
                for (most, joint) in reach.joints.iter_mut().zip((q - start).iter()) {
                    *most = most.max(joint.abs());
                }
            }
        }
        reach
    }
}

/// Distance that a joint moves back and forth, `[rad]`. It takes almost a second of steady motion,
/// which covers several periods of a torque ripple.
const STROKE: f64 = 0.2;

/// Directions of the joints on a stroke. Each joint is measured separately. Mixed directions move
/// the end effector less far than equal directions.
const WAY: [f64; 7] = [1.0, 1.0, -1.0, 1.0, 1.0, 1.0, 1.0];

/// Distance between the start and the middle of the strokes in a pose, `[rad]`. The load is
/// identified by how its gravity changes between poses. Joint 1 does not change it.
const SHIFT: [f64; 7] = [0.0, 0.12, 0.1, 0.15, 0.25, 0.25, 0.25];

/// Shift of each joint in each pose, as a multiple of [`SHIFT`].
const POSES: [[f64; 7]; 6] = [
    [0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
    [0.0, 1.0, -1.0, 1.0, -1.0, -1.0, -1.0],
    [0.0, 1.0, 1.0, -1.0, -1.0, 1.0, -1.0],
    [0.0, -1.0, -1.0, -1.0, -1.0, -1.0, 1.0],
    [0.0, -1.0, 1.0, -1.0, 1.0, 1.0, 1.0],
    [0.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0],
];

/// Least distance from the joint limits, `[rad]`.
const MARGIN: f64 = 0.1;

/// Time from the arrival of the reference to the arrival of the arm, `[s]`. The transients of the
/// arm decay, then it rests for a quarter of a second.
const ARRIVAL: f64 = 0.45;

/// Number of points of a motion at which its reach is computed.
const STEPS: u32 = 8;

#[cfg(test)]
mod tests {
    use rand::rngs::SmallRng;
    use rand::{Rng, SeedableRng};

    use super::*;
    use franka_model::READY;

    fn plan(model: &Model, q: [f64; 7]) -> Plan {
        let state = RobotState {
            q,
            ..RobotState::default()
        };
        Plan::new(model, &state)
    }

    #[test]
    fn plan_takes_a_minute_and_keeps_motions_small() {
        for model in [Model::fr3(), Model::fer()] {
            let plan = plan(model, READY.into());
            assert_eq!(plan.motions().len(), 31);
            assert!((50.0..65.0).contains(&plan.duration().as_secs_f64()));
            let reach = plan.reach();
            assert!(reach.end_effector < 0.2 && reach.down < 0.12, "{reach:?}");
            assert!(reach.joints.iter().all(|joint| *joint < 0.36), "{reach:?}");
        }
    }

    #[test]
    fn plan_keeps_off_limits_and_moves_all_joints_both_ways() {
        let mut random = SmallRng::seed_from_u64(7);
        for model in [Model::fr3(), Model::fer()] {
            let limits = model.joint_limits();
            let inside = |q: f64, i: usize, margin: f64| {
                (limits.lower[i] + margin..=limits.upper[i] - margin).contains(&q)
            };
            for _ in 0..100 {
                let q = limits
                    .lower
                    .zip_map(&limits.upper, |low, high| random.random_range(low..high));
                let plan = plan(model, q.into());
                let (last, motions) = plan.motions().split_last().expect("31 motions");
                assert_eq!(last.to, plan.start().clone());
                for motion in motions {
                    assert!((0..7).all(|i| inside(motion.to[i], i, MARGIN - 1e-9)));
                }
                for pose in motions.chunks(5) {
                    for (i, way) in [(1, 1.0), (2, -1.0), (3, 1.0), (4, -1.0)] {
                        let PlannedMotion { from, to, .. } = pose[i];
                        for joint in 0..7 {
                            let goes = (to[joint] - from[joint]) * way * WAY[joint];
                            assert!((goes - STROKE).abs() < 1e-9);
                        }
                    }
                }
            }
        }
    }
}

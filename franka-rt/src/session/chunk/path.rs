//! Paths: places without times, which the arm goes through as fast as its budget allows.

use franka_model::limits::JointLimits;
use franka_model::{JointVector, Model, Twist, rotation};
use franka_otg::AxisLimits;
use franka_proto::RobotState;
use nalgebra::{Isometry3, SVector, Translation3, Vector3};

use super::curve::Curve;
use super::curve_state::stacked;
use super::pace::Pace;
use super::timing::{self, Corner, Knot, Leg, corner_time};
use super::value::{Chunk, Origin, Points, TURN_MAX};
use crate::session::pose::PoseState;
use crate::session::reference::Reference;
use crate::session::{Budget, GoalError, Target, check, rigid};

/// A place on a path, and how far from it the path may round its corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waypoint {
    target: Target,
    blend: f64,
}

impl Waypoint {
    /// The most of one path.
    pub const COUNT_MAX: usize = 100;

    /// A pose of the end effector in the base frame, metres, or joint positions, `[rad]`, at which
    /// the arm stops.
    pub fn new(target: impl Into<Target>) -> Self {
        let blend = 0.0;
        Self {
            target: target.into(),
            blend,
        }
    }

    /// Rounds the corner: the path leaves the straight line to this waypoint at this distance
    /// before it, and is on the next line at this distance after it, or in the middle of a line
    /// that is shorter than twice that. For poses `[m]` of the end effector, where a turn counts as
    /// the way that the budget allows in the time of the turn; for joint positions `[rad]`, the
    /// norm over the joints. The last waypoint of a path is stopped at all the same.
    #[must_use]
    pub fn blend(mut self, distance: f64) -> Self {
        self.blend = distance;
        self
    }

    /// Where it is.
    pub fn target(&self) -> &Target {
        &self.target
    }
}

impl<T: Into<Target>> From<T> for Waypoint {
    fn from(target: T) -> Self {
        Self::new(target)
    }
}

/// Why a path is not accepted. Nothing has moved. Waypoints count from 1.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// There are no waypoints.
    #[error("a path needs at least one waypoint")]
    Empty,
    /// There are more waypoints than a path may have.
    #[error("more than {} waypoints", Waypoint::COUNT_MAX)]
    TooMany,
    /// A waypoint is neither a pose nor joint positions, or not what the first one is.
    #[error(
        "waypoint {waypoint} is not of the kind of the first: expected all poses, or all joint positions"
    )]
    Kind {
        /// Which.
        waypoint: usize,
    },
    /// The distance of a waypoint is not a number, or below zero.
    #[error("waypoint {waypoint} is to be rounded within {got}, expected 0 or more")]
    Blend {
        /// Which.
        waypoint: usize,
        /// The distance given.
        got: f64,
    },
    /// The arm cannot go there.
    #[error("waypoint {waypoint}: {error}")]
    Waypoint {
        /// Which.
        waypoint: usize,
        /// Why.
        #[source]
        error: GoalError,
    },
    /// On the way to a waypoint the end effector turns so far that its direction is in doubt.
    #[error("{degrees} degrees on the way to waypoint {waypoint}: expected less than 170")]
    Turn {
        /// Which.
        waypoint: usize,
        /// The angle.
        degrees: u16,
    },
}

/// Shares of the budget's velocity, acceleration and jerk that a path is planned with. What follows
/// it has the rest, to get back to it.
const SHARES: [f64; 3] = [0.99, 0.95, 0.9];

impl Chunk {
    /// Through `waypoints` without times, within `budget`, from where the joints `q` are, `[rad]`.
    /// It begins when it is taken up, waits while the arm is held back, and can be paused.
    ///
    /// Between corners the motion is as fast as the budget allows. A corner is passed without
    /// stopping, with the least time that the budget allows for its size and its neighbours.
    ///
    /// # Errors
    /// [`PathError`].
    pub fn through(
        waypoints: &[Waypoint],
        q: &[f64; 7],
        budget: &Budget,
        model: &Model,
        state: &RobotState,
    ) -> Result<Self, PathError> {
        let first = waypoints.first().ok_or(PathError::Empty)?;
        if waypoints.len() > Waypoint::COUNT_MAX {
            return Err(PathError::TooMany);
        }
        for (waypoint, place) in (1..).zip(waypoints) {
            let Waypoint { target, blend } = *place;
            let of_kind = matches!(
                (first.target, target),
                (Target::Joints(_), Target::Joints(_)) | (Target::Pose(_), Target::Pose(_))
            );
            if !of_kind {
                return Err(PathError::Kind { waypoint });
            }
            if !(blend >= 0.0 && blend.is_finite()) {
                let got = blend;
                return Err(PathError::Blend { waypoint, got });
            }
            check::target(&target, model, state)
                .map_err(|error| PathError::Waypoint { waypoint, error })?;
        }
        let pose_at = |q: &JointVector| {
            let ee = crate::session::end_effector_of(state).unwrap_or_default();
            rigid(&model.pose(franka_model::Frame::EndEffector, q, &ee))
        };
        let start = JointVector::from(*q);
        let (points, pace) = match first.target {
            Target::Joints(_) => through_joints(waypoints, start, budget, model.joint_limits()),
            _ => through_poses(waypoints, pose_at(&start), budget)?,
        };
        Ok(Self {
            points,
            origin: Origin::TakeUp,
            blend: Self::BLEND,
            pace: Some(pace),
        })
    }
}

/// What a path may have of these limits.
fn share(limits: AxisLimits) -> AxisLimits {
    AxisLimits {
        velocity: SHARES[0] * limits.velocity,
        acceleration: SHARES[1] * limits.acceleration,
        jerk: SHARES[2] * limits.jerk,
    }
}

/// The limits of a leg on which each of the `ways` has its limits.
fn limits_of_leg(ways: impl Iterator<Item = (f64, AxisLimits)>) -> AxisLimits {
    let free = AxisLimits {
        velocity: f64::INFINITY,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
    };
    ways.filter(|(way, _)| *way > 0.0)
        .fold(free, |leg, (way, limits)| AxisLimits {
            velocity: leg.velocity.min(limits.velocity / way),
            acceleration: leg.acceleration.min(limits.acceleration / way),
            jerk: leg.jerk.min(limits.jerk / way),
        })
}

/// How far around a corner its blend goes, in shares of the legs of these lengths.
fn shares(blend: f64, lengths: (f64, f64)) -> Option<(f64, f64)> {
    let share = |length: f64| (blend / length).min(0.5);
    (blend > 0.0).then(|| (share(lengths.0), share(lengths.1)))
}

fn through_joints(
    waypoints: &[Waypoint],
    start: JointVector,
    budget: &Budget,
    robot: &JointLimits,
) -> (Points, Pace) {
    let limits: [AxisLimits; 7] = core::array::from_fn(|i| {
        let AxisLimits {
            velocity,
            acceleration,
            jerk,
        } = budget.joints[i];
        share(AxisLimits {
            velocity: velocity.min(robot.velocity[i]),
            acceleration: acceleration.min(robot.acceleration[i]),
            jerk: jerk.min(robot.jerk[i]),
        })
    });
    let mut places = vec![(start, 0.0)];
    for waypoint in waypoints {
        if let Target::Joints(q) = waypoint.target {
            places.push((JointVector::from(q), waypoint.blend));
        }
    }
    places.dedup_by(|next, last| {
        let same = next.0 == last.0;
        last.1 = if same { next.1 } else { last.1 };
        same
    });
    let each = |way: &JointVector| -> [(f64, AxisLimits); 7] {
        core::array::from_fn(|i| (way[i].abs(), limits[i]))
    };
    let legs: Vec<Leg<7>> = places
        .windows(2)
        .map(|ends| {
            let way = ends[1].0 - ends[0].0;
            let limits = limits_of_leg(each(&way).into_iter());
            Leg { way, limits }
        })
        .collect();
    let duration = |way: &JointVector| {
        let times = each(way).map(|(way, limits)| corner_time(way, &limits));
        times.into_iter().fold(0.0, f64::max)
    };
    let blends: Vec<f64> = places.iter().map(|(_, blend)| *blend).collect();
    let lengths: Vec<f64> = legs.iter().map(|leg| leg.way.norm()).collect();
    let knots = timed(&legs, &lengths, &blends, duration);
    let states = knots.iter().map(|knot| {
        let Some(Leg { way, .. }) = legs.get(knot.leg) else {
            return Reference::at_rest(start);
        };
        Reference {
            q: places[knot.leg].0 + way * knot.s,
            dq: way * knot.v,
            ddq: way * knot.a,
        }
    });
    let states: Vec<_> = states.collect();
    let fastest = JointVector::from_fn(|i, _| {
        let speeds = states.iter().map(|state| state.dq[i].abs());
        speeds.fold(0.0, f64::max)
    });
    let pace = Pace::of((0..7).map(|i| (fastest[i], budget.joints[i])));
    let times = knots.iter().map(|knot| knot.time).collect();
    (Points::Joints(Curve::new(times, states)), pace)
}

fn through_poses(
    waypoints: &[Waypoint],
    start: Isometry3<f64>,
    budget: &Budget,
) -> Result<(Points, Pace), PathError> {
    let (translation, turning) = (share(budget.translation), share(budget.rotation));
    let mut places = vec![(start, 0.0)];
    let mut legs: Vec<Leg<6>> = Vec::new();
    let each = |way: &Twist| {
        [
            (moved(way).norm(), translation),
            (turned(way).norm(), turning),
        ]
    };
    for (waypoint, place) in (1..).zip(waypoints) {
        let (from, Target::Pose(to)) = (places[places.len() - 1].0, place.target) else {
            continue;
        };
        let turn = rotation::error(&to.rotation, &from.rotation);
        if turn.norm() >= TURN_MAX {
            let degrees = turn.norm().to_degrees().round() as u16;
            return Err(PathError::Turn { waypoint, degrees });
        }
        let way = stacked(&(to.translation.vector - from.translation.vector), &turn);
        if way == Twist::zeros() {
            let last = places.len() - 1;
            places[last].1 = place.blend;
            continue;
        }
        let limits = limits_of_leg(each(&way).into_iter());
        legs.push(Leg { way, limits });
        places.push((to, place.blend));
    }
    let duration = |way: &SVector<f64, 6>| {
        let [t, r] = each(way).map(|(way, limits)| corner_time(way, &limits));
        t.max(r)
    };
    let blends: Vec<f64> = places.iter().map(|(_, blend)| *blend).collect();
    let per_turn = translation.velocity / turning.velocity;
    let length = |leg: &Leg<6>| {
        moved(&leg.way)
            .norm()
            .max(per_turn * turned(&leg.way).norm())
    };
    let lengths: Vec<f64> = legs.iter().map(length).collect();
    let knots = timed(&legs, &lengths, &blends, duration);
    let states = knots.iter().map(|knot| {
        let from = places[knot.leg].0;
        let way = legs.get(knot.leg).map_or(Twist::zeros(), |leg| leg.way);
        PoseState {
            pose: Isometry3::from_parts(
                Translation3::from(from.translation.vector + moved(&way) * knot.s),
                rotation::exp(&(turned(&way) * knot.s)) * from.rotation,
            ),
            twist: way * knot.v,
            acceleration: way * knot.a,
        }
    });
    let states: Vec<_> = states.collect();
    let fastest = |part: fn(&Twist) -> Vector3<f64>| {
        let speeds = states.iter().map(|state| part(&state.twist).norm());
        speeds.fold(0.0, f64::max)
    };
    let pace = Pace::of(
        [
            (fastest(moved), budget.translation),
            (fastest(turned), budget.rotation),
        ]
        .into_iter(),
    );
    let times = knots.iter().map(|knot| knot.time).collect();
    Ok((Points::Poses(Curve::new(times, states)), pace))
}

fn timed<const D: usize>(
    legs: &[Leg<D>],
    lengths: &[f64],
    blends: &[f64],
    duration: impl Fn(&SVector<f64, D>) -> f64,
) -> Vec<Knot> {
    if legs.is_empty() {
        return vec![Knot::START];
    }
    let corner = |i: usize| {
        let sizes = shares(blends[i + 1], (lengths[i], lengths[i + 1]))?;
        Some(Corner::new(sizes, (&legs[i], &legs[i + 1]), &duration))
    };
    let mut corners: Vec<_> = (0..legs.len() - 1).map(corner).collect();
    timing::time(legs, &mut corners)
}

fn moved(way: &Twist) -> Vector3<f64> {
    way.fixed_rows::<3>(0).into_owned()
}

fn turned(way: &Twist) -> Vector3<f64> {
    way.fixed_rows::<3>(3).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::READY;
    use rand::rngs::SmallRng;
    use rand::{Rng, SeedableRng};

    const STEP: f64 = 1e-4;

    fn state() -> RobotState {
        RobotState {
            q: READY.into(),
            ..RobotState::default()
        }
    }

    /// Times from 0 to the end.
    fn times(end: f64) -> impl Iterator<Item = f64> {
        (0..=(end / STEP) as u32).map(|step| f64::from(step) * STEP)
    }

    #[test]
    fn joints_keep_their_limits_and_the_size_of_corners_on_random_paths() {
        let mut random = SmallRng::seed_from_u64(17);
        let model = Model::fr3();
        for case in 0..40 {
            let budget = Budget::of(model.joint_limits()).scaled(random.random_range(0.3..2.0));
            let count = random.random_range(1..8);
            let mut places = vec![(READY, 0.0)];
            for _ in 0..count {
                let near = JointVector::from_fn(|_, _| random.random_range(-0.3..0.3_f64).powi(3));
                let blend: f64 = random.random_range(-0.1..0.2);
                places.push((READY + near * 8.0, blend.max(0.0)));
            }
            let waypoints: Vec<_> = places[1..]
                .iter()
                .map(|(q, blend)| Waypoint::new(<[f64; 7]>::from(*q)).blend(*blend))
                .collect();
            let q = READY.into();
            let chunk = Chunk::through(&waypoints, &q, &budget, model, &state()).unwrap();
            let Points::Joints(curve) = &chunk.points else {
                panic!("joints");
            };
            let mut least = vec![f64::INFINITY; places.len()];
            let mut before = *curve.first();
            for t in times(curve.end()) {
                let now = curve.at(t);
                for (least, (place, _)) in least.iter_mut().zip(&places) {
                    *least = least.min((now.q - place).norm());
                }
                for i in 0..7 {
                    let AxisLimits {
                        velocity,
                        acceleration,
                        jerk,
                    } = budget.joints[i];
                    let jump = (now.ddq[i] - before.ddq[i]).abs() / STEP;
                    assert!(now.dq[i].abs() < velocity, "case {case}, {t}: {now:?}");
                    assert!(now.ddq[i].abs() < acceleration, "case {case}, {t}: {now:?}");
                    assert!(jump < jerk, "case {case}, {t}: {jump}");
                    let moved = (now.q[i] - before.q[i]).abs();
                    assert!(moved < velocity * STEP, "case {case}, {t}: {moved}");
                }
                before = now;
            }
            for (least, (_, blend)) in least.iter().zip(&places) {
                assert!(*least <= blend + 1e-4, "case {case}: {least} of {blend}");
            }
            let off = (curve.last().q - places[places.len() - 1].0).amax();
            assert!(off < 1e-12, "case {case}: {off}");
        }
    }

    #[test]
    fn a_path_of_one_straight_line_takes_as_long_as_the_plan_of_a_goal() {
        let model = Model::fr3();
        let budget = Budget::of(model.joint_limits());
        let there = READY + JointVector::repeat(0.2);
        let middle = READY + JointVector::repeat(0.1);
        let waypoints = [middle, there].map(|q| Waypoint::new(<[f64; 7]>::from(q)).blend(0.05));
        let chunk = Chunk::through(&waypoints, &READY.into(), &budget, model, &state()).unwrap();
        let limits = budget.joints.map(share);
        let limits = franka_otg::Limits::per_axis(limits).unwrap();
        let start = franka_otg::State::at_rest(READY.into());
        let plan = franka_otg::Generator::towards(start, limits, Some(&there.into())).unwrap();
        let (got, expected) = (chunk.end(), plan.duration());
        assert!(
            (got - expected).abs() < 1e-6 * expected,
            "{got} s, {expected} s"
        );
    }
}

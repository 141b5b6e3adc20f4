//! The chunk: points with times, as a policy predicts them.

use core::time::Duration;

use franka_model::{JointVector, Model, Twist, rotation};
use franka_proto::RobotState;
use nalgebra::Isometry3;

use super::curve::Curve;
use super::curve_state::stacked;
use super::derivatives;
use super::error::ChunkError;
use super::pace::Pace;
use crate::session::pose::PoseState;
use crate::session::reference::Reference;
use crate::session::{GoalError, Target, check};

/// Least time between two points: one cycle, minus the rounding error of a conversion.
const SPACING_MIN: Duration = Duration::from_nanos(999_999);

/// Greatest magnitude of a number of a point, in its unit. It is far above any number of an arm,
/// and small enough for all computations to stay finite.
const NUMBER_MAX: f64 = 1e6;

/// Greatest angle between two points, `[rad]`.
pub(super) const TURN_MAX: f64 = 170.0 * core::f64::consts::PI / 180.0;

/// Origin from which the times of a chunk count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// The cycle in which the session begins to follow the chunk.
    TakeUp,
    /// A time by the robot's clock, `message_id`.
    Robot(u64),
}

/// A sequence of points with times, through which the arm moves. Each point is a set of joint
/// positions or a pose. Typically, a policy predicts a chunk from one observation.
///
/// The motion through the points is twice continuously differentiable and rests at the last point.
/// The arm follows it within the budget of the chunk's goal. If the points demand more than the
/// budget, the arm lags and catches up within the budget. If the arm moves too fast at the end of a
/// chunk to brake within the budget, it overshoots by its braking distance. To avoid that, send the
/// next chunk before the present chunk ends.
///
/// - **Latency.** [`observed_at`](Self::observed_at) sets the state that the policy observed. When
///   the chunk begins, points whose time has passed are skipped, and the arm joins the motion at
///   the robot's present time.
/// - **Receding horizon.** A newer chunk replaces the current chunk when the newer chunk's first
///   point is due. If no chunk is running, it begins at once. If it has superseded a waiting chunk,
///   it begins when that chunk was due. It is then early by at most that chunk's waiting time. The
///   new chunk is blended with the present motion over [`Chunk::BLEND`]; see [`blend`](Self::blend)
///   and [`replace`](Self::replace).
///
/// ```
/// use core::time::Duration;
/// use franka_rt::session::Chunk;
///
/// let action = |k: u32| {
///     let mut q = [0.0, -0.78, 0.0, -2.36, 0.0, 1.57, 0.78];
///     q[0] = 0.01 * f64::from(k);
///     (Duration::from_millis(50) * k, q)
/// };
/// let observed = 4711; // `message_id` of the state that the policy saw
/// let chunk = Chunk::joints((0..16).map(action))?.observed_at(observed);
/// assert_eq!(chunk.end_after(observed), Duration::from_millis(750));
/// # Ok::<(), franka_rt::session::ChunkError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Chunk {
    pub(super) points: Points,
    pub(super) origin: Origin,
    pub(super) blend: Duration,
    /// True if the caller supplied the velocities of the points. These velocities are checked
    /// before the chunk is sent.
    pub(super) with_velocities: bool,
    /// Pace at which the time of a path stops and resumes; `None` for points with fixed times.
    pub(super) pace: Option<Pace>,
}

/// The points, of one of two kinds.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Points {
    Joints(Curve<Reference>),
    Poses(Curve<PoseState>),
}

impl Chunk {
    /// Maximum number of points in a chunk: ten seconds of a policy that acts at 100 Hz.
    pub const POINTS_MAX: usize = 1024;

    /// Maximum number of chunks that are in use, or on their way to or from the thread.
    pub const UNDER_WAY_MAX: usize = 8;

    /// Latest time of a point after the chunk's origin. Also the latest time of that origin after
    /// the robot's newest state. A later time is probably a confusion of units or clocks.
    pub const OFFSET_MAX: Duration = Duration::from_secs(60);

    /// Default time over which a chunk is blended with the present motion. A policy at 10 Hz makes
    /// one inference in that time.
    pub const BLEND: Duration = Duration::from_millis(100);

    /// Creates a chunk through joint positions, `[rad]`, each with its time after the chunk's
    /// origin. The velocities are estimated from the neighbouring points.
    ///
    /// # Errors
    /// Returns a [`ChunkError`] that names the first invalid point.
    pub fn joints(
        points: impl IntoIterator<Item = (Duration, [f64; 7])>,
    ) -> Result<Self, ChunkError> {
        let (times, q) = collect(points, |point, q| check_numbers(point, q))?;
        let state = |i| {
            let [dq, ddq] = derivatives::at(&times, i, |k| JointVector::from(q[k]));
            Reference {
                q: q[i].into(),
                dq,
                ddq,
            }
        };
        Ok(Self::through_joints(
            (0..q.len()).map(state).collect(),
            times,
        ))
    }

    /// Creates a chunk through joint positions with velocities, `[rad/s]`. The arm rests at the
    /// last point, regardless of that point's velocity.
    ///
    /// # Errors
    /// Returns the errors of [`joints`](Self::joints).
    pub fn joints_with_velocities(
        points: impl IntoIterator<Item = (Duration, [f64; 7], [f64; 7])>,
    ) -> Result<Self, ChunkError> {
        let points = points.into_iter().map(|(time, q, dq)| (time, (q, dq)));
        let (times, points) = collect(points, |point, (q, dq)| {
            check_numbers(point, q)?;
            check_numbers(point, dq)
        })?;
        let state = |i: usize| {
            let [ddq, _] = derivatives::at(&times, i, |k| JointVector::from(points[k].1));
            Reference {
                q: points[i].0.into(),
                dq: points[i].1.into(),
                ddq,
            }
        };
        let states = (0..points.len()).map(state).collect();
        Ok(Self {
            with_velocities: true,
            ..Self::through_joints(states, times)
        })
    }

    /// Creates a chunk through poses of the end effector in the base frame, `O_T_EE`, in metres,
    /// each with its time after the chunk's origin. The velocities are estimated from the
    /// neighbouring points.
    ///
    /// # Errors
    /// Returns the errors of [`joints`](Self::joints), and [`ChunkError::Turn`] if the end effector
    /// rotates too far between two points.
    pub fn poses(
        points: impl IntoIterator<Item = (Duration, Isometry3<f64>)>,
    ) -> Result<Self, ChunkError> {
        let (times, poses) = collect(points, check_pose)?;
        check_turns(poses.iter())?;
        let state = |i: usize| {
            let way = |k: usize| poses[k].translation.vector;
            let turn = |k: usize| rotation::error(&poses[k].rotation, &poses[i].rotation);
            let ([v, a], [omega, alpha]) = (
                derivatives::at(&times, i, way),
                derivatives::at::<3>(&times, i, turn),
            );
            PoseState {
                pose: poses[i],
                twist: stacked(&v, &omega),
                acceleration: stacked(&a, &alpha),
            }
        };
        Ok(Self::through_poses(
            (0..poses.len()).map(state).collect(),
            times,
        ))
    }

    /// Creates a chunk through poses of the end effector with twists: the velocity of the frame's
    /// origin, `[m/s]`, and the angular velocity, `[rad/s]`, both in base axes. The arm rests at
    /// the last point, regardless of that point's twist.
    ///
    /// # Errors
    /// Returns the errors of [`poses`](Self::poses).
    pub fn poses_with_twists(
        points: impl IntoIterator<Item = (Duration, Isometry3<f64>, [f64; 6])>,
    ) -> Result<Self, ChunkError> {
        let points = points
            .into_iter()
            .map(|(time, pose, twist)| (time, (pose, twist)));
        let (times, points) = collect(points, |point, (pose, twist)| {
            check_pose(point, pose)?;
            check_numbers(point, twist)
        })?;
        check_turns(points.iter().map(|(pose, _)| pose))?;
        let state = |i: usize| {
            let [acceleration, _] = derivatives::at(&times, i, |k| Twist::from(points[k].1));
            PoseState {
                pose: points[i].0,
                twist: points[i].1.into(),
                acceleration,
            }
        };
        let states = (0..points.len()).map(state).collect();
        Ok(Self {
            with_velocities: true,
            ..Self::through_poses(states, times)
        })
    }

    /// Makes the points' times count from the robot's state with this `message_id`, `[ms]`, which
    /// the policy observed. Without this call, they count from the cycle in which the chunk begins.
    #[must_use]
    pub fn observed_at(mut self, message_id: u64) -> Self {
        self.origin = Origin::Robot(message_id);
        self
    }

    /// Sets the time over which the chunk is blended with the present motion, [`Chunk::BLEND`] by
    /// default. The arm at first continues with its velocity and acceleration; then its difference
    /// from the chunk fades out.
    ///
    /// When the chunk begins, the arm may lag behind the previous chunk. If the previous chunk's
    /// desired place is nearer to the new chunk than the arm is, the blend begins at that place.
    /// The arm then catches up its lag within the budget, not within the blend.
    #[must_use]
    pub fn blend(mut self, over: Duration) -> Self {
        self.blend = over.min(Self::OFFSET_MAX);
        self
    }

    /// Disables blending: the arm turns to the chunk as fast as the budget allows. Use this for a
    /// chunk that corrects the previous chunk.
    #[must_use]
    pub fn replace(self) -> Self {
        self.blend(Duration::ZERO)
    }

    /// Returns the time from the robot's state with `message_id` `now` to the last point. Returns
    /// zero if that point has passed.
    pub fn end_after(&self, now: u64) -> Duration {
        Duration::try_from_secs_f64(self.end() - self.since_origin(now)).unwrap_or(Duration::ZERO)
    }

    /// Returns the time from the last point to the robot's state `now`. Returns zero if the last
    /// point is not due yet.
    pub fn late_by(&self, now: u64) -> Duration {
        Duration::try_from_secs_f64(self.since_origin(now) - self.end()).unwrap_or(Duration::ZERO)
    }

    /// Returns the target at which the arm rests after the last point.
    pub fn target(&self) -> Target {
        match &self.points {
            Points::Joints(curve) => Target::Joints(curve.last().q.into()),
            Points::Poses(curve) => Target::Pose(curve.last().pose),
        }
    }

    /// Checks the chunk for a robot in `state`. For joints, every point is checked. For poses, only
    /// the last point is checked, where the arm will rest; before that, inverse kinematics keeps
    /// the arm within its bounds. Velocities that the caller supplied must be within the robot's
    /// limits.
    ///
    /// # Errors
    /// Returns the [`GoalError`] of the first point that cannot be reached, or that the arm would
    /// pass too fast.
    pub fn check(&self, model: &Model, state: &RobotState) -> Result<(), GoalError> {
        if self.with_velocities {
            self.check_velocities(model)?;
        }
        match &self.points {
            Points::Joints(curve) => curve
                .states()
                .iter()
                .try_for_each(|point| check::target(&Target::Joints(point.q.into()), model, state)),
            Points::Poses(_) => check::target(&self.target(), model, state),
        }
    }

    fn check_velocities(&self, model: &Model) -> Result<(), GoalError> {
        match &self.points {
            Points::Joints(curve) => {
                let mut states = curve.states().iter();
                states.try_for_each(|point| check::joint_speeds(&point.dq.into(), model))
            }
            Points::Poses(curve) => {
                let mut states = curve.states().iter();
                states.try_for_each(|point| check::speeds(&point.twist, model))
            }
        }
    }

    pub(crate) fn observation(&self) -> Option<u64> {
        match self.origin {
            Origin::TakeUp => None,
            Origin::Robot(message_id) => Some(message_id),
        }
    }

    /// Returns the seconds from the origin to the robot's time `now`. If the times of a chunk count
    /// from its start, the origin is `now`.
    pub(super) fn since_origin(&self, now: u64) -> f64 {
        match self.origin {
            Origin::TakeUp => 0.0,
            Origin::Robot(origin) => milliseconds(now, origin),
        }
    }

    /// True if the times count from the cycle in which the chunk begins.
    pub(super) fn begins_at_take_up(&self) -> bool {
        self.origin == Origin::TakeUp
    }

    /// Returns the time at which the first point is due, in seconds from the origin.
    pub(super) fn begin(&self) -> f64 {
        match &self.points {
            Points::Joints(curve) => curve.begin(),
            Points::Poses(curve) => curve.begin(),
        }
    }

    /// Returns the time at which the last point is due, in seconds from the origin.
    pub(super) fn end(&self) -> f64 {
        match &self.points {
            Points::Joints(curve) => curve.end(),
            Points::Poses(curve) => curve.end(),
        }
    }

    fn through_joints(states: Vec<Reference>, times: Vec<f64>) -> Self {
        Self::of(Points::Joints(Curve::new(times, states)))
    }

    fn through_poses(states: Vec<PoseState>, times: Vec<f64>) -> Self {
        Self::of(Points::Poses(Curve::new(times, states)))
    }

    pub(super) fn of(points: Points) -> Self {
        Self {
            points,
            origin: Origin::TakeUp,
            blend: Self::BLEND,
            with_velocities: false,
            pace: None,
        }
    }
}

/// Returns the seconds from `origin` to `now`, both a `message_id`. Negative if `now` is earlier.
pub(super) fn milliseconds(now: u64, origin: u64) -> f64 {
    let distance = now.abs_diff(origin) as f64 * 1e-3;
    if now < origin { -distance } else { distance }
}

/// Checks and returns the times and values of the points. `check` also receives the number of the
/// point.
fn collect<T>(
    points: impl IntoIterator<Item = (Duration, T)>,
    check: impl Fn(usize, &T) -> Result<(), ChunkError>,
) -> Result<(Vec<f64>, Vec<T>), ChunkError> {
    let (mut times, mut values) = (Vec::new(), Vec::new());
    let mut before: Option<Duration> = None;
    for (point, (time, value)) in (1..).zip(points) {
        if point > Chunk::POINTS_MAX {
            return Err(ChunkError::TooMany {
                most: Chunk::POINTS_MAX,
            });
        }
        if time > Chunk::OFFSET_MAX {
            return Err(ChunkError::TooLate { point, time });
        }
        if let Some(before) = before.replace(time)
            && time < before + SPACING_MIN
        {
            return Err(ChunkError::TooClose {
                point,
                time,
                before,
            });
        }
        check(point, &value)?;
        times.push(time.as_secs_f64());
        values.push(value);
    }
    if times.is_empty() {
        return Err(ChunkError::Empty);
    }
    Ok((times, values))
}

fn check_numbers(point: usize, numbers: &[f64]) -> Result<(), ChunkError> {
    match numbers.iter().find(|x| x.is_nan() || x.abs() > NUMBER_MAX) {
        Some(&got) => Err(ChunkError::Number { point, got }),
        None => Ok(()),
    }
}

fn check_pose(point: usize, pose: &Isometry3<f64>) -> Result<(), ChunkError> {
    check_numbers(point, pose.translation.vector.as_slice())?;
    let length = pose.rotation.coords.norm();
    // NaN also fails this comparison.
    if (length - 1.0).abs() < 1e-6 {
        Ok(())
    } else {
        Err(ChunkError::Rotation { point, length })
    }
}

fn check_turns<'a>(poses: impl Iterator<Item = &'a Isometry3<f64>>) -> Result<(), ChunkError> {
    let mut before: Option<&Isometry3<f64>> = None;
    for (point, pose) in (1..).zip(poses) {
        if let Some(before) = before {
            let angle = rotation::error(&pose.rotation, &before.rotation).norm();
            if angle >= TURN_MAX {
                let degrees = angle.to_degrees().round() as u16;
                return Err(ChunkError::Turn { point, degrees });
            }
        }
        before = Some(pose);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Translation3, UnitQuaternion};

    const MS: Duration = Duration::from_millis(1);

    fn at(ms: u32, x: f64) -> (Duration, [f64; 7]) {
        (MS * ms, [x; 7])
    }

    #[test]
    fn points_that_make_no_chunk_are_refused_by_number() {
        let refused = |points: Vec<_>| Chunk::joints(points).unwrap_err().to_string();
        for (points, expected) in [
            (vec![], "the chunk has no points, expected at least one"),
            (
                vec![at(0, 0.0), at(10, 0.0), at(10, 0.1)],
                "point 3 is due at 10ms, expected at least 1 ms after the previous point, which \
                 is due at 10ms",
            ),
            (
                vec![at(10, 0.0), at(5, 0.0)],
                "point 2 is due at 5ms, expected at least 1 ms after the previous point, which is \
                 due at 10ms",
            ),
            (
                vec![at(0, 0.0), at(1, f64::NAN)],
                "point 2 has the number NaN, expected finite numbers from -1e6 to 1e6",
            ),
            (
                vec![at(0, 0.0), at(60_001, 0.0)],
                "point 2 is due at 60.001s, expected at most 60s",
            ),
            (
                (0..1025).map(|k| at(k, 0.0)).collect(),
                "the chunk has too many points, expected 1024 at most: send the rest as the next \
                 chunk, \
                 with times from the same origin",
            ),
        ] {
            assert_eq!(refused(points), expected);
        }
        assert!(Chunk::joints((0..1024).map(|k| at(k, 0.0))).is_ok());
    }

    #[test]
    fn poses_that_are_none_or_turn_too_far_are_refused() {
        let pose = |angle: f64| {
            Isometry3::from_parts(
                Translation3::new(0.4, 0.0, 0.5),
                UnitQuaternion::from_euler_angles(angle, 0.0, 0.0),
            )
        };
        let far = Chunk::poses([(MS, pose(0.0)), (MS * 2, pose(3.0))]).unwrap_err();
        assert_eq!(
            far.to_string(),
            "the orientation turns by 172 degrees from point 1 to point 2, expected less than 170 \
             degrees"
        );
        let mut long = pose(0.0);
        long.rotation =
            UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(2.0, 0.0, 0.0, 0.0));
        assert_eq!(
            Chunk::poses([(MS, long)]),
            Err(ChunkError::Rotation {
                point: 1,
                length: 2.0
            })
        );
    }

    #[test]
    fn a_point_outside_a_joints_range_is_refused_for_the_robot() {
        let (model, state) = (Model::fr3(), RobotState::default());
        let ready: [f64; 7] = franka_model::READY.into();
        let mut beyond = ready;
        beyond[3] = 0.5;
        let chunk = Chunk::joints([(MS, ready), (MS * 50, beyond), (MS * 100, ready)]).unwrap();
        let refused = chunk.check(model, &state).unwrap_err();
        assert!(
            matches!(refused, GoalError::OutOfRange { joint: 4, .. }),
            "{refused}"
        );
    }
}

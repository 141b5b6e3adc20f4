//! The targets of a replay, which are checked before any motion.

use core::time::Duration;

use franka_model::{EndEffector, Frame, JointVector, Model, RobotKind, rotation, transform};
use franka_otg::AxisLimits;
use franka_proto::RobotState;
use franka_rt::session::{Budget, Chunk};
use nalgebra::Isometry3;

use super::error::{GAP_MAX, ReplayError};
use crate::sample::{Sample, told};

/// Time between targets.
pub(super) const PERIOD: Duration = Duration::from_millis(10);

/// Half of the period over which measured positions are averaged, `[ms]`.
const HALF_WINDOW: u64 = 20;

/// Share of a joint's velocity limit that a replay may use. The arm needs the rest to catch up.
const VELOCITY_SHARE_MAX: f64 = 0.9;

/// Ratio of the replay's limits to the largest values of the recorded motion.
const RESERVE: f64 = 1.25;

/// Options of a replay.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ReplayOptions {
    /// Speed as a factor of the recorded speed. At 0.5, the replay takes twice the recorded time.
    pub speed: f64,
    /// Recorded positions that the arm should follow.
    pub source: ReplaySource,
    /// Kind of targets that the arm should follow.
    pub targets: ReplayTargets,
}

/// Recorded positions that the arm should follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ReplaySource {
    /// Commanded positions, from the first command to the last.
    #[default]
    Reference,
    /// Measured positions, averaged over 40 ms. Use them if a person or torque commands moved the
    /// arm.
    Measured,
}

/// Kind of targets that the arm should follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ReplayTargets {
    /// Joint positions. Every joint moves as recorded.
    #[default]
    Joints,
    /// Poses of the recorded end effector. The end effector moves as recorded, but the elbow may
    /// differ.
    Poses,
}

impl Default for ReplayOptions {
    fn default() -> Self {
        Self {
            speed: 1.0,
            source: ReplaySource::default(),
            targets: ReplayTargets::default(),
        }
    }
}

impl ReplayOptions {
    /// Smallest permitted speed factor.
    pub const SPEED_MIN: f64 = 0.01;

    /// Sets the speed factor.
    #[must_use]
    pub fn speed(mut self, speed: f64) -> Self {
        self.speed = speed;
        self
    }

    /// Sets the recorded positions that the arm should follow.
    #[must_use]
    pub fn source(mut self, source: ReplaySource) -> Self {
        self.source = source;
        self
    }

    /// Sets the kind of targets.
    #[must_use]
    pub fn targets(mut self, targets: ReplayTargets) -> Self {
        self.targets = targets;
        self
    }
}

/// A recorded motion that is prepared for an arm.
#[derive(Clone, Debug)]
pub struct ReplayPlan {
    kind: RobotKind,
    pub(super) targets: ReplayTargets,
    /// Joint positions at intervals of [`PERIOD`].
    pub(super) points: Vec<[f64; 7]>,
    /// Measured positions at the times of `points`.
    pub(super) measured: Vec<[f64; 7]>,
    /// Pose of the recorded end effector in the flange frame.
    pub(super) tool: Isometry3<f64>,
    budget: Budget,
    speed: f64,
}

impl ReplayPlan {
    /// Prepares the motion in `samples` for an arm with this model. `recorded` is the kind of the
    /// recorded robot.
    ///
    /// # Errors
    /// Returns [`ReplayError`] if the recording cannot be replayed. To find out whether the arm can
    /// reach the targets from a given state, call [`Self::check`].
    pub fn new(
        recorded: RobotKind,
        samples: &[Sample],
        options: ReplayOptions,
        model: &Model,
    ) -> Result<Self, ReplayError> {
        let expected = model.kind();
        if recorded != expected {
            return Err(ReplayError::Kind {
                got: recorded,
                expected,
            });
        }
        if !(ReplayOptions::SPEED_MIN..=1.0).contains(&options.speed) {
            return Err(ReplayError::Speed { got: options.speed });
        }
        let samples = match options.source {
            ReplaySource::Reference => told(samples),
            ReplaySource::Measured => samples,
        };
        check_times(samples)?;
        let followed = followed(samples, options.source)?;
        let measured: Vec<_> = samples.iter().map(|sample| sample.q).collect();
        let flange = pose_at(model, &samples[0].q, &Isometry3::identity());
        let tool = flange.inverse() * samples[0].pose;
        let points = resampled(samples, &followed, options.speed);
        let budget = budget(model, &points, &tool, options.speed)?;
        Ok(Self {
            kind: expected,
            targets: options.targets,
            measured: resampled(samples, &measured, options.speed),
            points,
            tool,
            budget,
            speed: options.speed,
        })
    }

    /// Returns the kind of robot of the replay.
    pub fn kind(&self) -> RobotKind {
        self.kind
    }

    /// Returns the joint positions of the first target, `[rad]`. The arm must be at rest there when
    /// the replay begins.
    pub fn start(&self) -> [f64; 7] {
        self.points[0]
    }

    /// Returns the duration of the replay.
    pub fn duration(&self) -> Duration {
        PERIOD * (self.points.len() as u32 - 1)
    }

    /// Returns the speed factor of the replay. The motion to the first target uses the same factor
    /// of its usual speed.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Returns the limits for the arm. They are a quarter larger than the motion requires, and at
    /// least as large as the limits of other goals.
    pub fn budget(&self) -> Budget {
        self.budget
    }

    /// Checks all targets for an arm that is in this state.
    ///
    /// # Errors
    /// Returns [`ReplayError::Target`] for the first target that is outside the limits or out of
    /// reach, and [`ReplayError::Kind`] if the arm is of a different kind.
    pub fn check(&self, model: &Model, state: &RobotState) -> Result<(), ReplayError> {
        if model.kind() != self.kind {
            return Err(ReplayError::Kind {
                got: self.kind,
                expected: model.kind(),
            });
        }
        let mut begin = 0;
        while begin < self.points.len() {
            let end = (begin + Chunk::POINTS_MAX).min(self.points.len());
            let after = PERIOD * begin as u32;
            let of_target = |error| ReplayError::Target { after, error };
            let chunk = self.chunk(model, begin..end)?;
            chunk.check(model, state).map_err(of_target)?;
            begin = end;
        }
        Ok(())
    }

    /// Returns the motion through these targets. The chunk starts at the first target.
    pub(super) fn chunk(
        &self,
        model: &Model,
        range: core::ops::Range<usize>,
    ) -> Result<Chunk, ReplayError> {
        let after = PERIOD * range.start as u32;
        let points = self.points[range].iter().zip(0_u32..);
        let points = points.map(|(q, place)| (PERIOD * place, *q));
        let chunk = match self.targets {
            ReplayTargets::Joints => Chunk::joints(points),
            ReplayTargets::Poses => {
                let pose = |q: &[f64; 7]| pose_at(model, q, &self.tool);
                Chunk::poses(points.map(|(time, q)| (time, pose(&q))))
            }
        };
        chunk.map_err(|error| ReplayError::Chunk { after, error })
    }
}

pub(super) fn pose_at(model: &Model, q: &[f64; 7], tool: &Isometry3<f64>) -> Isometry3<f64> {
    let q = JointVector::from(*q);
    let flange = model.pose(Frame::Flange, &q, &EndEffector::default());
    let flange = transform::isometry(&flange).expect("a model has rigid links");
    flange * tool
}

/// Checks that the times of the cycles increase and that the cycles have no large gaps.
fn check_times(samples: &[Sample]) -> Result<(), ReplayError> {
    if samples.len() < 2 {
        return Err(ReplayError::Short { got: samples.len() });
    }
    for pair in samples.windows(2) {
        let (from, to) = (pair[0].time, pair[1].time);
        if to <= from || to - from > GAP_MAX {
            return Err(ReplayError::Gap { from, to });
        }
    }
    Ok(())
}

/// Returns the joint positions that the arm should follow, one for each sample.
fn followed(samples: &[Sample], source: ReplaySource) -> Result<Vec<[f64; 7]>, ReplayError> {
    let of = |(i, sample): (usize, &Sample)| {
        let q = match source {
            ReplaySource::Reference => sample
                .q_ref
                .ok_or(ReplayError::Uncontrolled { time: sample.time })?,
            ReplaySource::Measured => averaged(samples, i),
        };
        let is_finite = q.iter().chain(&sample.q).all(|x| x.is_finite());
        let time = sample.time;
        is_finite
            .then_some(q)
            .ok_or(ReplayError::NotFinite { time })
    };
    samples.iter().enumerate().map(of).collect()
}

/// Returns the mean of the measured positions near sample `i`, over equal periods before and after
/// the sample.
fn averaged(samples: &[Sample], i: usize) -> [f64; 7] {
    let time = samples[i].time;
    let room = (time - samples[0].time).min(samples[samples.len() - 1].time - time);
    let half = room.min(HALF_WINDOW);
    let before = samples[..i]
        .iter()
        .rev()
        .take_while(|it| it.time + half >= time);
    let after = samples[i..].iter().take_while(|it| it.time <= time + half);
    let (mut sum, mut count) = ([0.0; 7], 0.0);
    for sample in before.chain(after) {
        count += 1.0;
        for (sum, q) in sum.iter_mut().zip(&sample.q) {
            *sum += q;
        }
    }
    sum.map(|sum| sum / count)
}

/// Returns the positions at the times of the targets, linearly interpolated between samples.
fn resampled(samples: &[Sample], q: &[[f64; 7]], speed: f64) -> Vec<[f64; 7]> {
    let begin = samples[0].time;
    let step = PERIOD.as_secs_f64() * 1e3 * speed;
    let last = (samples[samples.len() - 1].time - begin) as f64;
    // The last target is at most one step before the last sample.
    let count = (last / step + 1e-9).floor() as usize + 1;
    let mut next = 1;
    let at = |k: usize| {
        let time = step * k as f64;
        while next + 1 < samples.len() && ((samples[next].time - begin) as f64) < time {
            next += 1;
        }
        let [from, to] = [next - 1, next].map(|i| (samples[i].time - begin) as f64);
        let share = ((time - from) / (to - from)).clamp(0.0, 1.0);
        core::array::from_fn(|i| q[next - 1][i] + (q[next][i] - q[next - 1][i]) * share)
    };
    (0..count.max(2)).map(at).collect()
}

/// Returns the limits that the motion requires, plus a reserve.
fn budget(
    model: &Model,
    points: &[[f64; 7]],
    tool: &Isometry3<f64>,
    speed: f64,
) -> Result<Budget, ReplayError> {
    let limits = model.joint_limits();
    let step = PERIOD.as_secs_f64();
    let mut peak = [[0.0_f64; 2]; 7];
    for three in points.windows(3) {
        for (i, [velocity, acceleration]) in peak.iter_mut().enumerate() {
            let [a, b, c] = [three[0][i], three[1][i], three[2][i]];
            *velocity = velocity.max((b - a).abs() / step).max((c - b).abs() / step);
            *acceleration = acceleration.max((c - 2.0 * b + a).abs() / (step * step));
        }
    }
    for (i, [velocity, _]) in peak.iter().enumerate() {
        let most = VELOCITY_SHARE_MAX * limits.velocity[i];
        if *velocity > most {
            return Err(ReplayError::Fast {
                joint: i + 1,
                got: *velocity,
                most,
                speed: speed * most / velocity,
            });
        }
    }
    let share = |i: usize| {
        let [velocity, acceleration] = peak[i];
        let needed = (velocity / limits.velocity[i]).max(acceleration / limits.acceleration[i]);
        (RESERVE * needed).clamp(Budget::JOINT_SHARE, 1.0)
    };
    let mut budget = Budget::of(limits);
    budget.joints = core::array::from_fn(|i| AxisLimits {
        velocity: share(i) * limits.velocity[i],
        acceleration: share(i) * limits.acceleration[i],
        jerk: share(i) * limits.jerk[i],
    });
    let poses: Vec<_> = points.iter().map(|q| pose_at(model, q, tool)).collect();
    let ends = model.cartesian_limits();
    for pair in poses.windows(2) {
        let way = (pair[1].translation.vector - pair[0].translation.vector).norm();
        let turn = rotation::error(&pair[1].rotation, &pair[0].rotation).norm();
        for (axis, way, most) in [
            (&mut budget.translation, way, &ends.translation),
            (&mut budget.rotation, turn, &ends.rotation),
        ] {
            axis.velocity = axis.velocity.max(RESERVE * way / step).min(most.velocity);
        }
    }
    for (axis, most) in [
        (&mut budget.translation, &ends.translation),
        (&mut budget.rotation, &ends.rotation),
    ] {
        // A recorded motion stays within the robot's limits, regardless of its goals.
        axis.acceleration = most.acceleration;
        axis.jerk = most.jerk;
    }
    Ok(budget)
}

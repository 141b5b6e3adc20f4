//! Policies that make a new prediction while the arm still lags behind the last prediction.

use core::f64::consts::TAU;

use franka_model::{JointVector, READY, rotation};
use nalgebra::{Isometry3, Translation3, Vector3};

use super::{Arm, GOAL, Session, ms, start};
use crate::session::chunk::Chunk;
use crate::session::{OnArrival, Target};

/// Times of a policy's observations and chunks, in milliseconds.
#[derive(Clone, Copy, Debug)]
struct Rhythm {
    period: u64,
    latency: u64,
    /// Time between points, and time from the observation to the first point.
    step: u64,
    points: u64,
    blend: u64,
}

const RHYTHMS: [Rhythm; 7] = [
    rhythm(100, 0, 100, 16, 100),
    rhythm(100, 50, 100, 16, 100),
    rhythm(100, 120, 50, 16, 100),
    rhythm(100, 150, 20, 50, 100),
    rhythm(50, 150, 20, 50, 50),
    rhythm(50, 0, 100, 16, 100),
    rhythm(20, 60, 200, 16, 100),
];

const fn rhythm(period: u64, latency: u64, step: u64, points: u64, blend: u64) -> Rhythm {
    Rhythm {
        period,
        latency,
        step,
        points,
        blend,
    }
}

impl Rhythm {
    /// Returns the time of the observation whose chunk arrives in this cycle, if any.
    fn observed(&self, cycle: u64) -> Option<u64> {
        let observed = cycle.checked_sub(self.latency)?;
        observed.is_multiple_of(self.period).then_some(observed)
    }

    /// Returns the times of a chunk's points after its observation.
    fn offsets(&self) -> impl Iterator<Item = u64> + use<> {
        let step = self.step;
        (1..=self.points).map(move |k| step * k)
    }
}

#[derive(Clone, Copy, Debug)]
enum Axis {
    /// Translation along y, `[m]`.
    Along,
    /// Rotation about x, by 2 rad for each metre of translation.
    About,
}

impl Axis {
    fn pose(self, from: &Isometry3<f64>, s: f64) -> Isometry3<f64> {
        let (way, turn) = match self {
            Self::Along => (Vector3::y() * s, Vector3::zeros()),
            Self::About => (Vector3::zeros(), Vector3::x() * (2.0 * s)),
        };
        Isometry3::from_parts(
            Translation3::from(from.translation.vector + way),
            rotation::exp(&turn) * from.rotation,
        )
    }

    fn of(self, from: &Isometry3<f64>, pose: &Isometry3<f64>) -> f64 {
        match self {
            Self::Along => pose.translation.y - from.translation.y,
            Self::About => rotation::error(&pose.rotation, &from.rotation).x / 2.0,
        }
    }
}

/// Runs a policy. Its points are `predict(observation, time, s)`, each at its own time, in seconds.
/// Returns the place of the reference in each cycle.
fn run(
    axis: Axis,
    rhythm: Rhythm,
    cycles: u64,
    predict: impl Fn(f64, f64, f64) -> f64,
) -> Vec<f64> {
    let mut arm = Arm::default_budget();
    let (from, begin) = (start(arm.model), arm.now);
    let mut seen = vec![0.0];
    for cycle in 0..cycles {
        if let Some(observed) = rhythm.observed(cycle) {
            let (saw, time) = (seen[observed as usize], observed as f64 * 1e-3);
            let point = |offset: u64| {
                let s = predict(saw, time, time + offset as f64 * 1e-3);
                (ms(offset), axis.pose(&from, s))
            };
            let chunk = Chunk::poses(rhythm.offsets().map(point)).unwrap();
            let chunk = chunk.observed_at(begin + observed).blend(ms(rhythm.blend));
            arm.writer.send(GOAL, chunk).unwrap();
        }
        arm.cycle(1);
        seen.push(axis.of(&from, &arm.pose().pose));
    }
    seen
}

/// Returns a sine of 0.4 Hz. It begins in motion, so the arm lags at first.
fn sine(amplitude: f64, t: f64) -> f64 {
    amplitude * (TAU * 0.4 * t).sin()
}

fn farthest(seen: &[f64]) -> f64 {
    seen.iter().fold(0.0, |most, s| most.max(s.abs()))
}

#[test]
fn lag_does_not_grow_from_chunk_to_chunk() {
    // Half the acceleration of the default budget.
    for (axis, rhythm) in RHYTHMS
        .into_iter()
        .flat_map(|it| [(Axis::Along, it), (Axis::About, it)])
    {
        let seen = run(axis, rhythm, 6000, |_, _, t| sine(0.04, t));
        let most = farthest(&seen);
        assert!(most < 0.042, "{axis:?}, {rhythm:?}: {most} of 0.04");
        let off = seen.iter().enumerate().skip(2000);
        let off: Vec<_> = off
            .map(|(ms, s)| s - sine(0.04, ms as f64 * 1e-3))
            .collect();
        let off = farthest(&off);
        assert!(off < 2e-3, "{axis:?}, {rhythm:?}: {off}");
    }
}

/// The same for joints, in a session.
#[test]
fn joints_that_lag_behind_do_not_swing_in_a_session() {
    let rhythm = rhythm(50, 150, 20, 50, 50);
    let mut session = Session::new();
    let begin = session.state.message_id;
    let mut most = 0.0_f64;
    for cycle in 0..6000 {
        if let Some(observed) = rhythm.observed(cycle) {
            let point = |offset: u64| {
                let s = sine(0.1, (observed + offset) as f64 * 1e-3);
                (ms(offset), (READY + JointVector::repeat(s)).into())
            };
            let chunk = Chunk::joints(rhythm.offsets().map(point)).unwrap();
            let chunk = chunk.observed_at(begin + observed).blend(ms(rhythm.blend));
            session.chunks.send(GOAL, chunk).unwrap();
        }
        if cycle == 0 {
            session.set(GOAL.0, Target::Rest, OnArrival::Hold);
        }
        session.run(1);
        session.fates();
        most = most.max((JointVector::from(session.state.q) - READY).amax());
    }
    assert!((0.099..0.101).contains(&most), "{most} rad of 0.1");
}

/// Checks the figures of the book's chapter on chunks.
#[test]
fn chunks_beyond_the_limits_overshoot_as_the_book_says() {
    for rhythm in RHYTHMS {
        let seen = run(Axis::Along, rhythm, 6000, |_, _, t| sine(0.1, t));
        let most = farthest(&seen);
        assert!((0.115..0.16).contains(&most), "{rhythm:?}: {most} m of 0.1");
    }
}

/// Checks the figures of the same chapter.
#[test]
fn a_chunk_that_ends_in_motion_is_passed_and_come_back_to() {
    for (speed, points, passed) in [(0.1, 40, 0.013), (0.2, 20, 0.062)] {
        let rhythm = rhythm(6000, 0, 50, points, 100);
        let seen = run(Axis::Along, rhythm, 6000, |_, _, t| speed * t);
        let off = farthest(&seen) - 0.2;
        assert!((off - passed).abs() < 1e-3, "{speed} m/s: {off} m");
        assert!((seen[6000] - 0.2).abs() < 1e-4, "{} m", seen[6000]);
    }
}

#[test]
fn a_policy_that_predicts_from_where_the_arm_is_gets_on() {
    for rhythm in RHYTHMS {
        let seen = run(Axis::Along, rhythm, 3000, |saw, then, t| {
            saw + 0.1 * (t - then)
        });
        let speeds = seen.windows(2).skip(1000).map(|y| (y[1] - y[0]) * 1e3);
        let (least, most) = speeds.fold((f64::INFINITY, 0.0_f64), |(least, most), v| {
            (least.min(v), most.max(v))
        });
        assert!(seen[1000] > 0.045, "{rhythm:?}: {} m", seen[1000]);
        let steady = least > 0.08 && most < 0.13;
        assert!(steady, "{rhythm:?}: {least} to {most} m/s");
    }
}

/// A chunk may jump, and the next chunk may arrive at any time during the jump. The arm stays
/// between the two chunks. If the next chunk leads to the arm's place, the arm stays there.
#[test]
fn a_jump_that_another_chunk_cuts_off_is_not_carried_on() {
    let cases = [480, 510, 525, 540, 560]
        .map(|at| [0.0, 0.05].map(|end| [100, 300, 1000].map(|blend| (at, end, blend))));
    for (at, end, blend) in cases.into_iter().flatten().flatten() {
        let mut arm = Arm::default_budget();
        let from = start(arm.model);
        let jump = [
            (0, 0.0),
            (450, 0.0),
            (500, 0.0),
            (550, 0.05),
            (600, 0.05),
            (3000, 0.05),
        ];
        let jump = jump.map(|(time, y)| (ms(time), Axis::Along.pose(&from, y)));
        let chunk = Chunk::poses(jump).unwrap().observed_at(arm.now);
        arm.writer.send(GOAL, chunk).unwrap();
        let (mut least, mut most) = (0.0_f64, 0.0_f64);
        for cycle in 0..4000 {
            if cycle == at {
                let points = [0, 2000].map(|time| (ms(time), Axis::Along.pose(&from, end)));
                let chunk = Chunk::poses(points).unwrap().observed_at(arm.now);
                arm.writer.send(GOAL, chunk.blend(ms(blend))).unwrap();
            }
            arm.cycle(1);
            let y = Axis::Along.of(&from, &arm.pose().pose);
            (least, most) = (least.min(y), most.max(y));
        }
        let bound = if end == 0.0 { 0.013 } else { 0.0505 };
        let case = format!("at {at} to {end}, blend {blend}: {least} to {most} m");
        assert!(least > -0.007 && most < bound, "{case}");
    }
}

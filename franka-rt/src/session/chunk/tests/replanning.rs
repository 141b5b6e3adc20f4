//! Policies that predict anew while the arm is still behind what they have predicted.

use core::f64::consts::TAU;

use franka_model::rotation;
use nalgebra::{Isometry3, Translation3, Vector3};

use super::{Arm, GOAL, ms, start};
use crate::session::chunk::Chunk;

/// When a policy predicts, and what its chunks are like, in milliseconds.
#[derive(Clone, Copy, Debug)]
struct Rhythm {
    period: u64,
    latency: u64,
    /// From point to point, and from the observation to the first one.
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

/// Runs a policy whose points are `predict(what it saw, the time since the begin of each point)`,
/// `[m]` along y, and a tenth of that in radians about x. Returns where the reference was in each
/// cycle, `[m]`.
fn run(
    rhythm: Rhythm,
    cycles: u64,
    predict: impl Fn(f64, f64) -> Box<dyn Fn(f64) -> f64>,
) -> Vec<f64> {
    let mut arm = Arm::default_budget();
    let (from, begin) = (start(arm.model), arm.now);
    let mut seen = vec![0.0];
    for cycle in 0..cycles {
        if cycle >= rhythm.latency && (cycle - rhythm.latency).is_multiple_of(rhythm.period) {
            let observed = cycle - rhythm.latency;
            let time = |k: u64| (observed + rhythm.step * k) as f64 * 1e-3;
            let at = predict(seen[observed as usize], time(0));
            let pose = |k: u64| {
                let y = at(time(k));
                Isometry3::from_parts(
                    Translation3::from(from.translation.vector + Vector3::y() * y),
                    rotation::exp(&(Vector3::x() * (0.1 * y))) * from.rotation,
                )
            };
            let points = (1..=rhythm.points).map(|k| (ms(rhythm.step * k), pose(k)));
            let chunk = Chunk::poses(points).unwrap().observed_at(begin + observed);
            let chunk = chunk.blend(ms(rhythm.blend));
            arm.writer.send(GOAL, chunk).unwrap();
        }
        arm.cycle(1);
        seen.push(arm.pose().pose.translation.vector.y - from.translation.vector.y);
    }
    seen
}

fn farthest(seen: &[f64]) -> f64 {
    seen.iter().fold(0.0, |most, y| most.max(y.abs()))
}

#[test]
fn what_the_arm_lags_behind_does_not_grow_from_chunk_to_chunk() {
    // From rest onto a sine of 40 mm and 0.4 Hz: half the acceleration of the default budget, which
    // the arm is 10 mm behind at first.
    let sine = |t: f64| 0.04 * (TAU * 0.4 * t).sin();
    for rhythm in RHYTHMS {
        let seen = run(rhythm, 6000, |_, _| Box::new(sine));
        let most = farthest(&seen);
        assert!(most < 0.0405, "{rhythm:?}: {most} m of 0.04");
        let off = seen.iter().enumerate().skip(2000);
        let off = off.map(|(ms, y)| (y - sine(ms as f64 * 1e-3)).abs());
        let off = off.fold(0.0, f64::max);
        assert!(off < 1e-3, "{rhythm:?}: {off} m");
    }
}

/// The figure of the book's chapter on chunks.
#[test]
fn what_asks_for_more_than_the_limits_is_overshot_by_60_mm_at_most() {
    let sine = |t: f64| 0.1 * (TAU * 0.4 * t).sin();
    for rhythm in RHYTHMS {
        let seen = run(rhythm, 6000, |_, _| Box::new(sine));
        let most = farthest(&seen);
        assert!((0.115..0.16).contains(&most), "{rhythm:?}: {most} m of 0.1");
    }
}

/// The figures of the same chapter.
#[test]
fn a_chunk_that_ends_in_motion_is_passed_and_come_back_to() {
    for (speed, points, passed) in [(0.1, 40, 0.013), (0.2, 20, 0.062)] {
        let seen = run(rhythm(6000, 0, 50, points, 100), 6000, |_, _| {
            Box::new(move |t| speed * t)
        });
        let off = farthest(&seen) - 0.2;
        assert!((off - passed).abs() < 1e-3, "{speed} m/s: {off} m");
        assert!((seen[6000] - 0.2).abs() < 1e-4, "{} m", seen[6000]);
    }
}

#[test]
fn a_policy_that_predicts_from_where_the_arm_is_gets_on() {
    // 0.1 m/s from wherever it is.
    for rhythm in RHYTHMS {
        let seen = run(rhythm, 3000, |y, from| {
            Box::new(move |t| y + 0.1 * (t - from))
        });
        let speeds = seen.windows(2).skip(1000).map(|y| (y[1] - y[0]) * 1e3);
        let (least, most) = speeds.fold((f64::INFINITY, 0.0_f64), |(least, most), v| {
            (least.min(v), most.max(v))
        });
        assert!(seen[1000] > 0.045, "{rhythm:?}: {} m", seen[1000]);
        assert!(
            least > 0.08 && most < 0.13,
            "{rhythm:?}: {least} to {most} m/s"
        );
    }
}

/// A chunk may jump, and the next one come at any time of the jump: the arm stays between them.
#[test]
fn a_jump_that_another_chunk_cuts_off_is_not_carried_on() {
    let still = |from: &Isometry3<f64>, y: f64| {
        Isometry3::from_parts(
            Translation3::from(from.translation.vector + Vector3::y() * y),
            from.rotation,
        )
    };
    let cases = [480, 510, 525, 540, 560]
        .map(|at| [0.0, 0.05].map(|end| [100, 300, 1000].map(|blend| (at, end, blend))));
    for (at, end, blend) in cases.into_iter().flatten().flatten() {
        let mut arm = Arm::default_budget();
        let (from, begin) = (start(arm.model), arm.now);
        let jump = [
            (0, 0.0),
            (450, 0.0),
            (500, 0.0),
            (550, 0.05),
            (600, 0.05),
            (3000, 0.05),
        ];
        let jump = jump.map(|(time, y)| (ms(time), still(&from, y)));
        let chunk = Chunk::poses(jump).unwrap().observed_at(begin);
        arm.writer.send(GOAL, chunk).unwrap();
        let (mut least, mut most) = (0.0_f64, 0.0_f64);
        for cycle in 0..4000 {
            if cycle == at {
                let points = [0, 2000].map(|time| (ms(time), still(&from, end)));
                let chunk = Chunk::poses(points).unwrap().observed_at(arm.now);
                arm.writer.send(GOAL, chunk.blend(ms(blend))).unwrap();
            }
            arm.cycle(1);
            let y = arm.pose().pose.translation.vector.y - from.translation.vector.y;
            (least, most) = (least.min(y), most.max(y));
        }
        assert!(
            least > -0.007 && most < 0.0505,
            "at {at} to {end}, blend {blend}: {least} to {most} m"
        );
    }
}

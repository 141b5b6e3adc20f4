//! Random targets, gains and chunks.

use std::time::Duration;

use franka_model::READY;
use franka_rt::law::{Gains, Law};
use franka_rt::session::condition::{Axis, Quantity, contact, elapsed, force};
use franka_rt::session::{Chunk, Leash, Reaction, Target};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::Rng;
use rand::rngs::SmallRng;

/// A pose within `way` metres and `turn` radians of `near`, along each axis.
pub(super) fn pose(random: &mut SmallRng, near: &Isometry3<f64>, way: f64, turn: f64) -> Target {
    let mut vector = |most: f64| Vector3::from_fn(|_, _| random.random_range(-most..most));
    let (way, turn) = (vector(way), vector(turn));
    Target::Pose(Isometry3::from_parts(
        Translation3::from(near.translation.vector + way),
        UnitQuaternion::from_scaled_axis(turn) * near.rotation,
    ))
}

/// Joint positions within `most` radians of the ready pose.
pub(super) fn joints(random: &mut SmallRng, most: f64) -> [f64; 7] {
    core::array::from_fn(|i| READY[i] + random.random_range(-most..most))
}

/// Gains of either law, with half to twice the stiffness of the presets.
pub(super) fn gains(random: &mut SmallRng) -> Gains {
    let mut gains = match random.random_range(0..4) {
        0 => Gains::joint(),
        1 => Gains {
            law: Law::OperationalSpace,
            ..Gains::cartesian()
        },
        2 => Gains {
            project_joint_gains: true,
            feedforward_cutoff: 50.0,
            ..Gains::cartesian()
        },
        _ => Gains::cartesian(),
    };
    let factor: f64 = random.random_range(0.5..2.0);
    let damping = factor.sqrt();
    gains.cartesian_stiffness = gains.cartesian_stiffness.map(|k| k * factor);
    gains.cartesian_damping = gains.cartesian_damping.map(|d| d * damping);
    gains.torque_cutoff = [100.0, 100.0, 50.0, 1000.0][random.random_range(0..4)];
    gains
}

/// A leash of any length, some of the time.
pub(super) fn leash(random: &mut SmallRng) -> Option<Leash> {
    let share = random
        .random_bool(0.3)
        .then(|| random.random_range(0.0..1.0))?;
    let length = |least: f64, most: f64| least + share * (most - least);
    let (least, most) = (Leash::LEAST, Leash::MOST);
    Some(Leash {
        translation: length(least.translation, most.translation),
        rotation: length(least.rotation, most.rotation),
        joints: length(least.joints, most.joints),
    })
}

/// Sometimes a condition, which becomes true sooner or later, or never, and the arm's destination
/// then: rest, or a target.
pub(super) fn reaction(
    random: &mut SmallRng,
    near: &Isometry3<f64>,
    poses: bool,
) -> Option<Reaction> {
    if random.random_bool(0.7) {
        return None;
    }
    let time = Duration::from_millis(random.random_range(0..500));
    let condition = match random.random_range(0..5) {
        0 | 1 => elapsed(time),
        2 => Quantity::Speed.above(random.random_range(0.01..0.2)) & elapsed(time),
        3 => Quantity::Position(Axis::Z).beyond(0.02).relative(),
        _ => force(random.random_range(5.0..30.0)) | contact(),
    };
    Some(match random.random_range(0..4) {
        0 | 1 => condition.into(),
        2 if !poses => condition.then(joints(random, 0.3)),
        _ => condition.then(pose(random, near, 0.1, 0.3)),
    })
}

/// A posture near these joint positions, some of the time.
pub(super) fn posture(random: &mut SmallRng, q: &[f64; 7]) -> Option<[f64; 7]> {
    let drawn = random.random_bool(0.3);
    drawn.then(|| q.map(|q| q + random.random_range(-0.3..0.3)))
}

/// A chunk of either kind, from about the present position to a target nearby.
pub(super) fn chunk(random: &mut SmallRng, q: &[f64; 7], pose: &Isometry3<f64>, now: u64) -> Chunk {
    let points = random.random_range(2..16);
    let spacing = Duration::from_millis(random.random_range(10..60));
    let times = (0..points).map(move |k| (spacing * k, f64::from(k) / f64::from(points - 1)));
    let chunk = if random.random_bool(0.5) {
        let way = Vector3::from_fn(|_, _| random.random_range(-0.06..0.06));
        let turn = Vector3::from_fn(|_, _| random.random_range(-0.15..0.15));
        let pose = *pose;
        Chunk::poses(times.map(move |(time, share)| {
            let at = Isometry3::from_parts(
                Translation3::from(pose.translation.vector + way * share),
                UnitQuaternion::from_scaled_axis(turn * share) * pose.rotation,
            );
            (time, at)
        }))
    } else {
        let way: [f64; 7] = core::array::from_fn(|_| random.random_range(-0.15..0.15));
        let q = *q;
        Chunk::joints(times.map(move |(time, share)| {
            let at = core::array::from_fn(|i| q[i] + way[i] * share);
            (time, at)
        }))
    };
    let chunk = chunk.expect("points far enough apart");
    let chunk = match random.random_range(0..3) {
        0 => chunk.replace(),
        _ => chunk,
    };
    match random.random_range(0..3) {
        0 => chunk,
        _ => chunk.observed_at(now.saturating_sub(random.random_range(0..200))),
    }
}

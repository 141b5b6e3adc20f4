//! Tests of paths: limits, corners, closeness to the least time, and reachable places.

use franka_model::collision::Obstacle;
use franka_model::{EndEffector, READY, rotation};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use super::fastest::Timed;
use super::legs::share;
use super::*;
use crate::session::chunk::course::{ChunkCourse, ChunkStart};
use crate::session::chunk::curve::Curve;
use crate::session::chunk::curve_state::CurveState;
use crate::session::kinematics::Drift;
use crate::session::pose::PoseState;
use crate::session::reference::Reference;
use crate::session::tests::sample;
use crate::session::{Budget, GoalId, OnArrival};

const STEP: f64 = 1e-4;

fn state() -> RobotState {
    let identity = Isometry3::<f64>::identity().to_homogeneous();
    let rigid: [f64; 16] = identity.as_slice().try_into().expect("sixteen numbers");
    RobotState {
        q: READY.into(),
        F_T_EE: rigid,
        EE_T_K: rigid,
        ..RobotState::default()
    }
}

fn goal(model: &Model, speed: f64) -> Goal {
    let goal = Goal::new(
        GoalId(1),
        Target::Rest,
        OnArrival::Hold,
        model.joint_limits(),
    );
    Goal {
        budget: goal.budget.scaled(speed),
        ..goal
    }
}

fn over_joints(places: &[(JointVector, f64)]) -> Vec<Waypoint> {
    let waypoint =
        |(q, blend): &(JointVector, f64)| Waypoint::new(<[f64; 7]>::from(*q)).blend(*blend);
    places.iter().map(waypoint).collect()
}

fn number(random: &mut SmallRng) -> f64 {
    random.random_range(-1.0..1.0)
}

fn vector(random: &mut SmallRng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| number(random))
}

/// Returns joint positions around the ready pose, with random corners of at least `least`.
fn random_joints(random: &mut SmallRng, spread: f64, least: f64) -> Vec<(JointVector, f64)> {
    let count = random.random_range(2..8);
    let place = |_| {
        let q = READY + JointVector::from_fn(|_, _| spread * number(random));
        (q, random.random_range(-0.1..0.3_f64).max(least))
    };
    (0..count).map(place).collect()
}

/// Returns poses in front of the arm, with random corners of at least `least`.
fn random_poses(random: &mut SmallRng, least: f64) -> Vec<(Isometry3<f64>, f64)> {
    let down = UnitQuaternion::from_euler_angles(core::f64::consts::PI, 0.0, 0.0);
    let count = random.random_range(2..8);
    let place = |_| {
        let size = Vector3::new(0.1, 0.2, 0.15);
        let at = Vector3::new(0.45, 0.0, 0.45) + size.component_mul(&vector(random));
        let turn = rotation::exp(&(vector(random) * 0.4));
        let pose = Isometry3::from_parts(Translation3::from(at), turn * down);
        (pose, random.random_range(-0.03..0.1_f64).max(least))
    };
    (0..count).map(place).collect()
}

fn over_poses(places: &[(Isometry3<f64>, f64)]) -> Vec<Waypoint> {
    let waypoint = |(pose, blend): &(Isometry3<f64>, f64)| Waypoint::new(*pose).blend(*blend);
    places.iter().map(waypoint).collect()
}

fn curve_of_joints(chunk: &Chunk) -> &Curve<Reference> {
    match &chunk.points {
        Points::Joints(curve) => curve,
        Points::Poses(_) => panic!("joints"),
    }
}

fn curve_of_poses(chunk: &Chunk) -> &Curve<PoseState> {
    match &chunk.points {
        Points::Poses(curve) => curve,
        Points::Joints(_) => panic!("poses"),
    }
}

/// Returns each state of a curve and the state before it, [`STEP`] apart.
fn steps<M: CurveState>(curve: &Curve<M>) -> impl Iterator<Item = (M, M)> {
    let at = |step: u32| curve.at(f64::from(step) * STEP);
    (1..=(curve.end() / STEP) as u32).map(move |step| (at(step - 1), at(step)))
}

#[test]
fn joints_keep_limits_and_corner_sizes_on_random_paths() {
    let mut random = SmallRng::seed_from_u64(17);
    let model = Model::fr3();
    for case in 0..sample(40, 7) {
        let goal = goal(model, random.random_range(0.3..2.0));
        let mut places = random_joints(&mut random, 0.3, 0.0);
        let waypoints = over_joints(&places);
        places.insert(0, (READY, 0.0));
        let chunk = Chunk::through(&waypoints, &READY.into(), &goal, model, &state()).unwrap();
        let curve = curve_of_joints(&chunk);
        let mut least = vec![f64::INFINITY; places.len()];
        for (before, now) in steps(curve) {
            for (least, (place, _)) in least.iter_mut().zip(&places) {
                *least = least.min((now.q - place).norm());
            }
            for (i, limits) in goal.budget.joints.iter().enumerate() {
                let jump = (now.ddq[i] - before.ddq[i]).abs() / STEP;
                assert!(now.dq[i].abs() < limits.velocity, "case {case}: {now:?}");
                assert!(
                    now.ddq[i].abs() < limits.acceleration,
                    "case {case}: {now:?}"
                );
                assert!(jump < limits.jerk, "case {case}: {jump}");
                let moved = (now.q[i] - before.q[i]).abs();
                assert!(moved < limits.velocity * STEP, "case {case}: {moved}");
            }
        }
        for (least, (_, blend)) in least.iter().zip(&places) {
            assert!(*least <= blend + 1e-4, "case {case}: {least} of {blend}");
        }
        let off = (curve.last().q - places[places.len() - 1].0).amax();
        assert!(off < 1e-12, "case {case}: {off}");
    }
}

#[test]
fn poses_keep_limits_and_corner_sizes_on_random_paths() {
    let mut random = SmallRng::seed_from_u64(18);
    let model = Model::fr3();
    for case in 0..sample(40, 7) {
        let goal = goal(model, random.random_range(0.3..2.0));
        let places = random_poses(&mut random, 0.0);
        let waypoints = over_poses(&places);
        let Ok(chunk) = Chunk::through(&waypoints, &READY.into(), &goal, model, &state()) else {
            continue;
        };
        let mut least = vec![f64::INFINITY; places.len()];
        for (before, now) in steps(curve_of_poses(&chunk)) {
            let at = now.pose.translation.vector;
            for (least, (place, _)) in least.iter_mut().zip(&places) {
                *least = least.min((at - place.translation.vector).norm());
            }
            let jerk = (now.acceleration - before.acceleration) / STEP;
            for (part, limits) in [(0, goal.budget.translation), (3, goal.budget.rotation)] {
                let norm = |twist: &franka_model::Twist| twist.fixed_rows::<3>(part).norm();
                assert!(norm(&now.twist) < limits.velocity, "case {case}: {now:?}");
                let acceleration = norm(&now.acceleration);
                assert!(acceleration < limits.acceleration, "case {case}: {now:?}");
                assert!(norm(&jerk) < limits.jerk, "case {case}: {}", norm(&jerk));
            }
        }
        for (least, (_, blend)) in least.iter().zip(&places) {
            assert!(*least <= blend + 1e-4, "case {case}: {least} of {blend}");
        }
    }
}

#[test]
fn path_of_one_line_takes_as_long_as_the_plan_of_a_goal() {
    let model = Model::fr3();
    let goal = goal(model, 1.0);
    let [middle, there] = [0.1, 0.2].map(|by| READY + JointVector::repeat(by));
    let waypoints = over_joints(&[(middle, 0.05), (there, 0.05)]);
    let chunk = Chunk::through(&waypoints, &READY.into(), &goal, model, &state()).unwrap();
    let (got, expected) = (chunk.end(), duration_of_plan(&goal.budget, &there));
    assert!(
        (got - expected).abs() < 1e-6 * expected,
        "{got} s, {expected} s"
    );
}

fn duration_of_plan(budget: &Budget, there: &JointVector) -> f64 {
    let limits = franka_otg::Limits::per_axis(budget.joints.map(share)).unwrap();
    let start = franka_otg::State::at_rest(READY.into());
    let plan = franka_otg::Generator::towards(start, limits, Some(&(*there).into())).unwrap();
    plan.duration()
}

/// The generator of goals serves as the oracle with jerk limits, because it finds the exact optimum
/// of a line.
#[test]
fn slow_line_is_retimed_to_the_pace_of_a_goals_plan() {
    let model = Model::fr3();
    for (by, jerk) in [
        (0.05, 1.0),
        (0.05, 0.01),
        (0.4, 1.0),
        (0.4, 0.01),
        (1.0, 0.1),
    ] {
        let mut budget = Budget::of(model.joint_limits());
        for joint in &mut budget.joints {
            joint.jerk *= jerk;
        }
        let there = READY + JointVector::repeat(by);
        let expected = duration_of_plan(&budget, &there);
        let slow = Timed {
            times: vec![0.0, 3.0 * expected],
            states: [READY, there].map(Reference::at_rest).into(),
            legs: vec![0, 0],
        };
        let limits = joints::within(budget.joints.map(share));
        let got = slow.retimed(8, &limits).into_curve().end();
        assert!(
            (0.9999..1.005).contains(&(got / expected)),
            "{by} rad, {jerk} of the jerk: {got} s, the plan takes {expected} s"
        );
    }
}

/// Ratios between the durations of paths and their durations without a jerk limit: median, 95 % and
/// maximum.
#[derive(Debug)]
struct Ratios([f64; 3]);

impl Ratios {
    fn of(mut ratios: Vec<f64>) -> Self {
        ratios.sort_by(f64::total_cmp);
        let last = (ratios.len() - 1) as f64;
        Self([0.5, 0.95, 1.0].map(|share| ratios[(share * last).round() as usize]))
    }
}

fn least_duration<M: CurveState, const W: usize, const G: usize>(
    curve: &Curve<M>,
    limits: &fastest::Limits<M, W, G>,
) -> f64 {
    let count = (curve.end() / 2.5e-4).ceil();
    let step = curve.end() / count;
    let at = |k: u32| (limits.derivatives)(&curve.at(f64::from(k) * step));
    let rates: Vec<_> = (0..=count as u32).map(at).collect();
    oracle::least_duration(&rates, step, &limits.of_groups)
}

/// Returns the ratios for random paths whose budget has its jerks multiplied by `jerk`.
fn ratios(over_the_joints: bool, jerk: f64) -> Ratios {
    let mut random = SmallRng::seed_from_u64(5);
    let model = Model::fr3();
    let mut ratios = Vec::new();
    while ratios.len() < sample(50, 5) {
        let mut goal = goal(model, random.random_range(0.5..2.0));
        let limits = goal.budget.joints.iter_mut();
        for limits in limits.chain([&mut goal.budget.translation, &mut goal.budget.rotation]) {
            limits.jerk *= jerk;
        }
        let waypoints = if over_the_joints {
            over_joints(&random_joints(&mut random, 0.5, 0.02))
        } else {
            over_poses(&random_poses(&mut random, 0.005))
        };
        let Ok(chunk) = Chunk::through(&waypoints, &READY.into(), &goal, model, &state()) else {
            continue;
        };
        let least = match &chunk.points {
            Points::Joints(curve) => {
                least_duration(curve, &joints::within(goal.budget.joints.map(share)))
            }
            Points::Poses(curve) => {
                let limits = [goal.budget.translation, goal.budget.rotation].map(share);
                least_duration(curve, &poses::within(limits))
            }
        };
        ratios.push(chunk.end() / least);
    }
    Ratios::of(ratios)
}

#[test]
fn random_paths_take_hardly_longer_than_a_lower_bound() {
    for (over_the_joints, jerk, most) in
        [(true, 1.0, 1.01), (false, 1.0, 1.03), (false, 10.0, 1.01)]
    {
        let ratios = ratios(over_the_joints, jerk);
        println!("joints: {over_the_joints}, {jerk} times the jerk: {ratios:.4?}");
        let [median, p95, _] = ratios.0;
        assert!(median >= 0.999, "the bound is none: {ratios:?}");
        assert!(p95 < most, "{over_the_joints}, {jerk}: {ratios:?}");
    }
}

/// Result of moving along a path in the control cycle.
#[derive(Debug)]
struct Gone {
    arrives: bool,
    /// Greatest distance of the joints from the path, divided by the permitted distance.
    off: f64,
}

/// Moves along `way` from the joint positions `q` as the control cycle does.
fn go(way: Timed<PoseState>, q: JointVector, budget: &Budget, model: &Model) -> Gone {
    let ee = EndEffector::default();
    let pose_of = |q: &JointVector| rigid(&model.pose(Frame::EndEffector, q, &ee));
    let pace = poses::pace(&way.states, budget);
    let curve = way.into_curve();
    let samples: Vec<_> = {
        let count = (curve.end() / 4e-3).ceil();
        let at = |k: u32| curve.at(curve.end() * f64::from(k) / count).pose;
        (0..=count as u32).map(at).collect()
    };
    let chunk = Chunk {
        pace: Some(pace),
        ..Chunk::of(Points::Poses(curve))
    };
    let still = crate::session::chunk::curve_state::stacked(&Vector3::zeros(), &Vector3::zeros());
    let mut reference = Reference::at_rest(q);
    let start = ChunkStart {
        reference: &reference,
        pose: PoseState {
            pose: pose_of(&q),
            twist: still,
            acceleration: still,
        },
        drift: Drift::of(reference.dq),
        before: None,
        now: 1000,
    };
    let end = chunk.end();
    let mut course = ChunkCourse::new(model, GoalId(1), *budget, chunk, start);
    let posture = Posture::kept(q);
    let off = |q: &JointVector, to: &Isometry3<f64>| reach::Off::between(to, &pose_of(q)).size();
    let mut farthest = 0.0_f64;
    let mut near = 0;
    for now in 1001..1000 + (4e3 * end) as u64 + 4000 {
        reference = course
            .step(model, &ee, (&posture, None), &reference, now)
            .reference;
        // Nearest place of the path, beginning with the last nearest place.
        while near + 1 < samples.len()
            && off(&reference.q, &samples[near + 1]) <= off(&reference.q, &samples[near])
        {
            near += 1;
        }
        farthest = farthest.max(off(&reference.q, &samples[near]));
        if course.is_over(now) {
            let last = samples.len() - 1;
            return Gone {
                arrives: off(&reference.q, &samples[last]) < 2.0,
                off: farthest,
            };
        }
    }
    Gone {
        arrives: false,
        off: farthest,
    }
}

#[test]
fn ways_are_accepted_where_the_control_cycle_gets_along_them() {
    let seed = 23;
    for model in [Model::fr3(), Model::fer()] {
        let mut random = SmallRng::seed_from_u64(seed);
        let limits = model.joint_limits();
        let ee = EndEffector::default();
        let (mut accepted, mut refused, mut farthest) = (0, 0, 0.0_f64);
        while accepted + refused < sample(60, 4) {
            let mut posture = |spread: f64| {
                JointVector::from_fn(|i, _| {
                    let middle = 0.5 * (limits.upper[i] + limits.lower[i]);
                    let half = 0.5 * (limits.upper[i] - limits.lower[i]) - 0.1;
                    let middle = if spread < 1.0 { READY[i] } else { middle };
                    (middle + half * spread * random.random_range(-1.0..1.0))
                        .clamp(limits.lower[i] + 0.1, limits.upper[i] - 0.1)
                })
            };
            let spread = [0.2, 0.4, 0.7][(accepted + refused) % 3];
            let q = posture(spread);
            let places: Vec<_> = (0..3)
                .map(|_| rigid(&model.pose(Frame::EndEffector, &posture(spread), &ee)))
                .map(|pose| (pose, 0.05))
                .collect();
            let budget = Budget::of(limits).scaled(random.random_range(0.5..1.5));
            let start = rigid(&model.pose(Frame::EndEffector, &q, &ee));
            let Ok(way) = poses::through_poses(&over_poses(&places), start, &budget) else {
                continue;
            };
            let arm = Arm {
                posture: &Posture::kept(q),
                budget: &budget,
                model,
                stride: 1.0,
                ee: &ee,
            };
            let verdict = reach::check(&way, q, &arm, &mut |_, _| {});
            let gone = go(way, q, &budget, model);
            let case = (model.kind(), seed, accepted + refused);
            match verdict {
                Ok(()) => {
                    accepted += 1;
                    farthest = farthest.max(gone.off);
                    assert!(gone.arrives, "{case:?}: accepted, {gone:?}");
                }
                Err(error) => {
                    refused += 1;
                    assert!(
                        !gone.arrives || gone.off > 1.0,
                        "{case:?}: {error}, {gone:?}"
                    );
                }
            }
        }
        let kind = model.kind();
        println!("{kind:?}: {accepted} accepted, {refused} refused, off by {farthest:.2} at most");
        assert!(
            accepted.min(refused) > sample(10, 0),
            "{accepted} accepted, {refused} refused"
        );
    }
}

#[test]
fn preview_matches_the_path_in_time_and_refusals() {
    let (model, ee) = (Model::fr3(), EndEffector::default());
    let goal = goal(model, 1.0);
    let q: [f64; 7] = READY.into();
    let pose_of = |q: &[f64; 7]| rigid(&model.pose(Frame::EndEffector, &(*q).into(), &ee));
    let here = pose_of(&q);
    let there = Translation3::new(0.1, -0.2, 0.05) * here;
    let joints = q.map(|q| q + 0.2);
    for waypoint in [Waypoint::new(there), Waypoint::new(joints)] {
        let way = [waypoint];
        let preview = Preview::of(&way, &q, &goal, model, &state()).expect("a path");
        let chunk = Chunk::through(&way, &q, &goal, model, &state()).expect("the same");
        assert!((preview.duration().as_secs_f64() - chunk.end()).abs() < 1e-6);
        assert_eq!(preview.postures[0].1, q);
        for ends in preview.postures.windows(2) {
            assert!(ends[1].0 > ends[0].0);
            for i in 0..7 {
                let turn = (ends[1].1[i] - ends[0].1[i]).abs();
                assert!(turn < 0.05, "{turn} rad between two postures");
            }
        }
    }
    let preview = Preview::of(&[there.into()], &q, &goal, model, &state()).expect("a path");
    let off = reach::Off::between(&there, &pose_of(&preview.end()));
    assert!(off.size() < 1.0, "{off:?}");
    let line = there.translation.vector - here.translation.vector;
    for (_, q) in &preview.postures {
        let way = pose_of(q).translation.vector - here.translation.vector;
        assert!(way.cross(&line.normalize()).norm() < 1e-3);
    }
    let far = [Waypoint::new(Translation3::new(0.5, 0.0, 0.0) * here)];
    let refused = Preview::of(&far, &q, &goal, model, &state());
    let error = Chunk::through(&far, &q, &goal, model, &state()).unwrap_err();
    assert_eq!(refused, Err(error));
    // At its present place, the arm need not move.
    let stays = Preview::of(&[here.into()], &q, &goal, model, &state()).expect("a path");
    assert_eq!(
        (stays.duration(), stays.end()),
        (core::time::Duration::ZERO, q)
    );
}

#[test]
fn a_preview_says_where_the_guards_stop_the_arm() {
    let (model, ee) = (Model::fr3(), EndEffector::default());
    let q: [f64; 7] = READY.into();
    let here = rigid(&model.pose(Frame::EndEffector, &READY, &ee));
    // A block whose top is `below` the flange.
    let blocked = |z: f64, below: f64| {
        let there = [Waypoint::new(Translation3::new(0.0, 0.0, z) * here)];
        let preview = Preview::of(&there, &q, &goal(model, 1.0), model, &state()).expect("a path");
        let block = Obstacle::Box {
            pose: Translation3::new(here.translation.x, 0.0, here.translation.z - below - 0.05)
                .into(),
            half: Vector3::repeat(0.05),
        };
        let regions = [Obstacle::floor(-1.0), block];
        let blocked = preview.blocked(model, &state(), &regions).expect("regions");
        (blocked, preview)
    };
    assert_eq!(blocked(-0.05, 0.2).0, None);
    let (Some(found), preview) = blocked(-0.2, 0.2) else {
        panic!("it comes too near");
    };
    assert_eq!(found.region, Some(2));
    let height = rigid(&model.pose(Frame::EndEffector, &found.q.into(), &ee))
        .translation
        .z;
    let sunk = here.translation.z - height;
    assert!((0.05..0.2).contains(&sunk), "{sunk}");
    assert!(found.time < preview.duration());
    // If the arm begins too near to the block, only the motion outward is free.
    assert_eq!(blocked(0.1, 0.01).0, None);
    assert!(blocked(-0.01, 0.01).0.is_some());
    let too_many = vec![Obstacle::floor(0.0); 5];
    assert!(preview.blocked(model, &state(), &too_many).is_err());
}

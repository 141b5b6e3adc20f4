use super::*;
use crate::session::reference::Reference;
use crate::session::tests::sample;
use franka_model::collision::Body;
use franka_model::geometry::Lengths;
use franka_model::{EndEffector, Frame, Model, READY, RobotKind};
use franka_proto::RobotState;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, UnitVector3, Vector3};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use crate::session::{Budget, Goal, GoalId, OnArrival, Preview, Target, Waypoint, course};

/// True if no obstacle is known to come near within `turns` of `q`.
fn is_clear(clearance: &Clearance, q: &JointVector, turns: &JointVector) -> bool {
    let known = clearance.known.as_ref();
    let candidates = known.map(|known| known.bound.candidates(&clearance.spacing, q, turns));
    candidates.is_some_and(CandidateMask::is_empty)
}

fn of(keep_out: KeepOut) -> Clearance {
    Clearance::new(Model::fr3(), true, keep_out)
}

/// Returns the margin of every checked distance at a posture.
fn margins(keep_out: &KeepOut, q: &JointVector) -> Vec<f64> {
    let arm = Shape::vendor().with_hand().at(q);
    let far = |(a, b): (Body, Body)| b.number() - a.number() >= APART;
    let pairs = arm.distances().filter(|(bodies, _)| far(*bodies));
    let mut margins: Vec<f64> = pairs.map(|(_, distance)| distance - SELF_STOP).collect();
    let cover = Shape::covering(RobotKind::Fr3).with_hand().at(q);
    for region in keep_out.iter().flatten() {
        margins.extend(cover.to(region).map(|near| near.distance - KEEP_OUT_STOP));
    }
    margins
}

fn least(q: &JointVector) -> f64 {
    let margins = margins(&KeepOut::default(), q);
    margins.into_iter().fold(f64::INFINITY, f64::min)
}

/// Ranks the result: 0 for clear, 2 for too near.
fn nearness(ahead: Ahead) -> usize {
    match ahead {
        Ahead::Clear => 0,
        Ahead::Near => 1,
        Ahead::TooNear(_) => 2,
    }
}

/// Returns the expected rank of [`Clearance::ahead`], from all distances at all three postures.
fn plain(keep_out: &KeepOut, now: &JointVector, next: &JointVector, end: &JointVector) -> usize {
    let now = margins(keep_out, now);
    let judged = [(next + end) * 0.5, *end].map(|there| {
        let there = margins(keep_out, &there);
        let all = now.iter().zip(&there);
        all.map(|(&now, &then)| nearness(judge(None, now, then)))
            .max()
    });
    judged[0].max(judged[1]).expect("an arm has pairs")
}

fn random_regions(random: &mut SmallRng) -> KeepOut {
    let mut vector = |most: f64| Vector3::from_fn(|_, _| random.random_range(-most..most));
    let (at, turn, half) = (vector(0.6), vector(2.0), vector(0.3).abs());
    let normal = UnitVector3::new_normalize(vector(1.0));
    let at = Translation3::from(at + Vector3::new(0.4, 0.0, 0.4));
    let tilted = Obstacle::Box {
        pose: Isometry3::from_parts(at, UnitQuaternion::from_scaled_axis(turn)),
        half,
    };
    let wall = Obstacle::Plane {
        normal,
        offset: random.random_range(-0.9..-0.3),
    };
    let all = [Obstacle::floor(-0.05), tilted, wall, block(0.3)];
    all.map(|region| random.random_bool(0.4).then_some(region))
}

#[test]
fn the_verdict_is_that_of_all_distances_wherever_the_arm_goes() {
    let (model, mut random) = (Model::fr3(), SmallRng::seed_from_u64(31));
    let limits = model.joint_limits();
    let budget = Budget::of(limits);
    let mut seen = [0; 3];
    let mut known = 0;
    let ways = sample(400, 100);
    for _ in 0..ways {
        let keep_out = random_regions(&mut random);
        let mut clearance = of(keep_out);
        let mut reference = Reference::at_rest(JointVector::from_fn(|i, _| {
            random.random_range(limits.lower[i]..limits.upper[i])
        }));
        let pace = random.random_range(0.02_f64..1.0).powi(2);
        let mut acceleration = JointVector::zeros();
        for cycle in 0..150 {
            if cycle % 30 == 0 {
                acceleration = JointVector::from_fn(|_, _| random.random_range(-3.0..3.0)) * pace;
            }
            // Ten cycles at once, because only the path matters here, not its smoothness.
            let dq = reference.dq + acceleration * 0.01;
            let next = Reference {
                q: reference.q + dq * 0.01,
                dq,
                ddq: acceleration,
            };
            let end = course::end_of_brake(model, &next, &budget);
            let half = (next.q + end) * 0.5;
            known += usize::from(is_clear(&clearance, &half, &(end - half).abs()));
            let ahead = nearness(clearance.ahead(&reference.q, &next.q, &end));
            let expected = plain(&keep_out, &reference.q, &next.q, &end);
            assert_eq!(ahead, expected, "cycle {cycle} of {keep_out:?}, {next:?}");
            seen[ahead] += 1;
            reference = next;
        }
    }
    assert!(seen.iter().all(|&count| count > 3 * ways), "{seen:?}");
    assert!(known > 25 * ways, "{known}");
}

/// Returns the arm bent forward at joint 2, until its distance from itself has this margin.
fn bent(margin: f64) -> JointVector {
    let at = |angle: f64| {
        let mut q = READY;
        q[1] += angle;
        q
    };
    let (mut far, mut near) = (1.1, 1.9);
    assert!(least(&at(far)) > margin);
    assert!(least(&at(near)) < margin);
    for _ in 0..60 {
        let middle = 0.5 * (near + far);
        if least(&at(middle)) < margin {
            near = middle;
        } else {
            far = middle;
        }
    }
    at(far)
}

#[test]
fn clearance_is_too_near_only_if_a_stop_comes_too_late() {
    let mut clearance = of(KeepOut::default());
    let mut ahead = |from: f64, to: f64| {
        let (now, end) = (bent(from), bent(to));
        clearance.ahead(&now, &now, &end)
    };
    assert_eq!(ahead(0.065, 0.061), Ahead::Clear);
    assert_eq!(ahead(0.065, 0.059), Ahead::Near);
    assert_eq!(ahead(0.01, 0.001), Ahead::Near);
    assert_eq!(ahead(0.01, -0.001), Ahead::TooNear(None));
    assert_eq!(ahead(0.001, 0.01), Ahead::Clear);
    // From inside, only a motion outward is free.
    assert_eq!(ahead(-0.03, -0.02), Ahead::Clear);
    assert_eq!(ahead(-0.03, -0.031), Ahead::TooNear(None));
}

#[test]
fn clear_pose_is_rechecked_only_after_joints_turn() {
    let mut clearance = of(KeepOut::default());
    let still = JointVector::zeros();
    assert!(!is_clear(&clearance, &READY, &still));
    assert_eq!(clearance.ahead(&READY, &READY, &READY), Ahead::Clear);
    assert!(is_clear(&clearance, &READY, &JointVector::repeat(0.02)));
    assert!(!is_clear(&clearance, &READY, &JointVector::repeat(0.5)));
    // Joint 1 moves the arm only against the base.
    let mut turned = still;
    turned[0] = 0.2;
    assert!(is_clear(&clearance, &READY, &turned));
}

/// Returns a block below the hand of the ready posture, with this height.
fn block(height: f64) -> Obstacle {
    Obstacle::Box {
        pose: Isometry3::translation(0.31, 0.0, height - 0.05),
        half: Vector3::new(0.06, 0.1, 0.05),
    }
}

#[test]
fn regions_are_kept_out_of_by_their_own_distance() {
    let mut lower = READY;
    lower[1] += 0.02;
    let arm = Shape::covering(RobotKind::Fr3).with_hand().at(&lower);
    // Finds the block that is as near to the lower posture as allowed.
    let (mut low, mut high) = (0.2, 0.5);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if arm.nearest_to(&block(middle)).distance > KEEP_OUT_STOP {
            low = middle;
        } else {
            high = middle;
        }
    }
    assert!(low > 0.25 && low < 0.45, "{low}");
    let too_near = Ahead::TooNear(Some(1));
    for (height, expected) in [(low - 0.001, Ahead::Near), (low + 0.001, too_near)] {
        let mut keep_out = KeepOut::default();
        keep_out[0] = Some(Obstacle::floor(-1.0));
        keep_out[2] = Some(block(height));
        let mut clearance = of(keep_out);
        assert_eq!(clearance.ahead(&READY, &READY, &lower), expected);
        assert_eq!(clearance.ahead(&lower, &lower, &READY), Ahead::Clear);
    }
}

/// For the arm itself, keep-out regions and previews: an arm that is 0.2 mm longer per link.
#[test]
fn distances_and_previews_use_the_lengths_of_the_model() {
    let ready: [f64; 7] = READY.into();
    let rigid = Isometry3::<f64>::identity().to_homogeneous();
    let rigid: [f64; 16] = rigid.as_slice().try_into().expect("sixteen numbers");
    let state = RobotState {
        q: ready,
        F_T_EE: rigid,
        EE_T_K: rigid,
        ..RobotState::default()
    };
    let floor = Obstacle::floor(0.0);
    let mut keep_out = KeepOut::default();
    keep_out[0] = Some(floor);
    for lengths in Lengths::KNOWN {
        let model = &Model::fr3().clone().with_lengths(lengths);
        let clearance = Clearance::new(model, true, keep_out);
        let spaced = clearance.spacing.at(&READY);
        let least = |region: Option<usize>| {
            let items = clearance.spacing.items(CandidateMask::ALL);
            let items = items.filter(|item| item.region() == region);
            items
                .map(|item| spaced.margin(item))
                .fold(f64::INFINITY, f64::min)
        };
        let [arm, cover] = [Shape::vendor(), Shape::covering(RobotKind::Fr3)]
            .map(|shape| shape.with_lengths(lengths).with_hand().at(&READY));
        let far = |(a, b): (Body, Body)| b.number() - a.number() >= APART;
        let pairs = arm.distances().filter(|(bodies, _)| far(*bodies));
        let nearest = pairs.map(|(_, it)| it).fold(f64::INFINITY, f64::min);
        assert!((least(None) - (nearest - SELF_STOP)).abs() < 1e-9);
        let nearest = cover.to(&floor).map(|near| near.distance);
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!((least(Some(0)) - (nearest - KEEP_OUT_STOP)).abs() < 1e-9);

        let pose = |q: &JointVector| model.pose(Frame::Flange, q, &EndEffector::default());
        let mut there = pose(&READY);
        there[(2, 3)] += 0.1;
        let there = crate::session::rigid(&there);
        let target = Target::Pose(there);
        let goal = Goal::new(GoalId(1), target, OnArrival::Hold, model.joint_limits());
        let preview = Preview::of(&[Waypoint::new(there)], &ready, &goal, model, &state);
        let end = pose(&preview.expect("within reach").end().into());
        let off = (end - there.to_homogeneous()).amax();
        assert!(off < 2e-5, "{off}");
    }
}

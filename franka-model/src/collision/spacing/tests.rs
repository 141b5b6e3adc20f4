use std::vec::Vec;

use nalgebra::{Isometry3, UnitVector3, Vector3};

use super::*;
use crate::collision::Body;
use crate::geometry::Lengths;
use crate::random::Random;
use crate::{Model, RobotKind, rotation};

const APART: f64 = 0.06;
const OUT: f64 = 0.02;

fn shapes() -> [(Shape<'static>, Shape<'static>); 4] {
    let (arm, fr3) = (Shape::vendor(), Shape::covering(RobotKind::Fr3));
    let fer = Shape::covering(RobotKind::Fer);
    [
        (arm, fr3),
        (arm.with_hand(), fr3.with_hand()),
        (arm.with_hand(), fer.with_hand()),
        (fr3.with_hand(), arm),
    ]
}

fn random_regions(random: &mut Random) -> [Option<Obstacle>; REGIONS_MAX] {
    core::array::from_fn(|i| {
        let at = random.vector3(1.0);
        let turn = rotation::exp(&random.vector3(3.0));
        let half = random.vector3(0.3).abs();
        match random.uniform(0.0, 4.0) {
            kind if kind < 1.0 => None,
            kind if kind < 2.0 && i > 0 => Some(Obstacle::Plane {
                normal: UnitVector3::new_normalize(random.vector3(1.0)),
                offset: random.uniform(-0.8, 0.2),
            }),
            _ => Some(Obstacle::Box {
                pose: Isometry3::from_parts(at.into(), turn),
                half,
            }),
        }
    })
}

/// Returns all margins from the distances of all pairs, in the order of the items.
fn plain(
    (arm, cover): &(Shape<'_>, Shape<'_>),
    links: u8,
    regions: &[Option<Obstacle>; REGIONS_MAX],
    q: &JointVector,
) -> Vec<f64> {
    let arm = arm.at(q);
    let far = |(a, b): (Body, Body)| b.number() - a.number() >= links;
    let pairs = arm.distances().filter(|(bodies, _)| far(*bodies));
    let mut margins: Vec<f64> = pairs.map(|(_, distance)| distance - APART).collect();
    let cover = cover.at(q);
    for region in regions.iter().flatten() {
        margins.extend(cover.to(region).map(|near| near.distance - OUT));
    }
    margins
}

#[test]
fn margin_is_the_distance_left_and_is_told_below_a_limit() {
    let mut random = Random::new(301);
    let (mut near, mut far) = (0, 0);
    for case in 0..4000 {
        let shapes = shapes()[case % 4];
        let links = [2, 3, 4][case % 3];
        let regions = random_regions(&mut random);
        let spacing = Spacing::within(&shapes.0, APART, links).out_of(&shapes.1, OUT, &regions);
        let q = random.posture(Model::fr3());
        let arrangement = spacing.at(&q);
        let expected = plain(&shapes, links, &regions, &q);
        let items: Vec<_> = spacing.items(CandidateMask::ALL).collect();
        assert_eq!(items.len(), expected.len());
        let limit = random.uniform(-0.1, 0.2);
        for (item, expected) in items.into_iter().zip(expected) {
            let margin = arrangement.margin(item);
            assert!(
                (margin - expected).abs() < 1e-12,
                "{item:?}: {margin}, {expected}"
            );
            let below = arrangement.margin_below(item, limit);
            assert_eq!(below, (margin < limit).then_some(margin), "{item:?}");
            near += usize::from(below.is_some());
            far += usize::from(below.is_none());
        }
    }
    assert!(near > 10_000 && far > 100_000, "{near} near, {far} far");
}

#[test]
fn within_a_motion_bound_no_margin_is_below_the_limit() {
    let mut random = Random::new(302);
    let (mut covered, mut others) = (0, 0);
    for case in 0..4000 {
        let shapes = shapes()[case % 4];
        let regions = match case % 3 {
            0 => [None; REGIONS_MAX],
            _ => random_regions(&mut random),
        };
        let spacing = Spacing::within(&shapes.0, APART, 3).out_of(&shapes.1, OUT, &regions);
        let q = random.posture(Model::fr3());
        let limit = random.uniform(0.0, 0.1);
        let bound = spacing.at(&q).motion_bound(limit);
        let mut size = 0.5;
        for _ in 0..8 {
            size *= 0.6;
            let q = q + JointVector::from_fn(|_, _| random.uniform(-size, size));
            let turns = JointVector::from_fn(|_, _| random.uniform(0.0, size));
            let candidates: Vec<_> = spacing
                .items(bound.candidates(&spacing, &q, &turns))
                .collect();
            for _ in 0..4 {
                let ends = turns.map(|turn| turn * random.uniform(-1.0, 1.0).signum());
                let at = spacing.at(&(q + ends));
                for item in spacing.items(CandidateMask::ALL) {
                    let near = at.margin_below(item, limit - 1e-12).is_some();
                    assert!(!near || candidates.contains(&item), "{item:?}");
                }
            }
            let all = spacing.items(CandidateMask::ALL).count();
            covered += all - candidates.len();
            others += candidates.len();
        }
    }
    assert!(covered > 100_000 && others > 100_000, "{covered}, {others}");
}

#[test]
fn small_margins_and_nan_postures_stay_candidates() {
    let floor = [Some(Obstacle::floor(0.0)), None, None, None];
    let cover = Shape::covering(RobotKind::Fr3);
    let spacing = Spacing::within(&Shape::vendor(), APART, 3).out_of(&cover, OUT, &floor);
    let still = JointVector::zeros();
    let spare = |q: &JointVector, limit| {
        let bound = spacing.at(q).motion_bound(limit);
        bound.candidates(&spacing, q, &still).is_empty()
    };
    // Link 1 is a decimetre above the floor.
    assert!(spare(&crate::READY, 0.05));
    assert!(!spare(&crate::READY, 0.15));
    let nowhere = JointVector::repeat(f64::NAN);
    let bound = spacing.at(&crate::READY).motion_bound(0.05);
    assert!(!bound.candidates(&spacing, &nowhere, &still).is_empty());
    let at = spacing.at(&nowhere);
    let moving = spacing
        .items(CandidateMask::ALL)
        .filter(|item| at.margin_below(*item, 0.05).is_some());
    assert!(moving.count() > 10);
}

/// Returns the ends of the axes, relative to the shoulder.
fn ends(capsules: &LinkCapsules, q: &JointVector) -> Vec<[Vector3<f64>; 2]> {
    let locations = capsules.at(&Chain::at(&Lengths::DESCRIBED, q));
    let locations = locations.iter().take(capsules.count);
    locations
        .map(|s| [s.middle - s.half, s.middle + s.half])
        .collect()
}

#[test]
fn no_joint_moves_a_capsule_with_more_than_its_lever() {
    const STEP: f64 = 1e-6;
    let mut random = Random::new(303);
    for shape in [Shape::vendor(), Shape::covering(RobotKind::Fer)] {
        let capsules = LinkCapsules::of(&shape.with_hand());
        let mut most = std::vec![[0.0_f64; 7]; capsules.count];
        for _ in 0..3000 {
            let q = random.posture(Model::fr3());
            let here = ends(&capsules, &q);
            for joint in 1..=7 {
                let mut turned = q;
                turned[joint - 1] += STEP;
                for (i, moved) in ends(&capsules, &turned).iter().enumerate() {
                    for (a, b) in here[i].iter().zip(moved) {
                        most[i][joint - 1] = most[i][joint - 1].max((b - a).norm() / STEP);
                    }
                }
            }
        }
        for (mounted, most) in capsules.each().iter().zip(most) {
            for joint in 1..=mounted.joints() {
                let (lever, most) = (mounted.lever(&Lengths::DESCRIBED, joint), most[joint - 1]);
                let case = (mounted.number, joint, lever, most);
                assert!(most < lever + 1e-6, "{case:?}");
                assert!(most >= 0.5 * lever, "{case:?}");
            }
            let beyond = &most[mounted.joints()..];
            assert!(beyond.iter().all(|most| *most == 0.0));
        }
    }
}

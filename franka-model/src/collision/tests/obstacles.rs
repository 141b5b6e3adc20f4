use super::*;
use crate::collision::Obstacle;
use crate::rotation;
use nalgebra::UnitVector3;

/// Returns the distance of a point from a box. For a point inside, the distance is minus the
/// smallest depth.
fn from_box(pose: &Isometry3<f64>, half: &Vector3<f64>, point: &Vector3<f64>) -> f64 {
    let local = pose.inverse_transform_point(&(*point).into()).coords;
    let beyond = local.abs() - half;
    let outside = beyond.map(|x| x.max(0.0)).norm();
    outside + beyond.max().min(0.0)
}

/// Returns how far a capsule's axis must be shifted along the unit vector `direction` to leave the
/// box.
fn way_out(
    pose: &Isometry3<f64>,
    half: &Vector3<f64>,
    capsule: &Capsule,
    direction: &Vector3<f64>,
) -> f64 {
    let turned = pose.inverse_transform_vector(direction).abs();
    let along = |p: &Vector3<f64>| direction.dot(&(p - pose.translation.vector));
    turned.dot(half) - along(&capsule.start).min(along(&capsule.end))
}

/// Checks that `shift` separates the capsule and the box, and that a local search from many
/// directions finds no shorter shift.
fn assert_is_the_shortest_way_out(
    pose: &Isometry3<f64>,
    half: &Vector3<f64>,
    capsule: &Capsule,
    shift: Vector3<f64>,
) {
    let shifted = Capsule {
        start: capsule.start + shift,
        end: capsule.end + shift,
        ..*capsule
    };
    let left = least_of(|t| from_box(pose, half, &point_on(&shifted, t)));
    assert!(left > -DISTANCE, "{left} inside after {shift}");

    let mut random = Random::new(90);
    for _ in 0..8 {
        let mut direction = random.vector3(1.0).normalize();
        let mut least = way_out(pose, half, capsule, &direction);
        let mut reach = 1.0;
        for _ in 0..200 {
            let candidate = (direction + random.vector3(reach)).normalize();
            let out = way_out(pose, half, capsule, &candidate);
            if out < least {
                (direction, least) = (candidate, out);
            } else {
                reach *= 0.95;
            }
        }
        assert!(
            shift.norm() < least + DISTANCE,
            "{shift} is longer than {least}"
        );
    }
}

fn random_box(random: &mut Random) -> (Isometry3<f64>, Vector3<f64>) {
    let pose = Isometry3::from_parts(
        random.vector3(0.8).into(),
        rotation::exp(&random.vector3(3.0)),
    );
    // The sizes range from a board to a cabinet. Some boxes are aligned with the base, like a
    // table.
    let half = random.vector3(0.5).abs();
    if random.uniform(0.0, 1.0) < 0.2 {
        (pose.translation.into(), half)
    } else {
        (pose, half)
    }
}

#[test]
fn distances_to_boxes_meet_an_independent_minimiser() {
    let mut random = Random::new(95);
    let (mut inside, mut outside) = (0, 0);
    for case in 0..CASES {
        let shape = shapes()[case % 3];
        let q = random.posture(Model::fr3());
        let (pose, half) = random_box(&mut random);
        let obstacle = Obstacle::Box { pose, half };
        let (placed, capsules) = (shape.at(&q), placed_by_poses(&shape, &q));
        let moving = capsules.iter().filter(|(body, _)| *body != Body::Link(0));
        let mut least = f64::INFINITY;
        let mut count = 0;
        for ((body, capsule), got) in moving.zip(placed.to(&obstacle)) {
            let want = least_of(|t| from_box(&pose, &half, &point_on(capsule, t)));
            assert_eq!(got.bodies, *body);
            let [surface, point] = got.points;
            if want > 1e-6 {
                outside += 1;
                let want = want - capsule.radius;
                assert!(
                    (got.distance - want).abs() < DISTANCE,
                    "{got:?}, not {want}"
                );
                assert!(from_box(&pose, &half, &surface).abs() < 1e-12);
            } else if want < -1e-6 {
                inside += 1;
                let depth = -got.distance - capsule.radius;
                assert_is_the_shortest_way_out(&pose, &half, capsule, got.normal * depth);
            }
            assert!(from_axis(capsule, &point) < 1e-12);
            let gap = point - surface;
            assert!((gap - got.normal * (capsule.radius + got.distance)).amax() < 1e-12);
            least = least.min(got.distance);
            count += 1;
        }
        assert_eq!(
            count + shape.arm.iter().filter(|c| c.link == 0).count(),
            shape.len()
        );
        assert!((placed.nearest_to(&obstacle).distance - least).abs() < DISTANCE);
    }
    assert!(
        inside > 3_000 && outside > 100_000,
        "{inside} inside, {outside} outside"
    );
}

#[test]
fn gradients_towards_boxes_and_planes_meet_differences() {
    let mut random = Random::new(96);
    let (mut compared, mut kinks) = (0, 0);
    for case in 0..3000 {
        let shape = shapes()[case % 3];
        let q = random.posture(Model::fr3());
        let obstacle = if case % 4 == 0 {
            random_plane(&mut random)
        } else {
            let (pose, half) = random_box(&mut random);
            Obstacle::Box { pose, half }
        };
        let distances = |placed: &Placed<'_>| placed.to(&obstacle).collect();
        let (c, k) = compare_gradients(&shape, &q, distances);
        compared += c;
        kinks += k;
    }
    assert!(
        compared > 200_000 && kinks * 200 < compared,
        "{kinks} of {compared}"
    );
}

fn random_plane(random: &mut Random) -> Obstacle {
    Obstacle::Plane {
        normal: UnitVector3::new_normalize(random.vector3(1.0)),
        offset: random.uniform(-0.5, 0.5),
    }
}

#[test]
fn plane_distance_is_that_of_the_lowest_sampled_point() {
    let mut random = Random::new(97);
    for _ in 0..CASES {
        let shape = Shape::vendor().with_hand();
        let q = random.posture(Model::fr3());
        let obstacle = random_plane(&mut random);
        let Obstacle::Plane { normal, offset } = obstacle else {
            unreachable!("a plane was made")
        };
        let lowest = placed_by_poses(&shape, &q)
            .iter()
            .filter(|(body, _)| *body != Body::Link(0))
            .flat_map(|(_, c)| (0..=10).map(|t| (*c, 0.1 * f64::from(t))))
            .map(|(c, t)| normal.dot(&point_on(&c, t)) - offset - c.radius)
            .fold(f64::INFINITY, f64::min);
        let got = shape.at(&q).nearest_to(&obstacle);
        assert!((got.distance - lowest).abs() < 1e-12);
    }
}

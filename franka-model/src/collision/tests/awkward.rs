//! Parallel, crossing, touching and degenerate axes; tools; non-finite numbers.

use super::*;
use crate::READY;
use crate::collision::segment::Segment;
use crate::collision::{Obstacle, ToolError};
use crate::rotation;

fn segment(start: [f64; 3], end: [f64; 3]) -> Segment {
    Segment::of(&Capsule::new(start, end, 0.0), |p| p)
}

#[test]
fn parallel_segments_are_nearest_amid_their_overlap() {
    let a = segment([0.0; 3], [1.0, 0.0, 0.0]);
    let b = segment([1.8, 0.0, 0.3], [0.6, 0.0, 0.3]);
    let nearest = a.nearest(&b);
    assert!((nearest.distance - 0.3).abs() < 1e-15);
    assert!((nearest.points[0].x - 0.8).abs() < 1e-15);
    assert!((nearest.normal - Vector3::z()).amax() < 1e-15);
}

#[test]
fn parallel_axes_behind_each_other_are_nearest_at_their_ends() {
    let a = segment([0.0; 3], [1.0, 0.0, 0.0]);
    let b = segment([2.0, 0.0, 0.0], [3.0, 0.0, 0.0]);
    for (nearest, inner) in [(a.nearest(&b), 1.0), (b.nearest(&a), 2.0)] {
        assert_eq!(nearest.distance, 1.0);
        assert_eq!(nearest.points[0].x, inner);
    }
}

#[test]
fn near_parallel_segments_keep_an_exact_distance() {
    let mut random = Random::new(98);
    for case in 0..CASES {
        // The angle ranges from clearly visible to below the last digit.
        let angle = 10.0_f64.powf(random.uniform(-17.0, -2.0));
        let capsule = |start: Vector3<f64>, along: Vector3<f64>| Capsule {
            start,
            end: start + along,
            radius: 0.0,
        };
        let along = random.vector3(0.3);
        let a = capsule(random.vector3(0.3), along);
        let turned = rotation::exp(&(random.vector3(1.0) * angle)) * along;
        let b = capsule(random.vector3(0.3), turned * random.uniform(-2.0, 2.0));
        let got = Segment::of(&a, |p| p).nearest(&Segment::of(&b, |p| p));
        let want = oracle(&a, &b);
        assert!(
            (got.distance - want).abs() < DISTANCE,
            "case {case}, angle {angle:e}: {} is not {want}",
            got.distance
        );
    }
}

#[test]
fn crossing_axes_have_a_normal_perpendicular_to_both() {
    let a = segment([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let b = segment([0.0, -1.0, 0.0], [0.0, 1.0, 0.0]);
    let nearest = a.nearest(&b);
    assert_eq!(nearest.distance, 0.0);
    assert_eq!(nearest.normal.z.abs(), 1.0);
    // Segments on one line have no unique common normal, so any perpendicular direction is valid.
    let nearest = a.nearest(&segment([0.5, 0.0, 0.0], [2.0, 0.0, 0.0]));
    assert_eq!((nearest.distance, nearest.normal.x), (0.0, 0.0));
    assert!((nearest.normal.norm() - 1.0).abs() < 1e-15);
}

#[test]
fn balls_are_capsules_too() {
    let ball = |x: f64| segment([x, 0.0, 0.0], [x, 0.0, 0.0]);
    assert_eq!(ball(0.0).nearest(&ball(2.0)).distance, 2.0);
    let rod = segment([-1.0, 1.0, 0.0], [1.0, 1.0, 0.0]);
    for nearest in [ball(0.5).nearest(&rod), rod.nearest(&ball(0.5))] {
        assert_eq!(nearest.distance, 1.0);
        assert_eq!(nearest.points[0].x, 0.5);
    }
    let nearest = ball(0.0).nearest(&ball(0.0));
    assert_eq!((nearest.distance, nearest.normal.norm()), (0.0, 1.0));
}

#[test]
fn segment_along_a_box_is_nearest_amid_their_overlap() {
    let tool = [Capsule::new([0.0, 0.0, 0.0], [0.0, 0.0, 0.4], 0.01)];
    let shape = Shape::vendor().with_tool(&tool).expect("a tool");
    // At joint positions of zero, the flange is at (0.088, 0, 0.926), and the tool extends down to
    // 0.526.
    let board = Obstacle::Box {
        pose: Isometry3::translation(0.5, 0.0, 0.4),
        half: Vector3::new(0.1, 0.1, 0.3),
    };
    let placed = shape.at(&JointVector::zeros());
    let tool = placed.to(&board).last().expect("the tool");
    assert_eq!(tool.bodies, Body::Tool);
    assert!((tool.distance - (0.5 - 0.1 - 0.088 - 0.01)).abs() < 1e-12);
    assert!(
        (tool.points[1].z - 0.5 * (0.7 + 0.526)).abs() < 1e-9,
        "{tool:?}"
    );
    assert!((tool.normal + Vector3::x()).amax() < 1e-12);
}

#[test]
fn a_tool_beyond_the_room_for_it_or_with_odd_numbers_is_refused() {
    let good = Capsule::new([0.0; 3], [0.0, 0.0, 0.1], 0.02);
    let shape = Shape::vendor();
    assert!(shape.with_tool(&[good; 8]).is_ok());
    let error = shape.with_tool(&[good; 9]).expect_err("one too many");
    assert_eq!(
        std::format!("{error}"),
        "the tool has 9 capsules, expected 8 at most"
    );
    for bad in [
        Capsule {
            radius: -0.1,
            ..good
        },
        Capsule {
            radius: f64::NAN,
            ..good
        },
        Capsule::new([f64::INFINITY, 0.0, 0.0], [0.0; 3], 0.1),
    ] {
        let error = shape.with_tool(&[good, bad]).expect_err("no capsule");
        assert!(matches!(error, ToolError::NotACapsule { index: 1, .. }));
    }
}

#[test]
fn nan_position_gives_nan_distance() {
    for i in 0..7 {
        let mut q = READY;
        q[i] = f64::NAN;
        let placed = Shape::vendor().with_hand().at(&q);
        // Joint 1 moves all links relative to the base.
        assert!(placed.nearest_pair().distance.is_nan(), "joint {}", i + 1);
        assert!(placed.nearest_to(&Obstacle::floor(0.0)).distance.is_nan());
        let pose = Isometry3::translation(0.5, 0.0, 0.5);
        let half = Vector3::repeat(0.1);
        let nearest = placed.nearest_to(&Obstacle::Box { pose, half });
        assert!(nearest.distance.is_nan());
    }
}

#[test]
fn the_covering_hand_contains_the_fingers_at_every_width() {
    // Corners of the finger's boxes in the finger's frame: centre and half sides. The diagonal part
    // is turned.
    let boxes: [([f64; 3], [f64; 3], f64); 4] = [
        ([0.0, 0.0185, 0.011], [0.011, 0.0075, 0.01], 0.0),
        ([0.0, 0.0068, 0.0022], [0.011, 0.0044, 0.0019], 0.0),
        (
            [0.0, 0.0159, 0.02835],
            [0.00875, 0.0035, 0.01175],
            core::f64::consts::FRAC_PI_6,
        ),
        ([0.0, 0.00758, 0.04525], [0.00875, 0.0076, 0.00925], 0.0),
    ];
    let shape = Shape::covering(RobotKind::Fr3).with_hand();
    let unturn = rotation::exp(&(Vector3::z() * core::f64::consts::FRAC_PI_4));
    for (centre, half, roll) in boxes {
        for corner in 0..8 {
            for opening in [0.0, 0.01, 0.02, 0.03, 0.04] {
                let sign = |i: usize| if corner >> i & 1 == 0 { 1.0 } else { -1.0 };
                let from_centre = Vector3::from_fn(|i, _| sign(i) * half[i]);
                let corner =
                    Vector3::from(centre) + rotation::exp(&(Vector3::x() * roll)) * from_centre;
                let on_hand = corner + Vector3::new(0.0, opening, 0.0584);
                for side in [1.0, -1.0] {
                    let on_hand = Vector3::new(on_hand.x, side * on_hand.y, on_hand.z);
                    let on_flange = unturn.inverse() * on_hand;
                    let inside = |c: &Capsule| from_axis(c, &on_flange) <= c.radius;
                    assert!(shape.tool.iter().any(inside), "{on_hand} is outside");
                }
            }
        }
    }
}

#[test]
fn way_out_of_box_is_exact_for_axes_nearly_along_an_edge() {
    let mut random = Random::new(99);
    let half = Vector3::new(0.2, 0.3, 0.5);
    let pose = Isometry3::translation(0.0, 0.0, 0.333);
    let obstacle = Obstacle::Box { pose, half };
    for _ in 0..CASES {
        let tilt = random.vector3(1.0) * 10.0_f64.powf(random.uniform(-17.0, -3.0));
        // Both ends are inside, so the way out is from the end nearer to a face: 0.05 along x.
        let start = Vector3::new(0.15, random.uniform(-0.2, 0.2), -0.1);
        let end = start + Vector3::z() * 0.3 + Vector3::new(-tilt.x.abs(), tilt.y, tilt.z);
        let axis = Segment::of(
            &Capsule {
                start,
                end,
                radius: 0.0,
            },
            |p| p,
        );
        let depth = 0.05 + (start.x - end.x);
        let nearest = obstacle.nearest(&axis);
        assert!((nearest.distance + depth).abs() < 1e-15 + 1e-6 * tilt.norm());
    }
}

#[test]
fn a_box_that_is_none_gives_no_panic() {
    let placed = Shape::vendor().with_hand().at(&READY);
    for (at, half, is_box) in [
        (0.5, f64::NAN, false),
        (f64::NAN, 0.1, false),
        (f64::INFINITY, 0.1, false),
        (0.5, f64::INFINITY, true),
        (0.5, -0.1, true),
        (0.5, 0.0, true),
    ] {
        let obstacle = Obstacle::Box {
            pose: Isometry3::translation(at, 0.0, 0.5),
            half: Vector3::new(0.1, half, 0.1),
        };
        let distance = placed.nearest_to(&obstacle).distance;
        assert_eq!(
            distance.is_finite(),
            is_box,
            "at {at}, half a side {half}: {distance}"
        );
    }
}

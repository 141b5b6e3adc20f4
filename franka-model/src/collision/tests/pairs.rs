use super::*;
use crate::collision::capsules::LinkCapsule;

#[test]
fn distances_of_all_pairs_meet_an_independent_minimiser() {
    let mut random = Random::new(92);
    for (shape, cases) in shapes().into_iter().zip([CASES, CASES / 10, CASES / 10]) {
        for case in 0..cases {
            let model = [Model::fr3(), Model::fer()][case % 2];
            let q = random.posture(model);
            let (placed, capsules) = (shape.at(&q), placed_by_poses(&shape, &q));
            let mut least = f64::INFINITY;
            for ((a, b), pair) in placed.shape.indices().zip(placed.pairs()) {
                let want = oracle(&capsules[a].1, &capsules[b].1);
                least = least.min(want);
                assert_eq!(pair.bodies, (capsules[a].0, capsules[b].0));
                assert!(
                    (pair.distance - want).abs() < DISTANCE,
                    "{pair:?}, not {want}"
                );
                let gap = pair.points[1] - pair.points[0];
                let radii = capsules[a].1.radius + capsules[b].1.radius;
                assert!((gap - pair.normal * (pair.distance + radii)).amax() < 1e-12);
                assert!(from_axis(&capsules[a].1, &pair.points[0]) < 1e-12);
                assert!(from_axis(&capsules[b].1, &pair.points[1]) < 1e-12);
            }
            let nearest = placed.nearest_pair();
            assert!((nearest.distance - least).abs() < DISTANCE);
            assert!(placed.pairs().any(|pair| pair == nearest));
            let pairs = placed.pairs().map(|pair| (pair.bodies, pair.distance));
            assert!(pairs.eq(placed.distances()));
        }
    }
}

#[test]
fn gradients_of_all_pairs_meet_differences() {
    let mut random = Random::new(93);
    let (mut compared, mut kinks) = (0, 0);
    for shape in shapes() {
        for _ in 0..1000 {
            let q = random.posture(Model::fr3());
            let pairs = |placed: &Placed<'_>| placed.pairs().collect();
            let (c, k) = compare_gradients(&shape, &q, pairs);
            compared += c;
            kinks += k;
        }
    }
    assert!(
        compared > 500_000 && kinks * 1000 < compared,
        "{kinks} of {compared}"
    );
}

/// Returns true for neighbouring links, and for links around the shoulder.
fn is_of_one_piece(inner: u8, outer: u8) -> bool {
    outer - inner < 2 || (inner, outer) == (1, 3)
}

#[test]
fn vendor_capsule_pairs_are_those_that_come_near() {
    const NEAR: f64 = 0.05;
    let shape = Shape::vendor();
    let mut least = [[f64::INFINITY; 8]; 8];
    let mut random = Random::new(94);
    for case in 0..40_000 {
        let q = random.posture([Model::fr3(), Model::fer()][case % 2]);
        let placed = shape.at(&q);
        for (a, LinkCapsule { link: inner, .. }) in shape.arm.iter().enumerate() {
            for (b, LinkCapsule { link: outer, .. }) in shape.arm.iter().enumerate() {
                if inner < outer {
                    let distance = placed.segments[a].nearest(&placed.segments[b]).distance;
                    let least = &mut least[usize::from(*inner)][usize::from(*outer)];
                    *least = least.min(distance);
                }
            }
        }
    }
    for inner in 0..8 {
        for outer in inner + 1..8 {
            let listed = shape.pairs.iter().any(|&(a, b)| {
                let link = |i: u8| shape.arm[usize::from(i)].link;
                (link(a), link(b)) == (inner, outer)
            });
            let least = least[usize::from(inner)][usize::from(outer)];
            let near = least < NEAR && !is_of_one_piece(inner, outer);
            assert_eq!(
                listed, near,
                "links {inner} and {outer} come within {least} m"
            );
        }
    }
}

#[test]
fn a_tool_is_checked_against_everything_up_to_link_5() {
    let tool = [Capsule::new([0.0; 3], [0.0, 0.0, 0.1], 0.02)];
    let shape = Shape::vendor().with_tool(&tool).expect("a tool");
    let placed = shape.at(&crate::READY);
    let inner = placed.pairs().filter(|pair| pair.bodies.1 == Body::Tool);
    let links: Vec<_> = inner.map(|pair| pair.bodies.0).collect();
    let expected = [0, 1, 2, 3, 4, 5, 5].map(Body::Link);
    assert_eq!(links, expected);
}

#[test]
fn gradient_of_a_pair_omits_joints_that_do_not_move_it() {
    let placed = Shape::vendor().with_hand().at(&crate::READY);
    for pair in placed.pairs() {
        let (inner, outer) = pair.bodies;
        for i in (0..inner.joints()).chain(outer.joints()..7) {
            assert_eq!(pair.gradient[i], 0.0, "{pair:?}");
        }
    }
}

#[test]
fn folded_arm_collides_and_the_gradient_leads_out() {
    let shape = Shape::vendor().with_hand();
    let mut q = JointVector::from([0.0, 1.2, 0.0, -2.6, 0.0, 2.0, 0.785]);
    let mut pair = shape.at(&q).nearest_pair();
    assert!(pair.distance < 0.0, "{pair:?}");
    let mut steps = 0;
    while pair.distance < 0.01 {
        q += pair.gradient * (0.01 / pair.gradient.norm_squared());
        pair = shape.at(&q).nearest_pair();
        steps += 1;
        assert!(steps < 100, "{pair:?}");
    }
}

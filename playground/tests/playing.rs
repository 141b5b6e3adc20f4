//! Tests of a visitor's actions on the page.

use franka_model::RobotKind;
use franka_playground::{Playground, State};
use nalgebra::{Isometry3, Translation3, Vector3};

/// Advances until `is_so` returns true. Panics after a minute.
fn until(playground: &mut Playground, is_so: impl Fn(&Playground) -> bool) -> f64 {
    let begin = playground.view().seconds;
    for _ in 0..6000 {
        if is_so(playground) {
            return playground.view().seconds - begin;
        }
        playground.advance(10);
    }
    panic!("not after a minute: {}", playground.message());
}

fn following(kind: RobotKind, seed: Option<u64>) -> Playground {
    let mut playground = Playground::new(kind, seed);
    until(&mut playground, |now| now.view().state == State::Following);
    playground
}

/// All arms that the page offers.
fn for_each_arm(test: impl Fn(Playground)) {
    for kind in [RobotKind::Fr3, RobotKind::Fer] {
        for seed in [None, Some(1), Some(2)] {
            println!("{kind:?}, {seed:?}");
            test(following(kind, seed));
        }
    }
}

fn moved(pose: &Isometry3<f64>, by: [f64; 3]) -> Isometry3<f64> {
    Translation3::from(by) * pose
}

fn distance(playground: &Playground) -> f64 {
    let now = playground.view();
    (now.target.translation.vector - now.end_effector.translation.vector).norm()
}

#[test]
fn the_arm_goes_to_a_target_below_the_cap() {
    for_each_arm(|mut playground| {
        let target = moved(&playground.view().target, [0.05, 0.2, -0.1]);
        playground.target(target);
        let mut fastest = 0.0_f64;
        for _ in 0..4000 {
            playground.advance(1);
            fastest = fastest.max(playground.view().speed);
        }
        assert!(distance(&playground) < 2e-3, "{}", distance(&playground));
        assert!((0.1..0.25).contains(&fastest), "{fastest}");
        assert_eq!(playground.message(), "");
    });
}

#[test]
fn a_pushed_arm_gives_way_and_comes_back() {
    for_each_arm(|mut playground| {
        playground.push(Vector3::new(0.0, 15.0, 0.0));
        playground.advance(1500);
        let now = playground.view();
        let gone = distance(&playground);
        assert!(gone > 5e-3, "{gone}");
        assert!((8.0..20.0).contains(&now.force.y), "{}", now.force);
        assert_eq!(now.state, State::Following, "{}", playground.message());
        playground.push(Vector3::zeros());
        // Because of friction, the arm stops slightly off the target.
        until(&mut playground, |now| {
            distance(now) < 5e-3 && now.view().speed < 1e-3
        });
    });
}

#[test]
fn a_hard_push_stops_the_arm_which_says_why_and_recovers() {
    for_each_arm(|mut playground| {
        playground.push(Vector3::new(0.0, 0.0, -120.0));
        until(&mut playground, |now| now.view().state == State::Stopped);
        assert!(
            playground.message().contains("reflex"),
            "{}",
            playground.message()
        );
        playground.push(Vector3::zeros());
        playground.recover();
        until(&mut playground, |now| now.view().state == State::Following);
        assert_eq!(playground.message(), "");
        let target = moved(&playground.view().target, [0.0, 0.0, 0.05]);
        playground.target(target);
        playground.advance(3000);
        assert!(distance(&playground) < 2e-3, "{}", distance(&playground));
    });
}

#[test]
fn held_arm_stops_or_waits_and_goes_on_when_released() {
    for_each_arm(|mut playground| {
        playground.block(true);
        let target = moved(&playground.view().target, [0.0, 0.15, 0.0]);
        playground.target(target);
        playground.advance(3000);
        assert!(distance(&playground) > 0.1);
        playground.block(false);
        if playground.view().state == State::Stopped {
            playground.recover();
            until(&mut playground, |now| now.view().state == State::Following);
        }
        playground.advance(500);
        // A released arm may be faster than the speed limit, and then abandons its target.
        playground.target(target);
        until(&mut playground, |now| distance(now) < 2e-3);
    });
}

#[test]
fn a_target_out_of_reach_is_refused_with_a_reason() {
    let mut playground = following(RobotKind::Fr3, None);
    let target = moved(&playground.view().target, [2.0, 0.0, 0.0]);
    playground.target(target);
    playground.advance(1000);
    let now = playground.view();
    assert_eq!(now.state, State::Following);
    assert!(!playground.message().is_empty());
}

//! Effect of a push during a motion on the motions after it.

use franka_lockstep::{Lockstep, Outcome};
use franka_model::{READY, RobotKind};
use franka_rt::session::condition::{elapsed, force_z};
use franka_rt::session::{Goal, OnArrival, Target};
use franka_sim::{Arm, Touch};
use nalgebra::Vector3;

use super::{MS, above, realistic, with_arm};

/// Moves to a target in a separate motion, from rest to rest.
fn go(lockstep: &mut Lockstep, target: Target) -> Outcome {
    let goal = lockstep.begin(target);
    let outcome = lockstep.until_resolved(goal, 20_000);
    lockstep.until_idle(1000);
    outcome
}

/// Moves down until a steady push comes, which also keeps the arm from its start; then the push is
/// over.
fn push(lockstep: &mut Lockstep, force: f64, reacts: bool) -> Outcome {
    let start = lockstep.arm_pose();
    let down = above(lockstep, -0.2);
    let pushed = force_z(8.0) & elapsed(200 * MS);
    let goal = lockstep.goal(down, OnArrival::ReportAndFinish);
    let goal = Goal {
        budget: goal.budget.scaled(0.4),
        reaction: reacts.then(|| pushed.then(start)),
        ..goal
    };
    let goal = lockstep.submit(goal).expect("within reach");
    lockstep.run(800);
    let hand = Touch::force(Vector3::z() * force);
    let hand = lockstep.robot.touch(hand);
    let outcome = lockstep.until_resolved(goal, 20_000);
    lockstep.until_idle(10_000);
    lockstep.robot.release(hand);
    outcome
}

/// The push is no friction and no load of the arm. Anything learned from it would have to be
/// unlearned, and motions long enough for that come late.
#[test]
fn an_arm_that_was_pushed_arrives_in_the_next_motion() {
    let kind = RobotKind::Fr3;
    let arms = || {
        let typical = with_arm(kind, Some(Arm::realistic(kind)), 1);
        [typical]
            .into_iter()
            .chain((0..3).map(|seed| realistic(kind, seed)))
    };
    for (force, reacts) in [(12.0, true), (-12.0, true), (25.0, true), (12.0, false)] {
        for (number, mut lockstep) in arms().enumerate() {
            let home: Target = READY.into();
            for _ in 0..2 {
                go(&mut lockstep, home).expect("it arrives");
                let up = above(&lockstep, 0.1);
                go(&mut lockstep, up).expect("it arrives");
            }
            go(&mut lockstep, home).expect("it arrives");
            let pushed = push(&mut lockstep, force, reacts);
            if reacts {
                let error = pushed.expect_err("the push holds it");
                assert!(error.reacted().is_some(), "{error}");
            }
            for motion in 0..3 {
                let begun = lockstep.now();
                let report = go(&mut lockstep, home);
                let what = format!("{force} N, reacts: {reacts}, arm {number}, motion {motion}");
                let report = report.unwrap_or_else(|error| panic!("{what}: {error}"));
                let off = report.final_error.expect("a target").translation;
                let took = lockstep.now() - begun;
                println!("{what}: {:.2} mm off after {took} ms", off * 1e3);
                // Without a reaction the push is taken for a load, until the arm rests again.
                let most = if reacts { 1500 } else { 3000 };
                assert!(took < most, "{what}: {took} ms");
            }
        }
    }
}

//! A push on an arm that holds its pose leaves nothing behind: neither as friction that was learned
//! nor as an integral.

use franka_model::RobotKind;
use franka_tests::held_push::{HeldPush, random_arm};
use franka_tests::thorough;
use rand::SeedableRng;
use rand::rngs::SmallRng;

/// Pushes per robot; more with `FRANKA_THOROUGH=1`.
fn count() -> u64 {
    if thorough() { 400 } else { 12 }
}

const SEED: u64 = 0;

/// One push in so many may leave more than 1 mm for longer than 2 s: those of seconds at the begin
/// of a session, on an arm that nothing is known of.
const LATE: u64 = 25;

/// None leaves more than this, `[m]`.
const FAR: f64 = 3e-3;

#[test]
fn an_fr3_comes_back_from_a_push() {
    come_back(RobotKind::Fr3);
}

#[test]
fn an_fer_comes_back_from_a_push() {
    come_back(RobotKind::Fer);
}

/// Every push and every arm has a seed of its own, so that one runs alone.
fn come_back(kind: RobotKind) {
    let (mut failed, mut late) = (Vec::new(), Vec::new());
    for seed in SEED..SEED + count() {
        let push = HeldPush::random(&mut SmallRng::seed_from_u64(seed));
        let after = push.on(kind, random_arm(kind, seed), seed);
        let what = format!(
            "seed {seed}: {:.1} N for {} ms, learned {}, after {} ms: gave way by {:.1} mm, left \
             {:.2} mm {:.2} mrad, later {:.2} mm {:.2} mrad, arrived {}",
            push.force.norm(),
            push.lasts,
            push.learned,
            push.after,
            after.gave_way * 1e3,
            after.left.translation * 1e3,
            after.left.rotation * 1e3,
            after.later.translation * 1e3,
            after.later.rotation * 1e3,
            after.arrived,
        );
        println!("{what}");
        match after.later.translation {
            off if off > FAR || !after.arrived => failed.push(what),
            off if off > 1e-3 => late.push(what),
            _ => {}
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
    assert!(late.len() as u64 * LATE <= count(), "{}", late.join("\n"));
}

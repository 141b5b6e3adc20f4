//! Supervised robots, and a thousand mishaps in random order: simulators that are killed and
//! started again, reflexes, user stops, hands on the arm, brakes, networks that are cut.
//!
//! Each robot has a separate policy. The requests of its supervision are checked against the
//! policy. The arm's motion is checked against the requests since the last mishap, and the events
//! against the permitted sequences. Every motion resolves once; in the end every robot moves again.
//!
//! `FRANKA_MISHAP_SEED` is the seed, which replays a run with the same build, and `FRANKA_MISHAPS`
//! how many there are.
//!
//! * `trial`: one robot, its mishaps, and the rules that it must keep.
//! * `chronicle`: permitted sequences of events.
//! * `settings`: a program's settings are valid on every connection.

mod chronicle;
mod settings;
mod trial;

use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

use trial::{Rules, Trial};

/// Mishaps in one run; more with `FRANKA_THOROUGH=1`.
fn count() -> u64 {
    if franka_tests::thorough() { 1000 } else { 250 }
}

/// Robots with all their mishaps; returns the events of each.
fn play(seed: u64, mishaps: u64) -> Vec<String> {
    let mut random = SmallRng::seed_from_u64(seed);
    let rules = Rules::all().into_iter().zip(seed..);
    let mut trials: Vec<Trial> = rules.map(|(rules, seed)| Trial::new(rules, seed)).collect();
    let mut happened = 0;
    while happened < mishaps {
        let which = random.random_range(0..trials.len());
        happened += u64::from(trials[which].act());
        let pause = match random.random_range(0..4) {
            0 => random.random_range(0..5),
            1 | 2 => random.random_range(0..60),
            _ => random.random_range(0..400),
        };
        for trial in &mut trials {
            trial.run(pause);
        }
    }
    trials.into_iter().map(Trial::finish).collect()
}

#[test]
fn mishaps_break_no_policy_and_lose_no_motion() {
    let number = |name| std::env::var(name).ok().and_then(|text| text.parse().ok());
    let seed: u64 = number("FRANKA_MISHAP_SEED").unwrap_or(1);
    let mishaps: u64 = number("FRANKA_MISHAPS").unwrap_or_else(count);
    println!("replay with FRANKA_MISHAP_SEED={seed} FRANKA_MISHAPS={mishaps}");
    for (robot, told) in play(seed, mishaps).iter().enumerate() {
        println!("{robot}: {}", told.lines().last().unwrap_or_default());
    }
}

#[test]
fn a_seed_replays_every_event() {
    let first = play(5, 40);
    assert_eq!(first, play(5, 40));
    assert_ne!(first, play(6, 40));
}

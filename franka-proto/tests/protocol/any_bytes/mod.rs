//! Runs the fuzz targets on mutated golden messages. The inputs are the same in every run, and a
//! run takes a second or two.
//!
//! `fuzz/` runs the same targets under libFuzzer, which searches for new code paths; this test
//! requires only `cargo test`.

mod checks;
mod seeds;

use std::path::Path;

use rand::{Rng, SeedableRng, rngs::SmallRng};

/// Number of inputs per target. All targets together take a second or two.
const INPUTS: u64 = 100_000;

#[test]
fn golden_messages_with_errors_in_them_break_nothing() {
    let seeds = seeds();
    for (number, (target, check)) in (0..).zip(checks::TARGETS) {
        let own: Vec<_> = seeds.iter().filter(|seed| seed.target == target).collect();
        assert!(!own.is_empty(), "{target} has no seeds");
        let mut random = SmallRng::seed_from_u64(number);
        for _ in 0..INPUTS {
            let seed = own[random.random_range(0..own.len())];
            let other = own[random.random_range(0..own.len())];
            let mut bytes = seed.bytes.clone();
            for _ in 0..random.random_range(1..=4) {
                mutate(&mut random, &mut bytes, &other.bytes);
            }
            let result = std::panic::catch_unwind(|| check(&bytes));
            assert!(result.is_ok(), "{target}, from {}: {bytes:02x?}", seed.name);
        }
    }
}

#[test]
fn golden_messages_as_they_are_break_nothing() {
    let seeds = seeds();
    assert_eq!(seeds.len(), 73 + 2 * 8);
    for seed in seeds {
        let target = checks::TARGETS
            .iter()
            .find(|(name, _)| *name == seed.target);
        let (_, check) = target.expect("a seed is for a target");
        check(&seed.bytes);
    }
}

fn seeds() -> Vec<seeds::Seed> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    seeds::read(&root.join("../tests/vectors/wire_golden.json"))
}

/// Applies one mutation: a bit, a byte, a number in a header, a cut, an insertion, or a splice.
fn mutate(random: &mut SmallRng, bytes: &mut Vec<u8>, other: &[u8]) {
    let value = random.random();
    if bytes.is_empty() {
        return bytes.push(value);
    }
    let at = random.random_range(0..bytes.len());
    match random.random_range(0..7) {
        0 => bytes[at] ^= 1 << random.random_range(0..8),
        1 => bytes[at] = value,
        // The first bytes contain the command, the id and the size. Small numbers there reach more
        // code.
        2 => {
            let at = random.random_range(0..bytes.len().min(14));
            bytes[at] = value % 16;
        }
        3 => bytes.truncate(at),
        4 => bytes.insert(at, value),
        5 => {
            bytes.truncate(at);
            bytes.extend_from_slice(&other[random.random_range(0..=other.len())..]);
        }
        _ => bytes.extend_from_slice(other),
    }
}

//! The fuzz targets on mutated golden messages: the same every time, in a second or two.
//!
//! `fuzz/` runs the same targets under libFuzzer, which finds its way to new code; this test needs
//! nothing but `cargo test`.

mod checks;
mod seeds;

use std::path::Path;

/// Inputs per target. All targets take a second or two together.
const INPUTS: u64 = 100_000;

#[test]
fn golden_messages_with_errors_in_them_break_nothing() {
    let seeds = seeds();
    for (number, (target, check)) in (0..).zip(checks::TARGETS) {
        let own: Vec<_> = seeds.iter().filter(|seed| seed.target == target).collect();
        assert!(!own.is_empty(), "{target} has no seeds");
        let mut random = Random(number);
        for _ in 0..INPUTS {
            let seed = own[random.below(own.len())];
            let other = own[random.below(own.len())];
            let mut bytes = seed.bytes.clone();
            for _ in 0..=random.below(4) {
                random.mutate(&mut bytes, &other.bytes);
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

/// SplitMix64: every seed gives another sequence, and the same one each time.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound.max(1) as u64) as usize
    }

    /// One error: a bit, a byte, a number in a header, a cut, an insertion, a splice.
    fn mutate(&mut self, bytes: &mut Vec<u8>, other: &[u8]) {
        let at = self.below(bytes.len());
        let value = self.next() as u8;
        match self.below(7) {
            _ if bytes.is_empty() => bytes.push(value),
            0 => bytes[at] ^= 1 << self.below(8),
            1 => bytes[at] = value,
            // Command, id and size are in the first bytes: small numbers there get far.
            2 => {
                let at = self.below(bytes.len().min(14));
                bytes[at] = value % 16;
            }
            3 => bytes.truncate(at),
            4 => bytes.insert(at, value),
            5 => {
                bytes.truncate(at);
                bytes.extend_from_slice(&other[self.below(other.len())..]);
            }
            _ => bytes.extend_from_slice(other),
        }
    }
}

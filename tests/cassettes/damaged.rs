//! The reader of cassettes on damaged files; `fuzz/fuzz_targets/cassette.rs` continues from here.

use std::time::Duration;

use franka_proto::Version;
use franka_record::cassette::{Cassette, Pace, PlayOptions, Player};
use rand::rngs::SmallRng;
use rand::{Rng as _, SeedableRng as _};

use crate::playing::committed;

/// A damaged file is an error or a cassette. A cassette plays to its end, or returns the reason why
/// not.
#[test]
fn any_damage_of_a_file_is_an_error_or_a_cassette() {
    let mut rng = SmallRng::seed_from_u64(SEED);
    for version in Version::ALL {
        let file = std::fs::read(committed(version)).expect("committed");
        let whole = Cassette::read(&file).expect("committed");
        for _ in 0..ROUNDS {
            let mut damaged = file.clone();
            for _ in 0..rng.random_range(1..8) {
                let position = rng.random_range(0..damaged.len());
                damaged[position] = rng.random();
            }
            if rng.random_bool(0.3) {
                damaged.truncate(rng.random_range(0..damaged.len()));
            }
            let Ok(cassette) = Cassette::read(&damaged) else {
                continue;
            };
            if cassette.damage.is_none() {
                assert_eq!(cassette.connections.len(), whole.connections.len());
                assert!(cassette == whole, "damage is noticed");
            }
            for connection in &cassette.connections {
                let mut options = PlayOptions::default();
                options.pace = Pace::Lockstep;
                let Ok(mut player) = Player::new(connection, options, Duration::ZERO) else {
                    continue;
                };
                assert_eq!(
                    player.poll(Duration::ZERO),
                    Ok(None),
                    "a client speaks first"
                );
            }
        }
    }
}

const ROUNDS: u32 = 300;
const SEED: u64 = 19;

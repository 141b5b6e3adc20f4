//! Decoding and encoding of datagrams, FCI version 10.

use std::hint::black_box;

use franka_proto::{RobotCommand, RobotState, Version};
use rand::{Rng, SeedableRng, rngs::SmallRng};

use super::{Benchmark, Inputs, Statistic, timed};

/// Benchmarks of decoding a state and encoding a command.
pub fn all() -> Vec<Benchmark> {
    vec![decode(), encode()]
}

fn decode() -> Benchmark {
    let mut random = SmallRng::seed_from_u64(SEED);
    let mut datagrams = Inputs::new((0..DATAGRAMS).map(|id| state(id, &mut random)));
    Benchmark {
        key: "rt.decode_ns",
        statistics: &[Statistic::P50],
        round: Box::new(move || {
            timed(SAMPLES, BATCH, || {
                let state = RobotState::decode(Version::V10, black_box(datagrams.next()));
                black_box(&state)
                    .as_ref()
                    .expect("the datagram was encoded as this version");
            })
        }),
    }
}

fn encode() -> Benchmark {
    let mut random = SmallRng::seed_from_u64(SEED);
    let mut commands = Inputs::new((0..DATAGRAMS).map(|id| command(id, &mut random)));
    let mut buffer = [0; RobotCommand::MAX_SIZE];
    Benchmark {
        key: "rt.encode_ns",
        statistics: &[Statistic::P50],
        round: Box::new(move || {
            timed(SAMPLES, BATCH, || {
                let written =
                    black_box(commands.next()).encode(Version::V10, black_box(&mut buffer));
                black_box(written).expect("the buffer holds the longest command");
            })
        }),
    }
}

fn state(message_id: u64, random: &mut SmallRng) -> Vec<u8> {
    let state = RobotState {
        message_id,
        q: random.random(),
        dq: random.random(),
        tau_J: random.random(),
        ..RobotState::default()
    };
    let mut bytes = vec![0; RobotState::MAX_SIZE];
    let length = state
        .encode(Version::V10, &mut bytes)
        .expect("the buffer holds the longest state");
    bytes.truncate(length);
    bytes
}

fn command(message_id: u64, random: &mut SmallRng) -> RobotCommand {
    RobotCommand {
        message_id,
        tau_J_d: random.random(),
        ..RobotCommand::default()
    }
}

const SEED: u64 = 1;
const DATAGRAMS: u64 = 64;
const SAMPLES: usize = 400;
const BATCH: u32 = 64;

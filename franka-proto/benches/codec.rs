//! Time of one decode and one encode of the datagrams of both versions:
//! `cargo bench -p franka-proto`.
//!
//! Medians over batches, in nanoseconds. Budget: 250 ns for a state, 100 ns for a command.

use std::hint::black_box;
use std::time::Instant;

use franka_proto::{RobotCommand, RobotState, Version};

const BATCHES: usize = 501;
const BATCH: u32 = 1000;

fn main() {
    for version in Version::ALL {
        let mut state_bytes = [0; RobotState::MAX_SIZE];
        let state = RobotState {
            message_id: 1,
            q: [0.5; 7],
            ..RobotState::default()
        };
        state.encode(version, &mut state_bytes).expect("it fits");
        let mut command_bytes = [0; RobotCommand::MAX_SIZE];
        let command = RobotCommand {
            tau_J_d: [1.0; 7],
            ..RobotCommand::default()
        };
        command
            .encode(version, &mut command_bytes)
            .expect("it fits");

        let state_decode = median(|| RobotState::decode(version, black_box(&state_bytes)));
        let mut buffer = [0; RobotState::MAX_SIZE];
        let state_encode = median(|| black_box(&state).encode(version, black_box(&mut buffer)));
        let command_decode = median(|| RobotCommand::decode(version, black_box(&command_bytes)));
        let mut buffer = [0; RobotCommand::MAX_SIZE];
        let command_encode = median(|| black_box(&command).encode(version, black_box(&mut buffer)));

        println!(
            "protocol {version:>2}: state decode {state_decode:.0} ns, encode {state_encode:.0} ns; \
             command decode {command_decode:.0} ns, encode {command_encode:.0} ns"
        );
    }
}

/// Median time of one call in nanoseconds.
fn median<T>(mut call: impl FnMut() -> T) -> f64 {
    let mut batches = [0.0; BATCHES];
    for batch in &mut batches {
        let start = Instant::now();
        for _ in 0..BATCH {
            black_box(call());
        }
        *batch = start.elapsed().as_nanos() as f64 / f64::from(BATCH);
    }
    batches.sort_by(f64::total_cmp);
    batches[BATCHES / 2]
}

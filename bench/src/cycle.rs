//! The whole cycle of target control without the sockets, and the cost of a control function in
//! addition to its own computation.

use std::sync::Arc;
use std::time::Instant;

use franka_proto::{MoveControllerMode, RobotCommand, RobotMode, RobotState, Version};
use franka_rt::control::{Callback, Modes, Torques};
use franka_rt::driver::{ControlLog, Driver, MotionId, Order, Program};

use franka_rt::thread::cycle_feed;

use super::timed;
use super::{Benchmark, Statistic};
use franka_lockstep::{Part, Wander};

/// Benchmarks of the cycle: a state decoded, answered by target control and the answer encoded; the
/// driver's work afterwards, and for the next state; and the first under an empty control function.
pub fn all() -> Vec<Benchmark> {
    vec![
        target(
            "rt.cycle_ns",
            Part::Answer,
            &[Statistic::P50, Statistic::P99, Statistic::Max],
        ),
        target("rt.after_send_ns", Part::Aftermath, &[Statistic::P50]),
        target(
            "rt.prepare_ns",
            Part::Preparation,
            &[Statistic::P50, Statistic::P99],
        ),
        callback(),
        push(),
    ]
}

/// Measures one part of the cycle of an arm that moves to random targets.
fn target(key: &'static str, part: Part, statistics: &'static [Statistic]) -> Benchmark {
    let mut wander = Wander::new(1);
    Benchmark {
        key,
        statistics,
        round: Box::new(move || {
            let mut samples = Vec::with_capacity(CYCLES);
            while samples.len() < CYCLES {
                wander.tick_around(|of, work| {
                    let start = Instant::now();
                    work();
                    if of == part {
                        samples.push(start.elapsed().as_nanos() as u64);
                    }
                });
            }
            samples
        }),
    }
}

/// Measures a function that returns constant torques, which pass the limiter: this is the driver's
/// work for any function.
fn callback() -> Benchmark {
    let mut motion = Running::new();
    Benchmark {
        key: "rt.callback_overhead_ns",
        statistics: &[Statistic::P50],
        round: Box::new(move || {
            timed(SAMPLES, BATCH, || {
                motion.cycle();
            })
        }),
    }
}

/// Measures the cost of one reader of every cycle for the thread: a record and a state into its
/// ring, which the reader empties in between, untimed.
fn push() -> Benchmark {
    let mut wander = Wander::new(1);
    let (feed, mut publisher) = cycle_feed(VERSION);
    let mut reader = feed.attach(CYCLES).expect("a length within the limits");
    publisher.take_attached();
    let mut bytes = vec![0; RobotState::MAX_SIZE];
    Benchmark {
        key: "record.push_ns",
        statistics: &[Statistic::P50, Statistic::P99],
        round: Box::new(move || {
            let mut samples = Vec::with_capacity(CYCLES);
            while samples.len() < CYCLES {
                wander.tick_around(|_, work| work());
                let client = &wander.lockstep.client;
                let size = client
                    .state
                    .encode(VERSION, &mut bytes)
                    .expect("the longest state");
                let start = Instant::now();
                publisher.push(client.record, &bytes[..size], start);
                samples.push(start.elapsed().as_nanos() as u64);
                reader.pop();
            }
            samples
        }),
    }
}

/// A driver with a running motion, and the datagrams on both sides of it.
struct Running {
    driver: Driver,
    state: Vec<u8>,
    command: [u8; RobotCommand::MAX_SIZE],
    time: u64,
}

impl Running {
    fn new() -> Self {
        let callback = Callback::torques(VERSION, |_, _| Torques([0.0; 7]));
        let request = callback.request(VERSION, MoveControllerMode::JointImpedance);
        let modes = Modes::of(&request);
        let mut driver = Driver::new(VERSION);
        driver.on_order(Order::Arm {
            motion: MotionId(1),
            modes,
            program: Program::Callback(Box::new(callback)),
            log: ControlLog::with_capacity(ControlLog::DEFAULT_CAPACITY),
            times: Arc::default(),
            observer: None,
            ticket: None,
        });
        let running = RobotState {
            robot_mode: RobotMode::Move,
            motion_generator_mode: modes.generator,
            controller_mode: modes.controller,
            ..RobotState::default()
        };
        let mut state = vec![0; RobotState::MAX_SIZE];
        let size = running
            .encode(VERSION, &mut state)
            .expect("the buffer holds the longest state");
        state.truncate(size);
        Self {
            driver,
            state,
            command: [0; RobotCommand::MAX_SIZE],
            time: 0,
        }
    }

    fn cycle(&mut self) {
        self.time += 1;
        // A state begins with its `message_id`.
        self.state[..8].copy_from_slice(&self.time.to_le_bytes());
        let state = RobotState::decode(VERSION, &self.state).expect("encoded as this version");
        let command = self.driver.on_state(&state).expect("the motion runs");
        command
            .encode(VERSION, &mut self.command)
            .expect("the buffer holds the longest command");
    }
}

const VERSION: Version = Version::V10;

/// Number of cycles in a round: ten seconds of an arm that moves to random targets.
const CYCLES: usize = 10_000;
const SAMPLES: usize = 400;
const BATCH: u32 = 32;

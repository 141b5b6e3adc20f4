//! franka-rs with its default options. It reads orders from the standard input, one line each, and
//! answers each with one line on the standard output.
//!
//! | order | what it does | answer |
//! |---|---|---|
//! | | connects to the argument, `HOST:PORT`, and holds the arm where it is | `ready` |
//! | `step X Y Z SECONDS` | moves the target by X Y Z, `[m]`, base frame, and records the arm for that long of the robot's time | `within SECONDS off METRES lag METRES` |
//! | `end` | comes to rest and ends | `ended` |

use std::error::Error;
use std::io::BufRead as _;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use franka::robot::target_control::{CartesianSent, CartesianTargetControl, TargetControlOptions};
use franka::{RealtimeConfig, Robot, RobotState};

/// The record of one cycle.
#[derive(Clone, Copy)]
struct Cycle {
    /// The robot's time, `[s]`.
    time: f64,
    measured: [f64; 3],
    commanded: [f64; 3],
    target: [f64; 3],
}

/// Cycles that a recording holds: a minute.
const CYCLES: usize = 60_000;

fn main() -> Result<(), Box<dyn Error>> {
    let address = std::env::args()
        .nth(1)
        .ok_or("usage: franka-rs-peer HOST:PORT")?;
    let robot = Arc::new(Robot::new(&address, RealtimeConfig::Ignore)?);
    // Pushes must not trigger a reflex.
    let (joints, forces) = ([100.0; 7], [500.0; 6]);
    robot.set_collision_behavior(
        joints, joints, joints, joints, forces, forces, forces, forces,
    )?;
    let cycles = Arc::new(Mutex::new(Vec::with_capacity(CYCLES)));
    let recorded = cycles.clone();
    let observer = move |state: &RobotState, sent: &CartesianSent| {
        let mut cycles = recorded.lock().unwrap_or_else(PoisonError::into_inner);
        if cycles.len() < CYCLES {
            cycles.push(Cycle {
                time: state.time.as_secs_f64(),
                measured: translation(&state.O_T_EE),
                commanded: translation(&sent.pose),
                target: sent.target,
            });
        }
    };
    let options = TargetControlOptions::default().with_observer(observer);
    let control = robot.start_cartesian_target_control(options)?;
    println!("ready");
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            ["step", x, y, z, seconds] => {
                let by = [x.parse()?, y.parse()?, z.parse()?];
                println!("{}", step(&control, &cycles, by, seconds.parse()?)?);
            }
            ["end"] => break,
            _ => return Err(format!("not an order: {line:?}").into()),
        }
    }
    control.stop()?;
    println!("ended");
    Ok(())
}

/// Steps the target, and returns the answer with the result of the step.
fn step(
    control: &CartesianTargetControl,
    cycles: &Mutex<Vec<Cycle>>,
    by: [f64; 3],
    seconds: f64,
) -> Result<String, Box<dyn Error>> {
    let start = control.target();
    let target: [f64; 3] = std::array::from_fn(|i| start[i] + by[i]);
    cycles.lock().map_err(|_| "the observer panicked")?.clear();
    let begin = control.state().time.as_secs_f64();
    control.set_position(target)?;
    while control.state().time.as_secs_f64() < begin + seconds {
        if !control.is_running() {
            return Err("the loop has ended".into());
        }
        thread::sleep(Duration::from_millis(1));
    }
    let cycles = cycles.lock().map_err(|_| "the observer panicked")?;
    let mut under_way = cycles
        .iter()
        .skip_while(|cycle| cycle.target != target)
        .peekable();
    let begin = under_way.peek().ok_or("no cycle saw the target")?.time;
    let (mut within, mut off, mut lag) = (0.0, 0.0, 0.0_f64);
    for cycle in under_way {
        off = distance(&cycle.measured, &target);
        lag = lag.max(distance(&cycle.measured, &cycle.commanded));
        if off > 1e-3 {
            within = cycle.time - begin;
        }
    }
    Ok(format!("within {within} off {off} lag {lag}"))
}

/// The translation of a column-major pose.
fn translation(pose: &[f64; 16]) -> [f64; 3] {
    [pose[12], pose[13], pose[14]]
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).powi(2))
        .sum::<f64>()
        .sqrt()
}

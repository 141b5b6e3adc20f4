//! franka-rs with its default options, or with the feedforward of velocities that it had by default
//! when its figures on real arms were measured. It reads orders from the standard input, one line
//! each, and answers each on the standard output.
//!
//! | order | what it does | answer |
//! |---|---|---|
//! | | connects to the first argument, `HOST:PORT`, and holds the arm where it is; `feedforward` may follow | `ready` |
//! | `step X Y Z SECONDS` | moves the target by X Y Z, `[m]`, base frame, for that long of the robot's time | `target X Y Z`, then a line `MILLISECOND X Y Z` per cycle, what was commanded on this state, and `done` |
//! | `end` | comes to rest and ends | `ended` |

use std::error::Error;
use std::io::{BufRead as _, Write as _};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use franka::robot::target_control::{
    Backend, CartesianSent, CartesianTargetControl, ImpedanceOptions, TargetControlOptions,
};
use franka::{RealtimeConfig, Robot, RobotState};

/// The record of one cycle.
#[derive(Clone, Copy)]
struct Cycle {
    /// The robot's time, `[ms]`.
    time: u64,
    commanded: [f64; 3],
    target: [f64; 3],
}

/// Cycles that a recording holds: a minute.
const CYCLES: usize = 60_000;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let address = arguments
        .next()
        .ok_or("usage: franka-rs-peer HOST:PORT [feedforward]")?;
    let law = ImpedanceOptions::cartesian();
    let law = match arguments.next().as_deref() {
        None => law,
        Some("feedforward") => law.with_velocity_feedforward(true),
        Some(other) => return Err(format!("not an option: {other:?}").into()),
    };
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
                time: state.time.as_millis(),
                commanded: [sent.pose[12], sent.pose[13], sent.pose[14]],
                target: sent.target,
            });
        }
    };
    let options = TargetControlOptions::default()
        .with_backend(Backend::Impedance(law))
        .with_observer(observer);
    let control = robot.start_cartesian_target_control(options)?;
    println!("ready");
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            ["step", x, y, z, seconds] => {
                let by = [x.parse()?, y.parse()?, z.parse()?];
                step(&control, &cycles, by, seconds.parse()?)?;
            }
            ["end"] => break,
            _ => return Err(format!("not an order: {line:?}").into()),
        }
    }
    control.stop()?;
    println!("ended");
    Ok(())
}

/// Steps the target, and prints the answer.
fn step(
    control: &CartesianTargetControl,
    cycles: &Mutex<Vec<Cycle>>,
    by: [f64; 3],
    seconds: f64,
) -> Result<(), Box<dyn Error>> {
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
    let cycles = cycles.lock().map_err(|_| "the observer panicked")?.clone();
    let mut answer = std::io::stdout().lock();
    let [x, y, z] = target;
    writeln!(answer, "target {x} {y} {z}")?;
    let held = |cycle: &&Cycle| cycle.target != target;
    for Cycle { time, commanded, .. } in cycles.iter().skip_while(held) {
        let [x, y, z] = commanded;
        writeln!(answer, "{time} {x} {y} {z}")?;
    }
    writeln!(answer, "done")?;
    Ok(())
}

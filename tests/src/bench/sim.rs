//! The simulated robot under target control in virtual time: how much faster than a robot.

use std::time::Instant;

use franka_sim::{Config, Robot, Tool};

use crate::bench::{Benchmark, Statistic};
use crate::lockstep::{Lockstep, Wander};

/// Milliseconds of robot time in a sample, and samples in a round.
const MILLISECONDS: u32 = 250;
const SAMPLES: usize = 4;

/// The simulator with each of its plants, and the driver's target control, in one thread.
pub fn all() -> Vec<Benchmark> {
    let mut benchmarks = vec![lockstep("sim.lockstep_x_rigid", Robot::new(config()))];
    #[cfg(feature = "mujoco")]
    benchmarks.push(lockstep("sim.lockstep_x_mujoco", mujoco()));
    benchmarks
}

/// An arm with a Hand's load in the ready pose.
fn config() -> Config {
    Config {
        tool: Tool::hand(),
        ..Config::default()
    }
}

/// On a table that it does not touch.
#[cfg(feature = "mujoco")]
fn mujoco() -> Robot {
    use franka_sim::plant::{MujocoArm, Scene};
    let config = config();
    let plant = MujocoArm::new(config.kind, Scene::table()).expect("a scene");
    Robot::with_plant(config, Box::new(plant))
}

fn lockstep(key: &'static str, robot: Robot) -> Benchmark {
    let mut wander = Wander::of(Lockstep::with_robot(robot), 1);
    let mut sample = move || {
        let start = Instant::now();
        for _ in 0..MILLISECONDS {
            wander.tick_around(|cycle| cycle());
        }
        let nanoseconds = start.elapsed().as_nanos() / u128::from(MILLISECONDS);
        u64::try_from(nanoseconds).unwrap_or(u64::MAX)
    };
    Benchmark {
        key,
        statistics: &[Statistic::RealTime],
        round: Box::new(move || (0..SAMPLES).map(|_| sample()).collect()),
    }
}

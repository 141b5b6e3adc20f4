//! The speed of the simulated robot under target control in virtual time, relative to a robot.
//! Measured in processor time, because a second of robot time takes long enough for other programs
//! to run meanwhile.

use std::time::Duration;

use franka_sim::{Config, Robot, Tool};
use nix::time::{ClockId, clock_gettime};

use super::{Benchmark, Statistic};
use franka_lockstep::{Lockstep, Wander};

/// Milliseconds of robot time in a sample, and samples in a round.
const MILLISECONDS: u32 = 250;
const SAMPLES: usize = 4;

/// Benchmarks of the simulator with each of its plants, and the driver's target control, in one
/// thread.
pub fn all() -> Vec<Benchmark> {
    vec![
        lockstep("sim.lockstep_x_rigid", Robot::new(config())),
        #[cfg(feature = "mujoco")]
        lockstep("sim.lockstep_x_mujoco", mujoco()),
    ]
}

/// Returns an arm with a Hand's load in the ready pose.
fn config() -> Config {
    Config {
        tool: Tool::hand(),
        ..Config::default()
    }
}

/// Returns the same arm in MuJoCo, above a table that it does not touch.
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
        let start = processor_time();
        for _ in 0..MILLISECONDS {
            wander.tick_around(|_, work| work());
        }
        let spent = processor_time().saturating_sub(start) / MILLISECONDS;
        u64::try_from(spent.as_nanos()).unwrap_or(u64::MAX)
    };
    Benchmark {
        key,
        statistics: &[Statistic::RealTime],
        round: Box::new(move || (0..SAMPLES).map(|_| sample()).collect()),
    }
}

/// Returns the processor time of this thread.
fn processor_time() -> Duration {
    let clock = ClockId::CLOCK_THREAD_CPUTIME_ID;
    Duration::from(clock_gettime(clock).expect("every thread has this clock"))
}

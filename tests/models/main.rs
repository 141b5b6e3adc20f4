//! Models from the robot: from its description, and from its own library.

mod described;
mod lengths;
#[cfg(target_os = "linux")]
mod library;
mod recorded;

use franka_async::{Realtime, Robot};
use franka_sim::{Running, Sim};
use franka_tests::PATIENCE;

/// Connects to a robot that waits for its commands.
async fn connected(sim: Sim) -> (Robot, Running) {
    let sim = sim.virtual_time(PATIENCE).start().await;
    let sim = sim.expect("a simulator starts");
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let robot = builder.connect().await.expect("a simulator takes a client");
    (robot, sim)
}

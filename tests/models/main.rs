//! Models from the robot: from its description, and from its own library.

mod described;
#[cfg(target_os = "linux")]
mod library;

use franka_async::{Realtime, Robot};
use franka_sim::{Running, Sim};

async fn connected(sim: Sim) -> (Robot, Running) {
    let sim = sim.start().await.expect("a simulator starts");
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    let robot = builder.connect().await.expect("a simulator takes a client");
    (robot, sim)
}

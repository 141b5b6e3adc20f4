//! The driver and the simulator over real sockets on this machine, where the socket or the clock is
//! what is tested.
//!
//! Run one at a time: each test has a robot, and two cores carry only so many.

mod active;
mod addresses;
mod cancelling;
mod connecting;
mod control;
mod crowd;
mod dropping;
mod ending;
mod engaging;
mod failing;
mod fer;
mod garbling;
mod hands;
mod misbehaving;
mod mishaps;
mod moving;
mod peer;
mod raising;
mod reading;
mod stalls;
mod starving;
mod telemetry;
mod together;

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use franka_async::{Motion, Pose, Realtime, Robot};
use franka_sim::{Running, Sim, Tool};
use tokio::sync::watch;

/// Held by each test, so that they do not disturb each other's clocks.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Held across every await of a test, which is its purpose: each test blocks a runtime of its own.
struct Alone {
    _guard: MutexGuard<'static, ()>,
}

fn alone() -> Alone {
    let _guard = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    Alone { _guard }
}

/// A simulated FR3 with a hand, and a handle on it.
async fn simulated() -> (Robot, Running) {
    let sim = Sim::fr3()
        .tool(Tool::hand())
        .start()
        .await
        .expect("a simulator starts");
    let robot = connect(&sim).await;
    (robot, sim)
}

async fn connect(sim: &Running) -> Robot {
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    builder.connect().await.expect("a simulator takes a client")
}

/// A motion of about four seconds.
fn long_way(robot: &Robot) -> Motion {
    robot
        .move_to(Pose::translation(0.0, 0.0, 0.1) * robot.pose())
        .speed(0.25)
}

/// Has the arm follow ten steps of 4 mm at 10 Hz to the end; returns the last target.
async fn follow_steps(robot: &Robot) -> Pose {
    let start = robot.pose();
    let (sender, targets) = watch::channel(start);
    let following = tokio::spawn(robot.follow(targets).into_future());
    let mut last = start;
    for step in 1..=10_u32 {
        last = Pose::translation(0.0, 0.004 * f64::from(step), 0.0) * start;
        sender.send(last).expect("the motion goes on");
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
    drop(sender);
    let outcome = following.await.expect("no panic");
    outcome.expect("the last target is reached");
    last
}

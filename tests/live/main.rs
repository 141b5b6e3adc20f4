//! The driver and the simulator over real sockets on this machine, for tests of the socket or the
//! clock.
//!
//! One test runs at a time, as two cores support only a few robots. Most robots run at the pace of
//! the client's answers, [`simulated`], or [`by_the_clock`] if readers have to keep up with them. A
//! busy machine makes them slow, and loses nothing. Tests wait for states; durations decide
//! nothing.

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
mod heading;
mod identifying;
mod metrics;
mod misbehaving;
mod mishaps;
mod moving;
mod peer;
mod planning;
mod raising;
mod reacting;
mod reading;
mod recording;
mod replaying;
mod scripts;
mod stalls;
mod starving;
mod stopping;
mod supervising;
mod taring;
mod team;
mod telemetry;
mod together;

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use franka_async::state::RobotState;
use franka_async::{Motion, Pose, Realtime, Robot};
use franka_sim::{Running, Sim, Tool};
use franka_tests::PATIENCE;
use tokio::sync::watch;
use tokio::time::timeout;

/// Held by each test, so that they do not disturb each other's clocks.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// Held across every await of a test, which is its purpose: each test blocks a separate runtime.
struct Alone {
    _guard: MutexGuard<'static, ()>,
}

fn alone() -> Alone {
    let _guard = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    Alone { _guard }
}

/// A simulated FR3 with a hand, at the pace of the client's answers, and a handle on it.
async fn simulated() -> (Robot, Running) {
    at_the_clients_pace(Sim::fr3().ideal().tool(Tool::hand())).await
}

/// This robot, which waits for each command of the client.
async fn at_the_clients_pace(sim: Sim) -> (Robot, Running) {
    let sim = sim.virtual_time(PATIENCE).start().await;
    let sim = sim.expect("a simulator starts");
    (connect(&sim).await, sim)
}

/// This robot, at no more than a thousand states per second; it also waits for each command.
async fn by_the_clock(sim: Sim) -> (Robot, Running) {
    let sim = sim.wait_for_commands(PATIENCE).start().await;
    let sim = sim.expect("a simulator starts");
    (connect(&sim).await, sim)
}

/// This robot, at a thousand states per second, which minds no command that comes late or is
/// missing.
async fn ahead_of_the_client(sim: Sim) -> (Robot, Running) {
    let sim = sim.configure(|config| {
        config.enforce_limits = false;
        config.enforce_communication = false;
    });
    let sim = sim.start().await.expect("a simulator starts");
    (connect(&sim).await, sim)
}

async fn connect(sim: &Running) -> Robot {
    let builder = Robot::builder(sim.addr()).realtime(Realtime::Ignore);
    builder.connect().await.expect("a simulator takes a client")
}

/// A motion of some twenty seconds of robot time, long enough for events during the motion.
fn long_way(robot: &Robot) -> Motion {
    robot
        .move_to(Pose::translation(0.0, 0.0, 0.1) * robot.pose())
        .speed(0.05)
}

/// Waits for a state for which `holds` returns true.
async fn until(robot: &Robot, mut holds: impl FnMut(&RobotState) -> bool) {
    let mut states = robot.state_stream();
    let shown = async {
        loop {
            let reading = states.next().await.expect("the connection lives");
            if holds(&reading.state) {
                return;
            }
        }
    };
    timeout(SOON, shown).await.expect("a state shows it");
}

/// Waits until `look` returns a value for a state, and returns it.
async fn shown<T>(robot: &Robot, mut look: impl FnMut() -> Option<T>) -> T {
    let mut found = None;
    until(robot, |_| {
        found = look();
        found.is_some()
    })
    .await;
    found.expect("it was found")
}

/// Waits for this many milliseconds of the robot's time.
async fn robot_time(robot: &Robot, milliseconds: u64) {
    let end = robot.state().message_id + milliseconds;
    until(robot, |state| state.message_id >= end).await;
}

/// Waits until a motion has run for a while.
async fn under_way(robot: &Robot) {
    until(robot, RobotState::motion_running).await;
    robot_time(robot, 200).await;
}

/// Makes the arm follow ten steps of 4 mm at 10 Hz to the end; returns the last target.
async fn follow_steps(robot: &Robot) -> Pose {
    let start = robot.pose();
    let (sender, targets) = watch::channel(start);
    let following = tokio::spawn(robot.follow(targets).into_future());
    let mut last = start;
    for step in 1..=10_u32 {
        last = Pose::translation(0.0, 0.004 * f64::from(step), 0.0) * start;
        sender.send(last).expect("the motion goes on");
        robot_time(robot, 100).await;
    }
    drop(sender);
    let outcome = following.await.expect("no panic");
    outcome.expect("the last target is reached");
    last
}

/// Time limit for every event, also on a busy machine.
const SOON: Duration = Duration::from_secs(300);

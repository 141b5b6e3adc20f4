//! The good client.

use std::fmt::Display;
use std::time::{Duration, Instant};

use franka_async::{Gripper, Pose, Realtime, Robot, VacuumGripper};
use tokio::runtime::{Builder, Runtime};

use crate::binary::Binary;

/// Time for a good client from its first try to the answer to its first request.
const SERVED: Duration = Duration::from_secs(1);

fn runtime() -> Runtime {
    let mut builder = Builder::new_multi_thread();
    builder.worker_threads(1).enable_all();
    builder.build().expect("a runtime")
}

/// The robot, the hand and the vacuum gripper each serve a good client within a second: connection,
/// state, request.
pub(crate) fn assert_served(binary: &Binary) {
    binary.assert_alive();
    runtime().block_on(async {
        let begun = Instant::now();
        let robot = connect(binary, begun).await;
        assert!(robot.state().message_id > 0);
        // It says what holds anyway: the robot is the same for the next client.
        let stiffness = [3000.0; 7];
        let set = robot.set_joint_impedance(stiffness).await;
        set.expect("a setter");
        in_time(begun, "robot");
        robot.shutdown().await;

        let [_, hand, vacuum] = binary.ports();
        let begun = Instant::now();
        let hand = patiently(begun, || Gripper::connect(hand.address)).await;
        assert!(hand.state().message_id > 0);
        assert!(hand.stop().await.expect("a stop"));
        in_time(begun, "hand");

        let begun = Instant::now();
        let vacuum = patiently(begun, || VacuumGripper::connect(vacuum.address)).await;
        assert!(vacuum.state().message_id > 0);
        assert!(vacuum.stop().await.expect("a stop"));
        in_time(begun, "vacuum gripper");
    });
}

fn in_time(begun: Instant, name: &str) {
    let time = begun.elapsed();
    assert!(time < SERVED, "the {name} took {time:?}");
}

/// Tries until the time is up: the client before may not have been taken leave of yet.
async fn patiently<T, E: Display, F: Future<Output = Result<T, E>>>(
    begun: Instant,
    connect: impl Fn() -> F,
) -> T {
    loop {
        match connect().await {
            Ok(connected) => return connected,
            Err(error) => assert!(begun.elapsed() < SERVED, "not let in: {error}"),
        }
    }
}

async fn connect(binary: &Binary, begun: Instant) -> Robot {
    let robot = || Robot::builder(binary.robot().address).realtime(Realtime::Ignore);
    patiently(begun, || robot().connect()).await
}

/// And moves: recovery, then a centimetre up.
pub(crate) fn assert_moves(binary: &Binary) {
    binary.assert_alive();
    runtime().block_on(async {
        let robot = connect(binary, Instant::now()).await;
        robot.recover().await.expect("a recovery");
        let up = Pose::translation(0.0, 0.0, 0.01) * robot.pose();
        robot.move_to(up).await.expect("a motion up");
        robot.shutdown().await;
    });
}

/// Clears what a client has left behind that was kept from answering by a busy machine.
pub(crate) fn recover(binary: &Binary) {
    runtime().block_on(async {
        let robot = connect(binary, Instant::now()).await;
        robot.recover().await.expect("a recovery");
        robot.shutdown().await;
    });
}

/// Moves a good client for a second or so and does `mischief` meanwhile. The motion arrives.
pub(crate) fn assert_moves_during(binary: &Binary, mischief: impl FnOnce()) {
    runtime().block_on(async {
        let robot = connect(binary, Instant::now()).await;
        robot.recover().await.expect("a recovery");
        let up = Pose::translation(0.0, 0.0, 0.05) * robot.pose();
        let moving = tokio::spawn(robot.move_to(up).into_future());
        while !robot.state().motion_running() {
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
        mischief();
        assert!(robot.state().motion_running(), "it is over too early");
        moving.await.expect("no panic").expect("a motion up");
        robot.shutdown().await;
    });
}

//! A client that observes the protocol.

use std::fmt::Display;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use franka_async::gripper::Gripper;
use franka_async::vacuum::VacuumGripper;
use franka_async::{Pose, Realtime, Robot};
use tokio::runtime::{Builder, Runtime};

use crate::binary::Binary;

/// Largest number of refusals of a good client. Before each refusal, the server waits for 50 ms
/// until the previous client disconnects.
const REFUSALS: usize = 20;

fn runtime() -> Runtime {
    let mut builder = Builder::new_multi_thread();
    builder.worker_threads(1).enable_all();
    builder.build().expect("a runtime")
}

/// Asserts that the robot, the hand and the vacuum gripper each serve a good client: connection,
/// state, request.
pub(crate) fn assert_served(binary: &Binary) {
    binary.assert_alive();
    runtime().block_on(async {
        let robot = connect(binary).await;
        assert!(robot.state().message_id > 0);
        // Every good client sets this value, so the robot is the same for the next client.
        let stiffness = [3000.0; 7];
        let set = robot.set_joint_impedance(stiffness).await;
        set.expect("a setter");
        robot.shutdown().await;

        let [_, hand, vacuum] = binary.ports();
        let hand = patiently(|| Gripper::connect(hand.address)).await;
        assert!(hand.state().message_id > 0);
        assert!(hand.stop().await.expect("a stop"));

        let vacuum = patiently(|| VacuumGripper::connect(vacuum.address)).await;
        assert!(vacuum.state().message_id > 0);
        assert!(vacuum.stop().await.expect("a stop"));
    });
}

/// Connects, and tries again after a refusal, because the server may still serve the previous
/// client.
async fn patiently<T, E: Display, F: Future<Output = Result<T, E>>>(connect: impl Fn() -> F) -> T {
    let mut refusals = 0;
    loop {
        match connect().await {
            Ok(connected) => return connected,
            Err(error) => assert!(refusals < REFUSALS, "not let in: {error}"),
        }
        refusals += 1;
    }
}

async fn connect(binary: &Binary) -> Robot {
    let robot = || Robot::builder(binary.robot().address).realtime(Realtime::Ignore);
    patiently(|| robot().connect()).await
}

/// Asserts that a good client can also recover the robot and move it, by one centimetre upwards.
pub(crate) fn assert_moves(binary: &Binary) {
    binary.assert_alive();
    runtime().block_on(async {
        let robot = connect(binary).await;
        robot.recover().await.expect("a recovery");
        let up = Pose::translation(0.0, 0.0, 0.01) * robot.pose();
        robot.move_to(up).await.expect("a motion up");
        robot.shutdown().await;
    });
}

/// Clears errors that delays on a busy machine have caused.
pub(crate) fn recover(binary: &Binary) {
    runtime().block_on(async {
        let robot = connect(binary).await;
        robot.recover().await.expect("a recovery");
        robot.shutdown().await;
    });
}

/// Moves the robot of a good client up and down while `mischief` runs, which begins in the middle
/// of a motion. Asserts that every motion reaches its target.
pub(crate) fn assert_moves_during(binary: &Binary, mischief: impl FnOnce() + Send) {
    let (begin, begun) = mpsc::channel();
    thread::scope(|scope| {
        let mischief = scope.spawn(move || {
            begun.recv().expect("the arm moves");
            mischief();
        });
        runtime().block_on(async {
            let robot = connect(binary).await;
            robot.recover().await.expect("a recovery");
            let start = robot.pose();
            let up = Pose::translation(0.0, 0.0, 0.05) * start;
            let moving = async {
                for target in [up, start].into_iter().cycle() {
                    robot.move_to(target).await.expect("a motion");
                    if mischief.is_finished() {
                        return;
                    }
                }
            };
            let under_way = async {
                while !robot.state().motion_running() {
                    tokio::time::sleep(Duration::from_millis(1)).await;
                }
                begin.send(()).expect("it is waited for");
            };
            tokio::join!(moving, under_way);
            robot.shutdown().await;
        });
    });
}

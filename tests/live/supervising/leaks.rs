//! Leaks after mishaps: no thread, no descriptor, no task, no future.

use std::future::IntoFuture;
use std::time::Duration;

use franka_async::state::RobotError;
use franka_async::supervision::Condition;
use franka_sim::Sim;
use franka_tests::thorough;
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};
use tokio::runtime::Handle;
use tokio::time::{sleep, timeout};

use super::{condition, policy, restart, small_motion, start, supervised};
use crate::{SOON, alone, long_way, under_way};

/// Resources of this process, the simulator included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Resources {
    threads: usize,
    descriptors: usize,
    /// Tasks of the runtime.
    tasks: usize,
}

impl Resources {
    fn now() -> Self {
        let count = |path| std::fs::read_dir(path).expect("Linux").count();
        Self {
            threads: count("/proc/self/task"),
            descriptors: count("/proc/self/fd"),
            tasks: Handle::current().metrics().num_alive_tasks(),
        }
    }

    fn exceed(&self, before: &Self) -> bool {
        self.threads > before.threads
            || self.descriptors > before.descriptors
            || self.tasks > before.tasks
    }
}

/// Mishaps before the count begins: by then everything that the runtime starts permanently exists.
const WARM_UP: u64 = 10;

/// Each mishap happens during a motion, which ends with an error. A single leak of the rarest kind
/// of mishap fails the test.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn random_mishaps_leave_nothing_behind() {
    let _alone = alone();
    let mishaps = if thorough() { 1000 } else { 60 };
    let mut random = SmallRng::seed_from_u64(1);
    let mut sim = start(Sim::fr3()).await;
    let address = sim.addr();
    let robot = supervised(&sim, policy()).await;
    small_motion(&robot).await.expect("it is ready");
    let mut before = Resources::now();
    let mut restarts = 0;
    for mishap in 0..mishaps {
        if mishap == WARM_UP {
            before = Resources::now();
        }
        let moving = tokio::spawn(long_way(&robot).into_future());
        under_way(&robot).await;
        match random.random_range(0..4) {
            0 => {
                let trip = |robot: &mut franka_sim::Robot| robot.trip(RobotError::JointReflex);
                sim.with(trip).await.expect("it runs");
            }
            1 => {
                for pressed in [true, false] {
                    let press = move |robot: &mut franka_sim::Robot| {
                        robot.press_user_stop(pressed);
                    };
                    sim.with(press).await.expect("it runs");
                    crate::robot_time(&robot, 20).await;
                }
            }
            _ => {
                sim.stop().await;
                sim = restart(address).await;
                restarts += 1;
            }
        }
        let outcome = timeout(SOON, moving).await.expect("no hang").unwrap();
        outcome.expect_err("it was cut short");
        condition(&robot, Condition::Ready).await;
    }
    // The runtime ends idle threads of blocking work when it likes.
    let settled = timeout(Duration::from_secs(60), async {
        while Resources::now().exceed(&before) {
            sleep(Duration::from_millis(20)).await;
        }
    });
    let left = settled.await.map_err(|_| Resources::now());
    println!("{mishaps} mishaps, {restarts} restarts: {before:?} before and after");
    assert_eq!(left, Ok(()), "before: {before:?}");
    assert_eq!(robot.health().newest().reconnects, restarts);
    robot.shutdown().await;
    let threads = std::fs::read_dir("/proc/self/task").unwrap();
    let control = threads
        .filter_map(|task| std::fs::read_to_string(task.ok()?.path().join("comm")).ok())
        .filter(|name| name.trim() == "franka-rt");
    assert_eq!(control.count(), 0);
}

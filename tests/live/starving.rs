//! A runtime whose every worker is blocked does not reach the control thread.

use std::time::{Duration, Instant};

use franka_async::{MotionReport, Pose, Robot};
use franka_sim::{Sim, Tool};
use tokio::runtime::Builder;

use crate::{alone, connect};

const WORKERS: usize = 2;
const BLOCKED: Duration = Duration::from_secs(2);

/// What the control thread did while the workers were blocked, or might have been.
#[derive(Debug)]
struct Window {
    states: u64,
    commands: u64,
    lost: u64,
    report: MotionReport,
}

/// Runs one motion of some five seconds and watches two seconds in the middle of it.
fn run(block: bool) -> Window {
    let runtime = Builder::new_multi_thread()
        .worker_threads(WORKERS)
        .enable_all()
        .build()
        .unwrap();
    // The simulator has a runtime of its own, as a robot would.
    let elsewhere = Builder::new_multi_thread()
        .worker_threads(1)
        .enable_all()
        .build()
        .unwrap();
    let sim = elsewhere
        .block_on(Sim::fr3().tool(Tool::hand()).start())
        .unwrap();
    let robot: Robot = runtime.block_on(connect(&sim));

    let target = Pose::translation(0.0, 0.0, 0.1) * robot.pose();
    let moving = runtime.spawn(robot.move_to(target).speed(0.2).into_future());
    std::thread::sleep(Duration::from_millis(1000));

    if block {
        for _ in 0..WORKERS {
            runtime.spawn(async { std::thread::sleep(BLOCKED) });
        }
    }
    // Both workers are taken by the time that this thread wakes again.
    std::thread::sleep(Duration::from_millis(100));
    let count = || {
        let stats = robot.stats();
        [
            stats.states.get(),
            stats.commands.get(),
            stats.lost.get() + stats.skipped.get(),
        ]
    };
    let (before, begun) = (count(), Instant::now());
    std::thread::sleep(BLOCKED - Duration::from_millis(200));
    let after = count();
    assert!(
        begun.elapsed() < BLOCKED,
        "this machine is too busy to tell"
    );
    let report = runtime
        .block_on(moving)
        .unwrap()
        .expect("the motion arrives all the same");
    runtime.block_on(robot.shutdown());
    let [states, commands, lost] = core::array::from_fn(|i| after[i] - before[i]);
    Window {
        states,
        commands,
        lost,
        report,
    }
}

#[test]
fn blocking_every_worker_for_two_seconds_loses_no_cycle_of_a_motion() {
    let _alone = alone();
    let idle = run(false);
    let blocked = run(true);
    println!("idle: {idle:?}\nblocked: {blocked:?}");
    for window in [&idle, &blocked] {
        // Every state that arrived was answered. One may be in the thread's hands at either end.
        assert!(window.states.abs_diff(window.commands) <= 2, "{window:?}");
        assert!(window.states > 1500, "{window:?}");
    }
    // What the machine itself loses differs from run to run; a starved loop would lose all of 1800.
    assert!(
        blocked.lost <= idle.lost + 90,
        "idle {idle:?}, blocked {blocked:?}"
    );
    assert!(blocked.report.final_error.unwrap().translation < 1e-3);
}

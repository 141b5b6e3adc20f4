//! Data of the kernel about the threads of this process while a robot is controlled.

use std::collections::BTreeMap;
use std::time::Duration;

use franka_async::error::SchedError;
use franka_async::{Pose, Realtime, Robot};
use franka_sim::Sim;
use franka_tests::PATIENCE;

use crate::alone;

/// Data of the kernel about one thread.
#[derive(Debug)]
struct Scheduled {
    name: String,
    /// 0 the normal policy, 1 `SCHED_FIFO`.
    policy: i32,
    /// 0 under the normal policy.
    priority: i32,
    nice: i32,
    processors: String,
}

/// All threads of this process, by their ids. Fields 19, 40 and 41 of proc_pid_stat(5), and two
/// lines of proc_pid_status(5).
fn threads() -> BTreeMap<u32, Scheduled> {
    let tasks = std::fs::read_dir("/proc/self/task").expect("Linux has /proc");
    let mut threads = BTreeMap::new();
    for task in tasks.flatten() {
        let read = |file| std::fs::read_to_string(task.path().join(file));
        // A thread that has just ended has neither.
        let (Ok(stat), Ok(status)) = (read("stat"), read("status")) else {
            continue;
        };
        let fields: Vec<&str> = stat[stat.rfind(')').expect("a name") + 1..]
            .split_whitespace()
            .collect();
        let number = |field: usize| fields[field - 3].parse().expect("a number");
        let line = |name| {
            let value = status.lines().find_map(|line| line.strip_prefix(name));
            value.expect("every thread has it").trim().to_owned()
        };
        let id = task.file_name().to_string_lossy().parse().expect("an id");
        let thread = Scheduled {
            name: line("Name:"),
            policy: number(41),
            priority: number(40),
            nice: number(19),
            processors: line("Cpus_allowed_list:"),
        };
        threads.insert(id, thread);
    }
    threads
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn raising_and_pinning_affect_only_control_threads() {
    let _alone = alone();
    let before = threads();
    let usual = before.values().next().expect("this one").processors.clone();
    let (mut sims, mut robots) = (Vec::new(), Vec::new());
    for sim in [Sim::fr3().ideal(), Sim::fer().ideal()] {
        let sim = sim.virtual_time(PATIENCE).start().await;
        let sim = sim.expect("a simulator starts");
        let builder = Robot::builder(sim.addr())
            .realtime(Realtime::Ignore)
            .priority(42)
            .cpu(0)
            .busy_poll(Duration::from_micros(20));
        let robot = builder.connect().await.expect("a simulator takes a client");
        sims.push(sim);
        robots.push(robot);
    }
    // Everything else that the driver starts exists once an arm has moved: tasks, blocking threads.
    for robot in &robots {
        let up = Pose::translation(0.0, 0.0, 0.005) * robot.pose();
        robot.move_to(up).await.expect("it arrives");
    }
    tokio::task::spawn_blocking(|| ()).await.expect("no panic");
    let granted = robots[0].granted();
    for refusal in &granted.refusals {
        println!("this host refuses: {refusal}");
    }
    // The test step sets this variable if the right is available.
    if std::env::var_os("FRANKA_REALTIME_GRANTED").is_some() {
        assert_eq!(granted.priority, Some(42), "{:?}", granted.refusals);
    }
    let refused = |kind: fn(&SchedError) -> bool| granted.refusals.iter().any(kind);
    let pinned = !refused(|refusal| matches!(refusal, SchedError::Pin { .. }));

    let (control, others): (Vec<_>, Vec<_>) = threads()
        .into_values()
        .partition(|thread| thread.name == "franka-rt");
    assert_eq!(control.len(), 2, "one for each robot: {control:?}");
    for thread in &control {
        match granted.priority {
            Some(priority) => {
                assert_eq!(priority, 42);
                assert_eq!((thread.policy, thread.priority), (1, 42), "{thread:?}");
            }
            None => assert_eq!((thread.policy, thread.priority), (0, 0), "{thread:?}"),
        }
        let expected = if pinned { "0" } else { &usual };
        assert_eq!(thread.processors, expected, "{thread:?}");
    }
    assert!(others.len() >= 4, "two simulators, and workers: {others:?}");
    for thread in &others {
        assert_eq!((thread.policy, thread.priority), (0, 0), "{thread:?}");
        assert_eq!(thread.processors, usual, "{thread:?}");
        assert_eq!(
            thread.nice,
            before.values().next().expect("one").nice,
            "{thread:?}"
        );
    }

    for robot in robots {
        robot.shutdown().await;
    }
    let left: Vec<String> = threads().into_values().map(|thread| thread.name).collect();
    assert!(!left.iter().any(|name| name == "franka-rt"), "{left:?}");
    for sim in sims {
        sim.stop().await;
    }
}

/// With `Enforce`, a host that refuses a setting gets no connection, and the calling thread is
/// unchanged.
#[tokio::test]
async fn refused_enforced_setting_connects_and_raises_nothing() {
    let _alone = alone();
    let sim = Sim::fr3()
        .ideal()
        .start()
        .await
        .expect("a simulator starts");
    let builder = Robot::builder(sim.addr()).priority(1_000);
    let error = builder.connect().await.expect_err("no such priority");
    let why = match cfg!(all(target_os = "linux", not(franka_portable))) {
        true => "Invalid argument",
        false => "Operation not supported",
    };
    assert_eq!(
        error.to_string(),
        format!(
            "libfranka: unable to set realtime scheduling: {why} (for a simulator, use \
             `Realtime::Ignore`, or in Python `realtime=\"ignore\"`)"
        )
    );
    for thread in threads().into_values() {
        assert_eq!((thread.policy, thread.priority), (0, 0), "{thread:?}");
    }
    sim.stop().await;
}

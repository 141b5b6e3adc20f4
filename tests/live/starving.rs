//! A runtime whose every worker is blocked, and processors that are all busy, do not reach the
//! control thread.

use std::fs;
use std::future::IntoFuture;
use std::hint;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use franka_async::{Engage, Guard, Lapse, MotionError, MotionReport, OnTimeout, Pose, Realtime};
use franka_rt::sched::Scheduling;
use franka_sim::{Sim, Tool};
use tokio::runtime::{Builder, Runtime};
use tokio::sync::watch;

use crate::{alone, connect};

const WORKERS: usize = 2;

/// How long something is in the way of a motion of some five seconds.
const DISTURBED: Duration = Duration::from_secs(2);

/// What is in the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Beside {
    Nothing,
    /// Every worker of the program's runtime sleeps.
    BlockedWorkers,
    /// A thread of normal priority per processor computes, and so does nobody else who has to wait
    /// for it.
    BusyProcessors,
}

/// What the control thread did meanwhile.
#[derive(Debug)]
struct Window {
    states: u64,
    commands: u64,
    /// States that never came or gave way to a newer one.
    lost: u64,
    /// States for which the simulator's own thread was late.
    late: u64,
    report: MotionReport,
}

fn runtime(workers: usize) -> Runtime {
    let builder = Builder::new_multi_thread()
        .worker_threads(workers)
        .enable_all()
        .build();
    builder.expect("a runtime")
}

/// Runs one motion and watches the middle of it. A robot that is not `strict` minds no lost
/// command.
fn run(beside: Beside, strict: bool) -> Window {
    let runtime = runtime(WORKERS);
    // The simulator has a runtime of its own, as a robot would.
    let elsewhere = self::runtime(1);
    let sim = Sim::fr3().tool(Tool::hand()).enforce_communication(strict);
    let sim = elsewhere.block_on(sim.start()).unwrap();
    let robot = runtime.block_on(connect(&sim));
    // Its thread has sent states, and so has named itself.
    prefer_the_simulator();

    let target = Pose::translation(0.0, 0.0, 0.1) * robot.pose();
    let moving = runtime.spawn(robot.move_to(target).speed(0.2).into_future());
    sleep(Duration::from_millis(1000));

    let count = || {
        let stats = robot.stats();
        let lost = stats.lost.get() + stats.skipped.get();
        let late = elsewhere.block_on(sim.pace()).expect("it runs").late();
        [stats.states.get(), stats.commands.get(), lost, late]
    };
    let (before, after) = match beside {
        Beside::Nothing => {
            let before = count();
            sleep(DISTURBED);
            (before, count())
        }
        Beside::BlockedWorkers => {
            for _ in 0..WORKERS {
                runtime.spawn(async { sleep(DISTURBED) });
            }
            // Both workers are taken by the time that this thread wakes again.
            sleep(Duration::from_millis(100));
            let (before, begun) = (count(), Instant::now());
            sleep(DISTURBED - Duration::from_millis(200));
            let after = count();
            assert!(
                begun.elapsed() < DISTURBED,
                "this machine is too busy to tell"
            );
            (before, after)
        }
        Beside::BusyProcessors => {
            let before = count();
            compute_everywhere();
            (before, count())
        }
    };
    let report = runtime.block_on(moving).unwrap();
    let report = report.expect("the motion arrives all the same");
    runtime.block_on(robot.shutdown());
    let [states, commands, lost, late] = core::array::from_fn(|i| after[i] - before[i]);
    Window {
        states,
        commands,
        lost,
        late,
        report,
    }
}

/// Keeps every processor busy for a while, at the priority that threads have by default.
fn compute_everywhere() {
    let end = Instant::now() + DISTURBED;
    let processors = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..processors {
            scope.spawn(|| {
                while Instant::now() < end {
                    (0..1000).for_each(|_| hint::spin_loop());
                }
            });
        }
    });
}

/// Puts the thread of the simulator, which stands for another computer, where this one's load does
/// not reach it; below the control thread. Has no effect where the system does not grant it.
pub(crate) fn prefer_the_simulator() {
    for task in fs::read_dir("/proc/self/task").expect("Linux") {
        let task = task.expect("a thread").path();
        // A thread that has ended meanwhile is not the simulator's.
        let name = fs::read_to_string(task.join("comm")).unwrap_or_default();
        let id = task.file_name().and_then(|id| id.to_str()?.parse().ok());
        if let ("franka-sim", Some(id)) = (name.trim_end(), id) {
            // SAFETY: `sched_param` is a C struct of integers, for which all zeros is a valid
            // value.
            let mut parameters: libc::sched_param = unsafe { std::mem::zeroed() };
            parameters.sched_priority = 10;
            // SAFETY: the function takes numbers, and reads `parameters`, which lives until it
            // returns.
            unsafe { libc::sched_setscheduler(id, libc::SCHED_FIFO, &raw const parameters) };
        }
    }
}

/// Asserts what holds whatever the system grants.
fn assert_answered(window: &Window) {
    // Every state that arrived was answered. One may be in the thread's hands at either end.
    assert!(window.states.abs_diff(window.commands) <= 2, "{window:?}");
    let error = window.report.final_error.expect("it has a target");
    assert!(error.translation < 1e-3, "{window:?}");
}

#[test]
fn blocking_every_worker_for_two_seconds_loses_no_cycle_of_a_motion() {
    let _alone = alone();
    let idle = run(Beside::Nothing, true);
    let blocked = run(Beside::BlockedWorkers, true);
    println!("idle: {idle:?}\nblocked: {blocked:?}");
    for window in [&idle, &blocked] {
        assert_answered(window);
        assert!(window.states > 1500, "{window:?}");
    }
    // What the machine itself loses differs from run to run; a starved loop would lose all of 1800.
    assert!(
        blocked.lost <= idle.lost + 90,
        "idle {idle:?}, blocked {blocked:?}"
    );
}

/// While the workers are blocked nobody passes targets on, and the control thread takes note of
/// that by itself.
#[test]
fn a_session_whose_stream_blocked_workers_hold_up_is_braked_in_time() {
    const SILENCE: Duration = Duration::from_millis(200);
    const NEVER: u64 = 0;

    let _alone = alone();
    let runtime = runtime(WORKERS);
    let elsewhere = self::runtime(1);
    let sim = Sim::fr3().tool(Tool::hand()).enforce_communication(false);
    let sim = elsewhere.block_on(sim.start()).unwrap();
    let robot = runtime.block_on(connect(&sim));
    prefer_the_simulator();

    // The robot's time of the newest cycle, and of the first in which the stream counted as silent.
    let times = Arc::new([AtomicU64::new(NEVER), AtomicU64::new(NEVER)]);
    let seen = times.clone();
    let engage = Engage::default().observer(move |record, _| {
        let [newest, lapsed] = &*seen;
        newest.store(record.time, Ordering::Relaxed);
        let silent = record.bindings.contains(Guard::Watchdog);
        if silent && lapsed.load(Ordering::Relaxed) == NEVER {
            lapsed.store(record.time, Ordering::Relaxed);
        }
    });
    let time = |which: usize| times[which].load(Ordering::Relaxed);
    let arm = runtime.block_on(robot.engage(engage)).unwrap();
    let start = robot.pose();
    let (sender, targets) = watch::channel(start);
    let following = arm.follow(targets).watchdog(SILENCE, OnTimeout::Brake);
    let following = runtime.spawn(following.into_future());
    let stream = |steps: std::ops::Range<u32>| {
        for step in steps {
            let way = Pose::translation(0.0, 0.001 * f64::from(step), 0.0);
            sender.send(way * start).expect("it is being followed");
            sleep(Duration::from_millis(20));
        }
    };
    stream(0..50);
    assert_eq!(time(1), NEVER, "targets come");

    for _ in 0..WORKERS {
        runtime.spawn(async { sleep(DISTURBED) });
    }
    let (stats, before, begun) = (robot.stats(), time(0), Instant::now());
    let count = || [stats.states.get(), stats.commands.get()];
    let counted = count();
    stream(50..130);
    let (after, lapsed) = (count(), time(1));
    assert!(
        begun.elapsed() < DISTURBED,
        "this machine is too busy to tell"
    );
    let [states, commands] = core::array::from_fn(|i| after[i] - counted[i]);
    println!("{states} states, silent after {} ms", lapsed - before);
    assert!(states.abs_diff(commands) <= 2, "{states}, {commands}");
    // By the robot's clock, give or take a target that was being passed on.
    assert!((before + 150..before + 400).contains(&lapsed));

    // The workers may take the newest target up again before they hear of it.
    drop(sender);
    match runtime.block_on(following).expect("no panic") {
        Ok(_) => println!("taken up again"),
        Err(error) => assert!(
            matches!(error, MotionError::Braked(Lapse::Silent { .. })),
            "{error}"
        ),
    }
    runtime.block_on(arm.disengage()).expect("it ends");
    runtime.block_on(robot.shutdown());
}

/// Without `SCHED_FIFO` the control thread has its fair share of a processor and no more, so there
/// is nothing to hold it to but that it answers what it gets.
#[test]
fn two_seconds_of_a_full_load_on_every_processor_lose_no_motion_where_the_kernel_grants_priority() {
    let _alone = alone();
    let scheduling = Scheduling {
        realtime: Realtime::Ignore,
        ..Scheduling::default()
    };
    let granted = scheduling.probe().expect("nothing is enforced");
    let preferred = granted.priority.is_some();
    let loaded = run(Beside::BusyProcessors, preferred);
    println!("loaded: {loaded:?}");
    assert_answered(&loaded);
    if preferred {
        assert!(loaded.states > 1500, "{loaded:?}");
        // Five of a hundred; the robot gives up after twenty in a row. Those that came too late are
        // not the thread's.
        assert!(loaded.lost <= loaded.late + 100, "{loaded:?}");
    } else {
        println!("PUNCTUALITY WAS NOT CHECKED: {:?}", granted.refusals);
    }
}

//! A runtime with all workers blocked, and busy processors, do not keep the control thread from its
//! cycles.
//!
//! The robots run at the pace of the client's answers, so each test checks that every state was
//! answered. `cargo xtask bench starvation` measures the lateness of answers on a busy machine.

use std::hint;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, mpsc};
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use franka_async::error::Lapse;
use franka_async::goal::OnTimeout;
use franka_async::record::{CapturedCycle, Guard};
use franka_async::{Engage, MotionError, MotionReport, Pose, Robot};
use franka_sim::{Running, Sim, Tool};
use tokio::runtime::{Builder, Runtime};
use tokio::sync::watch;

use crate::{SOON, alone, connect, under_way};

const WORKERS: usize = 2;

fn runtime(workers: usize) -> Runtime {
    let builder = Builder::new_multi_thread()
        .worker_threads(workers)
        .enable_all()
        .build();
    builder.expect("a runtime")
}

/// A program on one runtime, and a robot elsewhere.
struct Setting {
    runtime: Runtime,
    elsewhere: Runtime,
    robot: Robot,
    sim: Running,
}

impl Setting {
    /// A robot that waits for every command for the longest time of a test. Only a thread that runs
    /// independently stops it.
    fn patient() -> Self {
        let (runtime, elsewhere) = (runtime(WORKERS), runtime(1));
        let sim = Sim::fr3().ideal().tool(Tool::hand()).virtual_time(SOON);
        let sim = elsewhere.block_on(sim.start()).expect("a simulator starts");
        let robot = runtime.block_on(connect(&sim));
        Self {
            runtime,
            elsewhere,
            robot,
            sim,
        }
    }

    /// The robot's clock, `[ms]`.
    fn time(&self) -> u64 {
        let state = self.elsewhere.block_on(self.sim.state());
        state.expect("the simulator runs").message_id
    }

    /// Waits for this many milliseconds of the robot's time.
    fn wait(&self, milliseconds: u64) {
        let (begun, end) = (Instant::now(), self.time() + milliseconds);
        while self.time() < end {
            assert!(begun.elapsed() < SOON, "the robot waits for commands");
            sleep(Duration::from_millis(1));
        }
    }

    /// Blocks every worker of the program, until the value is dropped.
    fn block_workers(&self) -> Vec<mpsc::Sender<()>> {
        let blocked = Arc::new(AtomicU64::new(0));
        let release = (0..WORKERS).map(|_| {
            let (release, held) = mpsc::channel::<()>();
            let blocked = blocked.clone();
            self.runtime.spawn(async move {
                blocked.fetch_add(1, Ordering::Relaxed);
                held.recv().expect_err("nothing is sent");
            });
            release
        });
        let release = release.collect();
        let begun = Instant::now();
        while blocked.load(Ordering::Relaxed) < WORKERS as u64 {
            assert!(begun.elapsed() < SOON, "the workers take tasks");
            sleep(Duration::from_millis(1));
        }
        release
    }

    /// The report of a motion with this in its middle, which lasts until that is over.
    fn moves_beside(&self, disturb: impl FnOnce(&Self)) -> MotionReport {
        let up = Pose::translation(0.0, 0.0, 0.1);
        let (sender, targets) = watch::channel(up * self.robot.pose());
        let moving = self.robot.follow(targets).speed(0.05);
        let moving = self.runtime.spawn(moving.into_future());
        self.runtime.block_on(under_way(&self.robot));
        let missed = || {
            let stats = self.robot.stats();
            (stats.lost.get(), stats.skipped.get())
        };
        let before = missed();
        disturb(self);
        // Counted from here, because the robot waits only some milliseconds for the answer to the
        // first state, and a thread without priority may be too late.
        assert_eq!(missed(), before, "lost and skipped");
        assert!(!moving.is_finished(), "it is still under way");
        drop(sender);
        let report = self.runtime.block_on(moving).expect("no panic");
        self.runtime.block_on(self.robot.shutdown());
        report.expect("it arrives all the same")
    }
}

fn assert_every_state_was_answered(report: &MotionReport) {
    assert_eq!(report.success_rate_min, 1.0, "{report:?}");
    let error = report.final_error.expect("it has a target");
    assert!(error.translation < 1e-3, "{report:?}");
}

#[test]
fn blocked_workers_lose_no_cycle_of_a_motion() {
    let _alone = alone();
    let report = Setting::patient().moves_beside(|setting| {
        let release = setting.block_workers();
        setting.wait(2000);
        drop(release);
    });
    assert_every_state_was_answered(&report);
}

/// The ring holds the whole motion, so that only a reader that needs a worker could lose cycles.
#[test]
fn blocked_workers_lose_no_cycle_of_a_reader_thread() {
    let _alone = alone();
    let setting = Setting::patient();
    let mut reader = setting.robot.cycles(65_536).expect("there is room");
    setting.moves_beside(|setting| {
        while reader.pop().is_some() {}
        let release = setting.block_workers();
        let begun = setting.time();
        setting.wait(2000);
        let cycles = std::iter::from_fn(|| reader.pop());
        let taken: Vec<_> = cycles
            .take_while(|cycle| cycle.record.time <= begun + 2000)
            .collect();
        drop(release);
        let times = taken.iter().map(|cycle| cycle.record.time);
        let last = times.clone().next_back().expect("states came");
        assert!(
            last > begun + 1990,
            "{last}, {begun}: of the time of the block"
        );
        let first = taken[0].record.time;
        assert!(times.eq(first..=last), "each once and in order");
        let moves = |cycle: &&CapturedCycle| cycle.record.pose_target.is_some();
        assert!(
            taken.iter().any(|cycle| moves(&cycle)),
            "the motion goes on"
        );
    });
    while reader.wait(SOON) {
        reader.pop();
    }
    assert!(reader.has_ended() && reader.lost() == 0);
}

#[test]
fn a_full_load_on_every_processor_loses_no_cycle_of_a_motion() {
    let _alone = alone();
    let report = Setting::patient().moves_beside(|setting| {
        let over = AtomicBool::new(false);
        let processors = thread::available_parallelism().map_or(1, usize::from);
        thread::scope(|scope| {
            for _ in 0..processors {
                scope.spawn(|| {
                    while !over.load(Ordering::Relaxed) {
                        hint::spin_loop();
                    }
                });
            }
            setting.wait(500);
            over.store(true, Ordering::Relaxed);
        });
    });
    assert_every_state_was_answered(&report);
}

/// While the workers are blocked no target is passed on, and the control thread detects that
/// without them.
#[test]
fn session_brakes_in_time_if_workers_block_its_stream() {
    /// Duration on the robot's clock, which runs faster than the wall clock.
    const SILENCE: Duration = Duration::from_secs(5);
    const NEVER: u64 = 0;

    let _alone = alone();
    let setting = Setting::patient();
    let Setting { runtime, robot, .. } = &setting;

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
    let send = |step: u32| {
        let way = Pose::translation(0.0, 0.001 * f64::from(step), 0.0);
        sender.send(way * start).expect("it is being followed");
    };
    for step in 0..20 {
        send(step);
        setting.wait(20);
    }
    assert_eq!(time(1), NEVER, "targets come");

    let release = setting.block_workers();
    // No target is passed on from here, even if the stream yields one.
    let blocked = time(0);
    let begun = Instant::now();
    // Within reach, however long it takes: the last target may be taken up.
    for step in [20, 21].into_iter().cycle() {
        if time(1) != NEVER {
            break;
        }
        assert!(begun.elapsed() < SOON, "the control thread never notices");
        send(step);
        sleep(Duration::from_millis(5));
    }
    let lapsed = time(1);
    let longest = SILENCE.as_millis() as u64 + 2;
    assert!(
        lapsed > blocked && lapsed <= blocked + longest,
        "{lapsed}, {blocked}"
    );
    drop(release);

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

//! Measures the effect of blocked runtime workers on an exchange of states and commands at 1 kHz,
//! first on the control thread, then in a task of the program's async runtime. Each runs with the
//! runtime idle, and with all its workers blocked for 20 of every 100 milliseconds.
//!
//! The robot here sends a state per millisecond and expects a command for each. A command that has
//! not arrived when the next state leaves is lost, as on a robot.

mod responders;
mod robot;

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Barrier};
use std::thread;
use std::time::Duration;

use franka_rt::sched::{Realtime, Scheduling};
use tokio::runtime::{Builder, Runtime};

use responders::Responder;
use robot::Outcome;

/// Prints a line for each case, of `seconds` each.
pub(crate) fn print(seconds: u32) {
    match preferred(None).probe() {
        Ok(granted) if granted.priority.is_some() => {
            println!("SCHED_FIFO is granted: to the control thread, and to the robot");
        }
        _ => println!("SCHED_FIFO is NOT GRANTED: the control thread competes with all others"),
    }
    println!("{seconds} s each; turnaround in microseconds, of the states that were answered");
    println!("driver          workers    states   lost     p50     p99   p99.9     max");
    for responder in [Responder::Thread, Responder::Task] {
        for blocked in [false, true] {
            let outcome = measure(responder, blocked, Duration::from_secs(seconds.into()));
            let workers = if blocked { "blocked" } else { "idle" };
            println!("{:<15} {workers:<8} {outcome}", responder.name());
        }
    }
}

/// Requests this priority, the highest if `None`; a refusal is not an error.
fn preferred(priority: Option<i32>) -> Scheduling {
    Scheduling {
        realtime: Realtime::Ignore,
        priority,
        ..Scheduling::default()
    }
}

fn measure(responder: Responder, blocked: bool, time: Duration) -> Outcome {
    let runtime = Builder::new_multi_thread()
        .worker_threads(WORKERS)
        .enable_all()
        .build()
        .expect("a runtime");
    let ended = AtomicBool::new(false);
    thread::scope(|scope| {
        if blocked {
            scope.spawn(|| {
                while !ended.load(Ordering::Relaxed) {
                    block(&runtime);
                    thread::sleep(PERIOD);
                }
            });
        }
        let outcome = responder.run(&runtime, time);
        ended.store(true, Ordering::Relaxed);
        outcome
    })
}

/// Makes every worker sleep at the same time.
fn block(runtime: &Runtime) {
    let together = Arc::new(Barrier::new(WORKERS));
    for _ in 0..WORKERS {
        let together = together.clone();
        runtime.spawn(async move {
            together.wait();
            thread::sleep(BLOCKED);
        });
    }
}

/// A typical number on small computers.
const WORKERS: usize = 2;

/// Interval between blocks.
const PERIOD: Duration = Duration::from_millis(100);

/// A typical duration of a database query, JSON parsing or image decoding.
const BLOCKED: Duration = Duration::from_millis(20);

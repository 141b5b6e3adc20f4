//! What a busy program costs whom: `starvation [SECONDS]` exchanges states and commands at 1 kHz,
//! on the control thread and, beside it, in a task of the program's own runtime; each with that
//! runtime idle, and with all its workers blocked for 20 of every 100 milliseconds. Prints a line
//! for each.
//!
//! The robot here sends a state per millisecond and takes a command for each. One that has not come
//! when the next state leaves is lost, as it is for a robot.

mod clients;
mod robot;
// The clock of the other bench over sockets.
#[path = "../live/stamp.rs"]
mod stamp;

use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Barrier};
use std::time::Duration;
use std::{env, thread};

use franka_rt::sched::{Realtime, Scheduling};
use tokio::runtime::{Builder, Runtime};

use clients::Client;
use robot::Outcome;

fn main() -> ExitCode {
    let seconds = env::args().nth(1).map_or(Ok(SECONDS), |text| text.parse());
    let Ok(seconds @ 1..) = seconds else {
        eprintln!("usage: starvation [SECONDS]");
        return ExitCode::from(2);
    };
    match preferred(None).probe() {
        Ok(granted) if granted.priority.is_some() => {
            println!("SCHED_FIFO is granted: to the control thread, and to the robot");
        }
        _ => println!("SCHED_FIFO is NOT GRANTED: the control thread is one among all others"),
    }
    println!("{seconds} s each; turnaround in microseconds, of what was answered at all");
    println!("client          workers    states   lost   p50     p90     p99     max");
    for client in [Client::Thread, Client::Task] {
        for blocked in [false, true] {
            let outcome = measure(client, blocked, Duration::from_secs(seconds));
            let workers = if blocked { "blocked" } else { "idle" };
            println!("{:<15} {workers:<8} {outcome}", client.name());
        }
    }
    ExitCode::SUCCESS
}

/// Asks for a priority, the highest if `None`, and goes on without.
fn preferred(priority: Option<i32>) -> Scheduling {
    Scheduling {
        realtime: Realtime::Ignore,
        priority,
        ..Scheduling::default()
    }
}

fn measure(client: Client, blocked: bool, time: Duration) -> Outcome {
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
        let outcome = client.run(&runtime, time);
        ended.store(true, Ordering::Relaxed);
        outcome
    })
}

/// Has every worker sleep at the same time.
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

/// As many as small computers have.
const WORKERS: usize = 2;

/// Time from one blocking to the next.
const PERIOD: Duration = Duration::from_millis(100);

/// What a query of a database, a page of JSON or a decoded image may take.
const BLOCKED: Duration = Duration::from_millis(20);

const SECONDS: u64 = 10;

//! Counts instructions: `instructions` prints the number of machine instructions of every call of
//! the model that the benchmarks time, of the guarded cycle, and of the whole cycle of each back
//! end. Time on a shared machine is noisy, but this count is not.
//!
//! Needs `valgrind`. Every call is made a few and many times under its callgrind tool. The
//! difference contains only the calls, without the start and the preparation of the inputs.

use std::env;
use std::process::{Command, ExitCode};

use franka_bench::{Subject, subjects};

fn main() -> ExitCode {
    let mut arguments = env::args().skip(1);
    match (arguments.next(), arguments.next()) {
        (None, _) => table(),
        (Some(key), Some(calls)) => repeat(&key, calls.parse().unwrap_or(0)),
        (Some(_), None) => {
            eprintln!("usage: instructions");
            ExitCode::from(2)
        }
    }
}

/// Makes `calls` calls of one subject, under valgrind.
fn repeat(key: &str, calls: u64) -> ExitCode {
    let Some(Subject { mut call, .. }) = subjects().into_iter().find(|s| s.key == key) else {
        eprintln!("nothing is called {key}");
        return ExitCode::FAILURE;
    };
    for _ in 0..calls {
        call();
    }
    ExitCode::SUCCESS
}

fn table() -> ExitCode {
    if Command::new("valgrind").arg("--version").output().is_err() {
        eprintln!("valgrind is not installed: instructions cannot be counted");
        return ExitCode::FAILURE;
    }
    println!("{:<28} {:>12}", "", "instructions");
    for Subject { key, within, .. } in subjects() {
        match (count(key, within, FEW), count(key, within, MANY)) {
            (Some(few), Some(many)) => {
                let name = key.trim_end_matches("_ns");
                println!("{name:<28} {:>12}", (many - few) / (MANY - FEW));
            }
            _ => {
                eprintln!("callgrind gave no count for {key}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}

/// Returns the instructions of a process that makes `calls` calls, or only those in the functions
/// `within`, if any. Callgrind accepts the pattern of one function: each has a separate run.
fn count(key: &str, within: &[&str], calls: u64) -> Option<u64> {
    if within.is_empty() {
        return collected(key, None, calls);
    }
    let counts = within.iter().map(|it| collected(key, Some(it), calls));
    counts.sum()
}

fn collected(key: &str, within: Option<&str>, calls: u64) -> Option<u64> {
    let within = within.map(|within| format!("--toggle-collect={within}"));
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .args(within)
        .arg(env::current_exe().ok()?)
        .args([key, &calls.to_string()])
        .output()
        .ok()?;
    let text = String::from_utf8_lossy(&output.stderr);
    let line = text.lines().find(|line| line.contains("Collected"))?;
    line.rsplit(':').next()?.trim().parse().ok()
}

/// The difference of the two counts is a multiple of the number of inputs, so that all inputs have
/// the same weight.
const FEW: u64 = 1_000;
const MANY: u64 = 9_000;

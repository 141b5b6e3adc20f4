//! Drives the trajectory generator through random closed loops for as long as it is told to:
//! `otg_soak [REPLANS] [SEED]`.
//!
//! ```text
//! seed -> Problem: axes, limits, start -> Episode: targets, gaps, new limits, cycles -> Watch: checks -> Tally
//! ```
//!
//! Each episode has a seed of its own. A failure names it, and `otg_soak replay SEED` runs that one
//! alone.

mod episode;
mod oracle;
mod problem;
mod tally;
mod watch;

use std::env;
use std::process::ExitCode;
use std::time::Instant;

use tally::Tally;

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let number = |i: usize, default: u64| {
        arguments
            .get(i)
            .map_or(Some(default), |text| text.parse().ok())
    };
    if arguments.first().is_some_and(|word| word == "replay") {
        let Some(seed) = arguments.get(1).and_then(|text| text.parse().ok()) else {
            return usage();
        };
        let mut tally = Tally::default();
        episode::run(seed, &mut tally);
        println!("{tally}");
        return tally.outcome();
    }
    let (Some(replans), Some(seed)) = (number(0, REPLANS), number(1, SEED)) else {
        return usage();
    };
    let (mut tally, start) = (Tally::default(), Instant::now());
    let mut next = seed;
    let mut shown = 0;
    while tally.replans < replans && tally.failures.len() < FAILURES_MAX {
        episode::run(next, &mut tally);
        next += 1;
        if tally.replans / SHOW_EVERY > shown {
            shown = tally.replans / SHOW_EVERY;
            println!(
                "{} plans, {} failures, {:.0} s",
                tally.replans,
                tally.failures.len(),
                start.elapsed().as_secs_f64()
            );
        }
    }
    println!(
        "seeds {seed} to {}, {:.0} s",
        next - 1,
        start.elapsed().as_secs_f64()
    );
    println!("{tally}");
    tally.outcome()
}

fn usage() -> ExitCode {
    eprintln!("usage: otg_soak [REPLANS] [SEED] | otg_soak replay SEED");
    ExitCode::from(2)
}

const REPLANS: u64 = 10_000_000;
const SEED: u64 = 1;
const SHOW_EVERY: u64 = 1_000_000;
/// More of the same say nothing new.
const FAILURES_MAX: usize = 20;

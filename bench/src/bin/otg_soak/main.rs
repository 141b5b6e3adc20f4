//! Tests the trajectory generator with random closed loops, for a given number of plans: `otg_soak
//! [PLANS] [SEED]`. `otg_soak moving [PLANS] [SEED]` creates single plans instead, to targets in
//! motion with limits of all kinds, each from a random state.
//!
//! ```text
//! seed -> Problem: axes, limits, start -> Episode: targets, gaps, new limits, cycles -> Watch: checks -> SoakReport
//! ```
//!
//! Each episode and each single plan has its own seed. A failure names it, and `otg_soak replay
//! SEED` or `otg_soak moving 1 SEED` runs this seed alone.

mod episode;
mod oracle;
mod problem;
mod report;
mod watch;

use std::env;
use std::process::ExitCode;
use std::time::Instant;

use report::SoakReport;

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (run, numbers): (Run, &[&str]) = match words.split_first() {
        Some((&"moving", numbers)) => (episode::plan, numbers),
        Some((&"replay", [seed])) => {
            return seed
                .parse()
                .map_or_else(|_| usage(), |seed| soak(episode::run, 1, seed));
        }
        _ => (episode::run, &words),
    };
    let number = |i: usize, default: u64| {
        numbers
            .get(i)
            .map_or(Ok(default), |text| text.parse::<u64>())
    };
    match (number(0, PLANS), number(1, SEED)) {
        (Ok(plans), Ok(seed)) if numbers.len() <= 2 => soak(run, plans, seed),
        _ => usage(),
    }
}

type Run = fn(u64, &mut SoakReport);

/// Runs one seed after the other until the number of plans is reached.
fn soak(run: Run, plans: u64, seed: u64) -> ExitCode {
    let (mut report, start) = (SoakReport::default(), Instant::now());
    let mut next = seed;
    let mut shown = 0;
    while report.replans < plans && report.failures.len() < FAILURES_MAX {
        run(next, &mut report);
        next += 1;
        if report.replans / SHOW_EVERY > shown {
            shown = report.replans / SHOW_EVERY;
            println!(
                "{} plans, {} failures, {:.0} s",
                report.replans,
                report.failures.len(),
                start.elapsed().as_secs_f64()
            );
        }
    }
    println!(
        "seeds {seed} to {}, {:.0} s",
        next - 1,
        start.elapsed().as_secs_f64()
    );
    println!("{report}");
    report.outcome()
}

fn usage() -> ExitCode {
    eprintln!("usage: otg_soak [moving] [PLANS] [SEED] | otg_soak replay SEED");
    ExitCode::from(2)
}

const PLANS: u64 = 10_000_000;
const SEED: u64 = 1;
const SHOW_EVERY: u64 = 1_000_000;
/// Number of failures after which more are not reported.
const FAILURES_MAX: usize = 20;

//! Our target control beside that of franka-rs, each with its defaults, on the same simulated
//! robots: `beside_franka_rs PROGRAM`, where `PROGRAM` is that of `tests/peers/franka_rs`. A step
//! of 5 cm, and a hand that pushes an arm that holds its pose. Prints the result of each in one
//! line.

mod hand;
mod ours;
mod theirs;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::ensure;
use clap::Parser;
use franka_rt::session::ForceCap;
use franka_sim::{Sim, Tool};
use franka_tests::push::PACE;
use nalgebra::Vector3;

use hand::Hand;
use ours::Ours;
use theirs::Theirs;

/// Compares two clients on simulated robots.
#[derive(Debug, Parser)]
struct Arguments {
    /// The program of `tests/peers/franka_rs`.
    program: PathBuf,
}

/// Makes a simulated robot of a kind.
type Kind = fn() -> Sim;

/// The result of a step.
#[derive(Clone, Copy, Debug)]
struct Stepped {
    /// The time from which the arm stayed within 1 mm of the target, `[s]` from the first cycle
    /// with that target.
    within: f64,
    /// The distance from the target in the end, `[m]`.
    off: f64,
    /// The greatest distance from the commanded position, `[m]`.
    lag: f64,
}

/// How long a step is watched, `[s]`.
const WATCHED: f64 = 2.5;

/// The step, `[m]`, base frame.
const STEP: [f64; 3] = [0.0, 0.0, 0.05];

/// The longest time that a client may take for any operation.
const PATIENCE: Duration = Duration::from_secs(30);

#[tokio::main]
async fn main() -> ExitCode {
    match run(Arguments::parse()).await {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

async fn run(arguments: Arguments) -> anyhow::Result<()> {
    let mut failed = 0;
    let ideal: [(&str, Kind); 2] = [
        ("FR3", || Sim::fr3().ideal()),
        ("FER", || Sim::fer().ideal()),
    ];
    let [fr3, fer] = ideal;
    for ((robot, kind), wanted) in [
        (fr3, Wanted::IDEAL),
        (fer, Wanted::IDEAL),
        (("realistic FR3", Sim::fr3), Wanted::REALISTIC),
        (("realistic FER", Sim::fer), Wanted::REALISTIC),
    ] {
        let start = Instant::now();
        let stepped = step(kind, wanted, &arguments).await;
        failed += u32::from(!told(&format!("{robot}: a step of 5 cm"), start, stepped));
    }
    for (robot, kind) in ideal {
        for way in [Vector3::x(), Vector3::y(), -Vector3::z()] {
            let start = Instant::now();
            let pushed = push(kind, way, &arguments).await;
            let name = format!("{robot}: a push along {:?}", way.as_slice());
            failed += u32::from(!told(&name, start, pushed));
        }
    }
    ensure!(failed == 0, "{failed} steps failed");
    Ok(())
}

/// Prints the result of a step, and returns whether it passed.
fn told(name: &str, start: Instant, outcome: anyhow::Result<String>) -> bool {
    match outcome {
        Ok(summary) => {
            let seconds = start.elapsed().as_secs_f64();
            println!("ok    {name} ({seconds:.1} s): {summary}");
            true
        }
        Err(error) => {
            println!("FAIL  {name}: {error:#}");
            false
        }
    }
}

/// A robot in virtual time, which advances as its client answers: no command is late on a busy
/// machine.
fn simulated(kind: Kind) -> Sim {
    kind().tool(Tool::hand()).virtual_time(PATIENCE)
}

/// The most that a step of ours may show.
#[derive(Clone, Copy)]
struct Wanted {
    /// `[m]`.
    off: f64,
    /// `[s]`.
    within: f64,
    /// `[m]`.
    lag: f64,
}

impl Wanted {
    const IDEAL: Self = Self {
        off: 0.3e-3,
        within: 0.90,
        lag: 2.5e-3,
    };

    /// Of an arm of which nothing is known yet.
    const REALISTIC: Self = Self {
        off: 1e-3,
        within: 2.0,
        lag: 8e-3,
    };
}

async fn step(kind: Kind, wanted: Wanted, arguments: &Arguments) -> anyhow::Result<String> {
    let sim = simulated(kind).start().await?;
    let mut theirs = Theirs::hold(&arguments.program, sim.addr())?;
    let peer = theirs.step(STEP, WATCHED)?;
    theirs.end()?;
    sim.stop().await;

    let sim = simulated(kind).start().await?;
    let ours = Ours::hold(sim.addr()).await?;
    let own = ours.step(STEP, WATCHED).await?;
    ours.end().await?;
    sim.stop().await;

    let summary = |name, stepped: Stepped| {
        let (off, lag) = (stepped.off * 1e3, stepped.lag * 1e3);
        format!(
            "{name} within 1 mm after {:.3} s, {off:.3} mm off, lag {lag:.2} mm",
            stepped.within
        )
    };
    let summary = format!("{}; {}", summary("own", own), summary("franka-rs", peer));
    let good = own.off <= wanted.off && own.within <= wanted.within && own.lag <= wanted.lag;
    let better = own.off < peer.off && own.within < peer.within && own.lag < peer.lag;
    ensure!(good && better, "{summary}");
    Ok(summary)
}

async fn push(kind: Kind, way: Vector3<f64>, arguments: &Arguments) -> anyhow::Result<String> {
    let (hand, sim) = Hand::beside(simulated(kind));
    let sim = sim.start().await?;
    let theirs = Theirs::hold(&arguments.program, sim.addr())?;
    let peer = hand.push(way).await?;
    theirs.end()?;
    sim.stop().await;

    let (hand, sim) = Hand::beside(simulated(kind));
    let sim = sim.start().await?;
    let ours = Ours::hold(sim.addr()).await?;
    let own = hand.push(way).await?;
    ours.end().await?;
    sim.stop().await;

    const CAP: f64 = ForceCap::DEFAULT_NEWTONS;
    let most = 1.1 * CAP;
    let summary = format!("own {own:.1} N, franka-rs {peer:.1} N, cap {CAP} N, at {PACE} m/s");
    ensure!(own <= most && peer > most, "{summary}");
    Ok(summary)
}

//! Compares our target control with other clients, each with its defaults, on the same simulated
//! robots: `beside_franka_rs FRANKA_RS [--pylibfranka PYTHON SCRIPT ADDRESS]`, programs of
//! `tests/peers`. The tests are a step of 5 cm, and a hand that pushes an arm at rest; the output
//! has a line for each robot and client. It also compares franka-rs on sampled arms with its
//! results on real ones.
//!
//! ```text
//!                      ┌─ Witness, Hand: what any client makes of the robot
//! Robot (simulated) ───┤
//!                      └─ socket ── Ours (this process), or Peer (a program that reads orders)
//! ```

mod calibration;
mod hand;
mod ours;
mod peer;
mod witness;

use std::fmt;
use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;
use std::process::{Command, ExitCode};
use std::time::{Duration, Instant};

use anyhow::ensure;
use clap::Parser;
use franka_proto::Version;
use franka_rt::session::ForceCap;
use franka_sim::{Sim, Tool};
use nalgebra::Vector3;

use hand::{Felt, Hand};
use ours::Ours;
use peer::Peer;
use witness::Followed;

/// Compares clients on simulated robots.
#[derive(Debug, Parser)]
struct Arguments {
    /// The program of `tests/peers/franka_rs`.
    franka_rs: PathBuf,
    /// Also compares joint positions with the vendor's client, whose robot has this address.
    #[arg(long, num_args = 3, value_names = ["PYTHON", "SCRIPT", "ADDRESS"])]
    pylibfranka: Option<Vec<String>>,
}

/// Creates a simulated robot of a kind.
type Kind = fn() -> Sim;

/// The vendor's client: its interpreter, our script for it, and the address of the robot, because
/// it uses one fixed port.
struct Pylibfranka<'a> {
    python: &'a str,
    script: &'a str,
    robot: IpAddr,
}

impl Pylibfranka<'_> {
    fn command(&self) -> Command {
        let mut command = Command::new(self.python);
        command.arg(self.script).arg(self.robot.to_string());
        command
    }
}

impl Arguments {
    fn pylibfranka(&self) -> anyhow::Result<Option<Pylibfranka<'_>>> {
        let Some([python, script, robot]) = self.pylibfranka.as_deref() else {
            return Ok(None);
        };
        Ok(Some(Pylibfranka {
            python,
            script,
            robot: robot.parse()?,
        }))
    }

    fn franka_rs(&self, robot: SocketAddr) -> Command {
        let mut command = Command::new(&self.franka_rs);
        command.arg(robot.to_string());
        command
    }
}

/// Duration of the observation after a step, `[ms]`.
const WATCHED: u64 = 2500;

/// The end of that time, in which the arm is at rest and its torques are noise, `[ms]`.
const RESTING: u64 = 1000;

/// Time for which an arm is left alone before a push, `[ms]`.
const BEFORE_PUSH: u64 = 1500;

/// The step, `[m]`, base frame.
const STEP: [f64; 3] = [0.0, 0.0, 0.05];

/// Time limit for any operation of a client.
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
    // The vendor's client only supports the protocol of the FR3.
    let vendor = arguments.pylibfranka()?;
    let vendor = vendor.as_ref();
    let robots: [(&str, Kind, Wanted, _); 4] = [
        ("ideal FR3", || Sim::fr3().ideal(), Wanted::IDEAL, None),
        ("ideal FER", || Sim::fer().ideal(), Wanted::IDEAL, None),
        ("realistic FR3", Sim::fr3, Wanted::REALISTIC, vendor),
        ("realistic FER", Sim::fer, Wanted::REALISTIC, None),
    ];
    for (robot, kind, wanted, vendor) in robots {
        failed += compare(robot, kind, &wanted, &arguments, vendor).await;
    }
    failed += calibration::run(&arguments).await;
    ensure!(failed == 0, "{failed} steps failed");
    Ok(())
}

/// Prints the result of a step; returns 1 if it failed.
fn told(name: &str, start: Instant, outcome: anyhow::Result<impl fmt::Display>) -> u32 {
    match outcome {
        Ok(summary) => {
            let seconds = start.elapsed().as_secs_f64();
            println!("ok    {name} ({seconds:.1} s): {summary}");
            0
        }
        Err(error) => {
            println!("FAIL  {name}: {error:#}");
            1
        }
    }
}

/// Returns a robot in virtual time, which advances with its client's answers: no command is late on
/// a busy machine.
fn simulated(sim: Sim) -> Sim {
    sim.tool(Tool::hand()).virtual_time(PATIENCE)
}

/// The largest values allowed for this driver.
struct Wanted {
    /// Distance, `[m]`.
    off: f64,
    /// Time, `[s]`.
    within: f64,
    /// Distance, `[m]`.
    lag: f64,
    /// Force, `[N]`.
    push: f64,
    /// Torque, `[N·m]`.
    noise: f64,
}

impl Wanted {
    const IDEAL: Self = Self {
        off: 0.3e-3,
        within: 0.90,
        lag: 2.5e-3,
        push: 1.1 * ForceCap::DEFAULT_NEWTONS,
        noise: 0.01,
    };

    /// Values for an unknown arm. Its friction adds to the force cap.
    const REALISTIC: Self = Self {
        off: 1e-3,
        within: 2.0,
        lag: 8e-3,
        push: ForceCap::DEFAULT_NEWTONS + 10.0,
        noise: 0.1,
    };
}

/// The measured values of a client.
#[derive(Clone, Copy)]
struct Measured {
    /// Time after which the arm stayed within 1 mm of the target, `[s]` from the first cycle with
    /// that target.
    within: Option<f64>,
    /// Final distance from the target, `[m]`.
    off: f64,
    /// Largest distance from the commanded position, `[m]`.
    lag: f64,
    /// Result of the pushing hand, in the direction with the largest force.
    push: Felt,
    /// Commanded torque above 30 Hz at rest, rms of the worst joint, `[N·m]`.
    noise: f64,
}

impl Wanted {
    fn allow(&self, own: &Measured) -> bool {
        own.off <= self.off
            && own.within.is_some_and(|within| within <= self.within)
            && own.lag <= self.lag
            && matches!(own.push, Felt::Mean(newtons) if newtons <= self.push)
            && own.noise <= self.noise
    }
}

impl Measured {
    /// True if it is more accurate, faster at its target and softer.
    fn is_better_than(&self, peer: &Self) -> bool {
        let sooner = match (self.within, peer.within) {
            (Some(own), Some(peer)) => own < peer,
            (own, _) => own.is_some(),
        };
        sooner && self.off < peer.off && self.lag < peer.lag && self.is_softer_than(peer)
    }

    fn is_softer_than(&self, peer: &Self) -> bool {
        self.push.newtons() < peer.push.newtons()
    }

    fn checked(self, good: bool) -> anyhow::Result<Self> {
        ensure!(good, "{self}");
        Ok(self)
    }
}

impl fmt::Display for Measured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.within {
            Some(seconds) => write!(f, "within 1 mm after {seconds:.3} s")?,
            None => write!(f, "never within 1 mm")?,
        }
        let (off, lag) = (self.off * 1e3, self.lag * 1e3);
        write!(f, ", {off:.3} mm off, lag {lag:.2} mm, ")?;
        match self.push {
            Felt::Mean(newtons) => write!(f, "push {newtons:.1} N")?,
            Felt::Reflex(newtons) => write!(f, "stopped itself at a push of {newtons:.0} N")?,
        }
        write!(f, ", torque above 30 Hz {:.4} N m", self.noise)
    }
}

/// The client that controls the arm.
enum Client<'a> {
    Own,
    FrankaRs,
    /// Joint positions along this path, by the vendor's client.
    Pylibfranka(&'a Pylibfranka<'a>, &'a [[f64; 7]]),
}

/// Prints a line for each client of this robot, and returns the number of failures.
async fn compare(
    robot: &str,
    kind: Kind,
    wanted: &Wanted,
    arguments: &Arguments,
    vendor: Option<&Pylibfranka<'_>>,
) -> u32 {
    let start = Instant::now();
    let name = format!("{robot}, own");
    let (own, path) = match measure(kind(), Client::Own, arguments).await {
        Ok(measured) => measured,
        Err(error) => return told(&name, start, Err::<Measured, _>(error)),
    };
    let mut failed = told(&name, start, own.checked(wanted.allow(&own)));

    let start = Instant::now();
    let peer = measure(kind(), Client::FrankaRs, arguments).await;
    let peer = peer.and_then(|(peer, _)| peer.checked(own.is_better_than(&peer)));
    failed += told(&format!("{robot}, franka-rs"), start, peer);

    if let Some(vendor) = vendor {
        let start = Instant::now();
        let peer = measure(kind(), Client::Pylibfranka(vendor, &path), arguments).await;
        let peer = peer.and_then(|(peer, _)| peer.checked(own.is_softer_than(&peer)));
        failed += told(
            &format!("{robot}, pylibfranka's joint positions"),
            start,
            peer,
        );
    }
    failed
}

/// Runs the whole test with a client. Also returns the joint positions of its reference, if the
/// client is ours.
async fn measure(
    sim: Sim,
    client: Client<'_>,
    arguments: &Arguments,
) -> anyhow::Result<(Measured, Vec<[f64; 7]>)> {
    let sim = match &client {
        Client::Pylibfranka(vendor, _) => sim.bind((vendor.robot, Version::TCP_PORT).into()),
        _ => sim,
    };
    let (hand, sim) = Hand::beside(simulated(sim));
    let sim = sim.start().await?;
    let seconds = (WATCHED + 100) as f64 * 1e-3;
    let measured = match client {
        Client::Own => {
            let ours = Ours::hold(sim.addr()).await?;
            let (followed, path) = ours.step(STEP, seconds).await?;
            let measured = look(&hand, &followed).await?;
            ours.end().await?;
            (measured, path)
        }
        Client::FrankaRs => {
            let mut peer = Peer::hold(&mut arguments.franka_rs(sim.addr()))?;
            let followed = peer.step(STEP, seconds)?;
            let measured = look(&hand, &followed).await?;
            peer.end()?;
            (measured, Vec::new())
        }
        Client::Pylibfranka(vendor, path) => {
            let mut peer = Peer::hold(&mut vendor.command())?;
            let followed = peer.follow(path, seconds)?;
            let measured = look(&hand, &followed).await?;
            peer.end()?;
            (measured, Vec::new())
        }
    };
    sim.stop().await;
    Ok(measured)
}

/// Measures the completed step, and pushes the arm.
async fn look(hand: &Hand, followed: &Followed) -> anyhow::Result<Measured> {
    let witness = hand.witness();
    let end = followed.begin()? + WATCHED;
    let lags = witness.lags(followed)?;
    let mut push = Felt::Mean(0.0);
    for way in [Vector3::x(), Vector3::y(), -Vector3::z()] {
        witness.wait(witness.now() + BEFORE_PUSH).await?;
        push = push.max(hand.push(way).await?);
        if let Felt::Reflex(_) = push {
            break;
        }
    }
    Ok(Measured {
        within: witness.within(followed, 1e-3, WATCHED)?,
        off: witness.distance(end, &followed.target)?,
        lag: lags.into_iter().fold(0.0, |most, (lag, _)| most.max(lag)),
        push,
        noise: witness.torque_noise(end - RESTING, end)?,
    })
}

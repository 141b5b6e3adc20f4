//! A client that controls a robot for a given time: `live_client CLIENT ADDRESS SECONDS [--fifo]`.
//! It runs as a separate process, so that its processor time can be measured from outside.

mod driver;
mod echo;

use std::process::ExitCode;
use std::time::Duration;

use clap::{Parser, ValueEnum};

/// Controls a simulated robot and then ends the motion.
#[derive(Debug, Parser)]
struct Arguments {
    /// The client to use.
    client: ClientKind,
    /// Address of the robot, `host:port`.
    address: String,
    /// Duration of the control.
    seconds: u32,
    /// Run the control thread under SCHED_FIFO; an error if that is refused.
    #[arg(long)]
    fifo: bool,
}

/// The clients.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ClientKind {
    /// Answers every datagram with one datagram, and does nothing else.
    Echo,
    /// A control function that returns zero torques.
    Torques,
    /// Targets for the end effector, ten per second.
    Targets,
}

fn main() -> ExitCode {
    match run(Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: Arguments) -> anyhow::Result<()> {
    let Arguments {
        client,
        address,
        seconds,
        fifo,
    } = arguments;
    let time = Duration::from_secs(seconds.into());
    match client {
        ClientKind::Echo => echo::run(&address, time, fifo),
        ClientKind::Torques => driver::torques(&address, time, fifo),
        ClientKind::Targets => driver::targets(&address, time, fifo),
    }
}

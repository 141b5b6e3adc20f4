//! A simulated Franka robot for any client that speaks its protocol.
//!
//! | module | content |
//! |---|---|
//! | [`arguments`] | the command line |
//! | [`values`] | checked values of arguments |
//! | [`setup`] | arguments to a robot, a plant, grippers and a network |

mod arguments;
mod setup;
mod values;

use std::io::IsTerminal;
use std::process::ExitCode;

use clap::Parser;
use tokio::signal::unix::{SignalKind, signal};

use arguments::Arguments;

#[tokio::main(flavor = "current_thread")]
async fn main() -> ExitCode {
    tracing_subscriber::fmt()
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .with_target(false)
        .init();
    let arguments = Arguments::parse();
    match run(&arguments).await {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("franka-sim: {error}");
            ExitCode::FAILURE
        }
    }
}

async fn run(arguments: &Arguments) -> std::io::Result<()> {
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    let sim = arguments.sim().map_err(std::io::Error::other)?;
    let sim = sim.start().await.map_err(|error| {
        let kind = error.kind();
        std::io::Error::new(kind, format!("cannot listen on {error}"))
    })?;
    println!("listening on {}", sim.addr());
    if let Some(hand) = sim.hand() {
        println!("Franka Hand on {}", hand.addr());
    }
    if let Some(gripper) = sim.vacuum_gripper() {
        println!("vacuum gripper on {}", gripper.addr());
    }
    tokio::select! {
        _ = interrupt.recv() => {}
        _ = terminate.recv() => {}
        () = sim.ended() => return Err(std::io::Error::other("the simulation has ended")),
    }
    sim.stop().await;
    Ok(())
}

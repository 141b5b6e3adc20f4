//! The vendor's client records a cassette of itself, and completes its motion against it:
//! `cassette_peer INTERPRETER SCRIPT SIMULATOR TAP PLAYER`, where the last three are addresses of
//! this machine.
//!
//! Prints a line per step, like the scripts of `tests/peers`.

use std::net::{IpAddr, SocketAddr};
use std::process::Command;
use std::time::Duration;

use anyhow::{Context as _, bail, ensure};
use franka_record::cassette::{
    Cassette, CassetteServer, Device, Matching, PlayOptions, Route, Tap,
};
use franka_sim::Sim;

/// Time limit; a longer operation hangs.
const PATIENCE: Duration = Duration::from_secs(60);

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let [interpreter, script, simulator, tap, player] = &arguments[..] else {
        bail!("five arguments are needed: interpreter, script, and three addresses");
    };
    let client = |address: &str| {
        let mut command = Command::new(interpreter);
        command.arg(script).arg(address);
        command
    };
    let cassette = record(client(tap), simulator.parse()?, tap.parse()?).await;
    let (cassette, recorded) = step("pylibfranka is recorded", cassette)?;
    let played = play(cassette, client(player), player.parse()?, &recorded).await;
    step(
        "pylibfranka completes its motion against its cassette",
        played,
    )?;
    Ok(())
}

/// Prints the line of a step.
fn step<T>(name: &str, outcome: anyhow::Result<T>) -> anyhow::Result<T> {
    match &outcome {
        Ok(_) => println!("ok    {name}"),
        Err(error) => println!("FAIL  {name}: {error:#}"),
    }
    outcome
}

/// Runs the client against a tap in front of a simulator; returns the cassette and its output.
async fn record(
    client: Command,
    simulator: IpAddr,
    tap: IpAddr,
) -> anyhow::Result<(Cassette, String)> {
    let port = Device::Robot.port();
    let sim = Sim::fr3().ideal().bind((simulator, port).into());
    let sim = sim.wait_for_commands(PATIENCE).start().await?;
    let file = std::env::temp_dir().join(format!("franka-peer-{}.mcap", std::process::id()));
    let route = Route {
        device: Device::Robot,
        listen: SocketAddr::new(tap, port),
        robot: sim.addr(),
    };
    let tap = Tap::start(&[route], &file)?;
    let output = output(client).await;
    let report = tap.finish()?;
    let cassette = Cassette::open(&file)?;
    std::fs::remove_file(&file)?;
    println!("{report:?}");
    Ok((cassette, output?))
}

/// Runs the client against the cassette.
async fn play(
    cassette: Cassette,
    client: Command,
    address: IpAddr,
    recorded: &str,
) -> anyhow::Result<()> {
    let mut options = PlayOptions::default();
    options.matching = Matching::Lenient;
    options.patience = PATIENCE;
    let server = CassetteServer::start(cassette, address, options)?;
    let again = output(client).await;
    let report = tokio::task::spawn_blocking(|| server.finish(PATIENCE)).await?;
    let again = again?;
    for (device, tally) in report?.played {
        println!("{device}: {tally}");
    }
    ensure!(again == recorded, "{again:?} instead of {recorded:?}");
    Ok(())
}

/// Returns the output of a client, if it succeeds.
async fn output(mut client: Command) -> anyhow::Result<String> {
    let output = tokio::task::spawn_blocking(move || client.output()).await?;
    let output = output.context("cannot start the client")?;
    let complaints = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "the client failed: {complaints}");
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

//! Records a session with a robot byte for byte, and plays it back as the robot.
//!
//! ```text
//! cargo run --release --features pcap --example cassette -- tap session.mcap 172.16.0.2
//! cargo run --release --features pcap --example cassette -- play session.mcap
//! cargo run --release --features pcap --example cassette -- convert session.mcap session.pcap
//! cargo run --release --features pcap --example cassette -- demo
//! ```
//!
//! `tap` runs between clients and the robot until Enter is pressed: connect the clients, in any
//! language, to 127.0.0.1 instead of the robot. `play` then serves as the robot at 127.0.0.1, and
//! ends with the session. `demo` does both with a simulator and this driver.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::ensure;
use clap::{Parser, Subcommand};
use franka_async::cassette::{
    Cassette, CassetteServer, Device, Matching, PlayOptions, Route, Tap, pcap,
};
use franka_async::{Realtime, Robot};
use franka_sim::Sim;

#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Record the traffic between clients and a robot
    Tap {
        /// The new file
        file: PathBuf,
        /// The robot
        robot: IpAddr,
        /// Address for clients
        #[arg(long, default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
        listen: IpAddr,
    },
    /// Serve as the recorded robot
    Play {
        /// The file
        file: PathBuf,
        /// Address for clients
        #[arg(long, default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
        listen: IpAddr,
        /// Accept only the recorded bytes
        #[arg(long)]
        strict: bool,
        /// Time limit for the whole session, in seconds
        #[arg(long, default_value_t = 600)]
        patience: u64,
    },
    /// Convert a cassette to a capture for Wireshark, or a capture (pcap, pcapng) to a cassette
    Convert {
        /// The file; a cassette ends in .mcap
        from: PathBuf,
        /// The new file
        to: PathBuf,
    },
    /// Record a motion of a simulated robot, and play it to the same program
    Demo,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    match Arguments::parse().task {
        Task::Tap {
            file,
            robot,
            listen,
        } => record(&file, robot, listen),
        Task::Play {
            file,
            listen,
            strict,
            patience,
        } => play(&file, listen, strict, Duration::from_secs(patience)),
        Task::Convert { from, to } => convert(&from, &to),
        Task::Demo => demo().await,
    }
}

fn record(file: &Path, robot: IpAddr, listen: IpAddr) -> anyhow::Result<()> {
    let tap = Tap::start(&Route::all(robot, listen), file)?;
    println!("clients of {robot} can connect to {listen}; Enter ends the recording");
    std::io::stdin().read_line(&mut String::new())?;
    println!("{:?} in {}", tap.finish()?, file.display());
    Ok(())
}

fn play(file: &Path, listen: IpAddr, strict: bool, patience: Duration) -> anyhow::Result<()> {
    let mut options = PlayOptions::default();
    if !strict {
        options.matching = Matching::Lenient;
    }
    let server = CassetteServer::start(Cassette::open(file)?, listen, options)?;
    println!("playing at {listen}");
    for (device, tally) in server.finish(patience)?.played {
        println!("{device}: {tally}");
    }
    Ok(())
}

fn convert(from: &Path, to: &Path) -> anyhow::Result<()> {
    let file = if from
        .extension()
        .is_some_and(|extension| extension == "mcap")
    {
        pcap::to_capture(&Cassette::open(from)?)
    } else {
        pcap::from_capture(&std::fs::read(from)?)?.to_bytes()?
    };
    std::fs::write(to, file)?;
    Ok(())
}

async fn demo() -> anyhow::Result<()> {
    let sim = Sim::fr3()
        .ideal()
        .wait_for_commands(PATIENCE)
        .start()
        .await?;
    let file = std::env::temp_dir().join(format!("demo-{}.mcap", std::process::id()));
    let anywhere = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
    let route = Route {
        device: Device::Robot,
        listen: anywhere,
        robot: sim.addr(),
    };
    let tap = Tap::start(&[route], &file)?;
    let first = turn(tap.address(Device::Robot).expect("its route")).await?;
    let report = tap.finish()?;
    drop(sim);
    println!(
        "recorded {} events, joint 7 at {first:.6} rad",
        report.events
    );

    let cassette = Cassette::open(&file)?;
    std::fs::remove_file(&file)?;
    let mut options = PlayOptions::default();
    options.matching = Matching::Lenient;
    let server = CassetteServer::start_at(cassette, |_| anywhere, options)?;
    let again = turn(server.address(Device::Robot).expect("recorded")).await?;
    let report = tokio::task::spawn_blocking(|| server.finish(PATIENCE)).await??;
    for (device, tally) in report.played {
        println!("played {device}: {tally}");
    }
    ensure!(
        (again - first).abs() < 1e-3,
        "{again} rad instead of {first}"
    );
    println!("arrived at the same place, with no robot there");
    Ok(())
}

/// Turns the last joint by 0.1 rad, and returns its final position.
async fn turn(robot: SocketAddr) -> anyhow::Result<f64> {
    let robot = Robot::builder(robot).realtime(Realtime::Ignore);
    let robot = robot.connect().await?;
    let mut q = robot.state().q;
    q[6] += 0.1;
    robot.move_joints(q).await?;
    let reached = robot.state().q[6];
    robot.shutdown().await;
    Ok(reached)
}

const PATIENCE: Duration = Duration::from_secs(5);

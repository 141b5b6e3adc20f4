//! A simulated Franka robot for any client that speaks its protocol.

use std::io::IsTerminal;
use std::net::{IpAddr, SocketAddr};
use std::process::ExitCode;

use clap::Parser;
use franka_model::{JointVector, Load};
use franka_sim::{Config, Noise, Sim, Tool};
use nalgebra::{Matrix3, Vector3};
use tokio::signal::unix::{SignalKind, signal};

/// Simulates a Franka Research 3 (protocol 10) until it is interrupted.
///
/// Point a client at the address that is printed once the robot is ready, for example
/// libfranka's `franka::Robot robot("127.0.0.1")` or pylibfranka's
/// `Robot("127.0.0.1", RealtimeConfig.kIgnore)`. There is one client at a time; the robot stays as
/// it is between clients.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// Address to listen on; 0.0.0.0 for all interfaces.
    #[arg(long, default_value = "127.0.0.1")]
    bind: IpAddr,

    /// TCP port to listen on; 0 takes a free one. Other clients than ours only know 1337.
    #[arg(long, default_value_t = 1337)]
    port: u16,

    /// Joint positions at the start, in radians, separated by commas; the ready pose if absent.
    #[arg(
        long,
        value_name = "Q1,...,Q7",
        value_delimiter = ',',
        num_args = 7,
        allow_hyphen_values = true
    )]
    q: Option<Vec<f64>>,

    /// Mounts the Franka Hand's mass and frame on the flange (its fingers are not simulated).
    #[arg(long)]
    hand: bool,

    /// A load on the flange that the robot does not know of until a client declares it, in
    /// kilograms.
    #[arg(long, value_name = "KG", default_value_t = 0.0)]
    payload: f64,

    /// Centre of mass of the load in the flange frame, in metres.
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', num_args = 3, default_values_t = [0.0, 0.0, 0.05], allow_hyphen_values = true)]
    payload_com: Vec<f64>,

    /// Adds noise to the sensors.
    #[arg(long)]
    noise: bool,

    /// Seed of all randomness.
    #[arg(long, default_value_t = 1)]
    seed: u64,

    /// Accepts commands and motions beyond the limits, which a robot answers with a reflex.
    #[arg(long)]
    no_enforce_limits: bool,

    /// Waits for commands that are missing, where a robot stops after 20 in a row: for slow or
    /// debugged clients.
    #[arg(long)]
    no_enforce_communication: bool,
}

impl Arguments {
    fn config(&self) -> Config {
        let mut config = Config {
            seed: self.seed,
            enforce_limits: !self.no_enforce_limits,
            enforce_communication: !self.no_enforce_communication,
            ..Config::default()
        };
        if let Some(q) = &self.q {
            config.q = JointVector::from_column_slice(q);
        }
        if self.hand {
            config.tool = Tool::hand();
        }
        if self.noise {
            config.noise = Noise::MODERATE;
        }
        if self.payload > 0.0 {
            config.payload = Load {
                mass: self.payload,
                com: Vector3::from_column_slice(&self.payload_com),
                inertia: Matrix3::zeros(),
            };
        }
        config
    }
}

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
            let address = SocketAddr::new(arguments.bind, arguments.port);
            eprintln!("franka-sim: cannot listen on {address}: {error}");
            ExitCode::FAILURE
        }
    }
}

async fn run(arguments: &Arguments) -> std::io::Result<()> {
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    let sim = Sim::new(arguments.config())
        .bind(SocketAddr::new(arguments.bind, arguments.port))
        .start()
        .await?;
    println!("listening on {}", sim.addr());
    tokio::select! {
        _ = interrupt.recv() => {}
        _ = terminate.recv() => {}
    }
    sim.stop().await;
    Ok(())
}

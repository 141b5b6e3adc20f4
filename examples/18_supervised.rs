//! Moves the hand up and down under supervision. A lost connection is restored, the robot is
//! recovered from reflexes (at most three times per minute), and the next motion waits for it.
//! Prints the events. Its own simulator stops itself twice during the motions.
//!
//! `cargo run --release --example supervised -- [ADDRESS] [--rounds 5] [--seconds 30]`

use std::time::Duration;

use anyhow::ensure;
use clap::Parser;
use franka_async::diagnosis::Diagnose;
use franka_async::state::RobotError;
use franka_async::supervision::{EventKind, Policy};
use franka_async::{Pose, Robot};
use franka_examples::Connection;
use tokio::task::JoinHandle;
use tokio::time::sleep;

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    /// Number of motions up and down.
    #[arg(long, default_value_t = 5)]
    rounds: u32,
    /// Time for which a motion waits for the robot.
    #[arg(long, default_value_t = 30)]
    seconds: u64,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    let (connection, rounds) = (arguments.connection, arguments.rounds);
    let policy = Policy::default()
        .recover(3, Duration::from_secs(60))
        .motions_wait(Duration::from_secs(arguments.seconds));
    let supervised = connection.open_with(|builder| builder.supervise(policy));
    let (robot, sim) = supervised.await?;
    connection.ask("moves its hand 3 cm up and down, again after reflexes and lost connections")?;
    let printing = print_events(&robot);
    let home = robot.pose();
    let up = Pose::translation(0.0, 0.0, 0.03) * home;

    let mut arrived = 0;
    for round in 1..=rounds {
        let collision = async {
            if let Some(sim) = sim.as_ref().filter(|_| round <= 2) {
                sleep(Duration::from_millis(250)).await;
                sim.with(|robot| robot.trip(RobotError::CartesianReflex))
                    .await?;
            }
            anyhow::Ok(())
        };
        let (first, tripped) = tokio::join!(robot.move_to(up).into_future(), collision);
        tripped?;
        // The next motion waits until the robot accepts motions, regardless of how the first one
        // ended.
        for outcome in [first, robot.move_to(home).await] {
            match outcome {
                Ok(_) => arrived += 1,
                Err(error) => println!("round {round}: {error}"),
            }
        }
    }

    let health = robot.health().newest();
    robot.shutdown().await;
    printing.await?;
    let (reconnects, recoveries) = (health.reconnects, health.recoveries);
    println!(
        "{arrived} of {} arrived; {reconnects} reconnects, {recoveries} recoveries",
        2 * rounds
    );
    ensure!(arrived > 0, "no motion arrived");
    Ok(())
}

/// Prints the events, until the connection has ended.
fn print_events(robot: &Robot) -> JoinHandle<()> {
    let mut events = robot.events();
    tokio::spawn(async move {
        while let Some(notification) = events.next().await {
            if notification.missed > 0 {
                println!("{} events were missed", notification.missed);
            }
            let at = notification.event.at.as_secs_f64();
            match &notification.event.kind {
                EventKind::MotionBegun { .. } | EventKind::MotionEnded { .. } => continue,
                kind => println!("{at:.3} s: {kind}"),
            }
            if let EventKind::Reflex(reflex) = notification.event.kind
                && let Some(diagnosis) = reflex.diagnose()
            {
                println!("{diagnosis}");
            }
        }
    })
}

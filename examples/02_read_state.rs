//! Reads states, ten per second, while the arm is at rest. The robot sends a thousand per second; a
//! `watch` always holds the newest.
//!
//! `cargo run --release --example read_state [ADDRESS]`

use std::time::Duration;

use clap::Parser;
use franka_examples::Arguments;

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let (robot, _sim) = Arguments::parse().connection.open().await?;
    let mut states = robot.states();
    let mut clock = tokio::time::interval(Duration::from_millis(100));
    for _ in 0..30 {
        clock.tick().await;
        // Waits for a state after the last one read, so a lost link is detected here.
        let state = tokio::time::timeout(Duration::from_secs(1), states.changed()).await??;
        println!(
            "{:>8} ms  {}  q {:.4?} rad  tau_ext {:.2?} N m  errors {}",
            state.message_id, state.robot_mode, state.q, state.tau_ext_hat_filtered, state.errors
        );
    }
    let stats = robot.stats();
    println!(
        "{} states received, {} lost, {} skipped; interval p50 {:?}, p99 {:?}",
        stats.states.get(),
        stats.lost.get(),
        stats.skipped.get(),
        stats.interval.quantile(0.5).unwrap_or_default(),
        stats.interval.quantile(0.99).unwrap_or_default(),
    );
    robot.shutdown().await;
    Ok(())
}

//! Clients of the services: programs that the tests kill and freeze in the middle. Each does one
//! thing without end, or until its motion ends, and prints a line when it has begun.
//!
//! `cargo run --features all --example client -- job | lead | move | follow ADDRESS`

use std::io::{BufRead, BufReader};
use std::time::Duration;

use anyhow::{Context, ensure};
use clap::{Parser, Subcommand};
use serde_json::{Value, json};
use tokio_stream::{Stream, StreamExt};

/// Made by `build.rs`.
mod proto {
    #![allow(missing_docs, unreachable_pub, dead_code, clippy::all)]
    tonic::include_proto!("franka.example");
}

use proto::arm_client::ArmClient;
use proto::{MoveRequest, Pose};

#[derive(Parser)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Begins a slow job at the web service, 10 cm upwards, and prints its events.
    Job { address: String },
    /// Takes the lease on the arm and leads it along a circle.
    Lead { address: String },
    /// Calls for a slow motion at the gRPC service, 10 cm upwards.
    Move { address: String },
    /// Leads the arm along a circle in one call of the gRPC service.
    Follow { address: String },
}

#[tokio::main(flavor = "current_thread")]
async fn main() -> anyhow::Result<()> {
    match Arguments::parse().task {
        Task::Job { address } => job(&address),
        Task::Lead { address } => lead(&address),
        Task::Move { address } => call(&address).await,
        Task::Follow { address } => follow(&address).await,
    }
}

fn job(address: &str) -> anyhow::Result<()> {
    let order = json!({ "by": [0.0, 0.0, 0.1], "speed": 0.2 });
    let begun = ureq::post(format!("http://{address}/jobs")).send_json(order)?;
    let location = begun.headers().get("location").context("a location")?;
    let url = format!("http://{address}{}/events", location.to_str()?);
    let events = ureq::get(url).call()?.into_body().into_reader();
    for line in BufReader::new(events).lines() {
        println!("{}", line?);
    }
    Ok(())
}

fn lead(address: &str) -> anyhow::Result<()> {
    let (mut socket, _) = tungstenite::connect(format!("ws://{address}/teleoperation"))?;
    let take = json!({ "type": "take", "name": "the client" });
    socket.send(take.to_string().into())?;
    let (mut start, mut targets) = (None, 0);
    // A target for each state.
    loop {
        let message: Value = serde_json::from_str(socket.read()?.to_text()?)?;
        match message["type"].as_str() {
            Some("state") => {}
            Some("taken") => {
                println!("leading");
                continue;
            }
            _ => anyhow::bail!("{message}"),
        }
        let start = start.get_or_insert_with(|| message.clone());
        let mut position: [f64; 3] = serde_json::from_value(start["position"].clone())?;
        position = circle(position, targets);
        let quaternion = &start["quaternion"];
        let target = json!({ "type": "target", "position": position, "quaternion": quaternion });
        socket.send(target.to_string().into())?;
        targets += 1;
    }
}

async fn call(address: &str) -> anyhow::Result<()> {
    let mut arm = ArmClient::connect(format!("http://{address}")).await?;
    let mut target = arm
        .get_state(())
        .await?
        .into_inner()
        .pose
        .context("a pose")?;
    target.position[2] += 0.1;
    println!("moving");
    let target = Some(target);
    arm.move_to(MoveRequest {
        target,
        speed: 0.05,
    })
    .await?;
    Ok(())
}

async fn follow(address: &str) -> anyhow::Result<()> {
    let mut arm = ArmClient::connect(format!("http://{address}")).await?;
    let start = arm
        .get_state(())
        .await?
        .into_inner()
        .pose
        .context("a pose")?;
    let mut states = arm.follow_targets(circling(start)?).await?.into_inner();
    println!("leading");
    while let Some(state) = states.next().await {
        state?;
    }
    Ok(())
}

fn circling(start: Pose) -> anyhow::Result<impl Stream<Item = Pose> + Send> {
    let [x, y, z] = start.position[..] else {
        anyhow::bail!("a position has three numbers")
    };
    ensure!(start.quaternion.len() == 4, "a quaternion has four numbers");
    let clock = tokio_stream::wrappers::IntervalStream::new(tokio::time::interval(PERIOD));
    let mut targets = 0;
    Ok(clock.map(move |_| {
        targets += 1;
        Pose {
            position: circle([x, y, z], targets).into(),
            quaternion: start.quaternion.clone(),
        }
    }))
}

/// A circle of 5 cm radius, upwards from the start.
fn circle([x, y, z]: [f64; 3], target: u32) -> [f64; 3] {
    let angle = 0.04 * f64::from(target);
    [x, y + 0.05 * angle.sin(), z + 0.05 - 0.05 * angle.cos()]
}

const PERIOD: Duration = Duration::from_millis(20);

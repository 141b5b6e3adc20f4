//! A web service that holds a robot: POST /move_to, POST /stop, GET /state, GET /events
//! (server-sent events).
//!
//! `cargo run --release --example axum_service -- [ADDRESS] [--listen 127.0.0.1:8080]`, then
//! `curl -X POST -H 'content-type: application/json' -d '[0, 0, 0.05]' localhost:8080/move_to`

use std::convert::Infallible;
use std::time::Duration;

use axum::extract::State;
use axum::http::StatusCode;
use axum::response::sse::{Event, Sse};
use axum::routing::{get, post};
use axum::{Json, Router};
use clap::Parser;
use franka_async::{MotionError, Pose, Robot, RobotState};
use franka_examples::Connection;
use serde_json::{Value, json};
use tokio_stream::{Stream, StreamExt};

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    connection: Connection,
    #[arg(long, default_value = "127.0.0.1:8080")]
    listen: String,
}

type Refused = (StatusCode, String);

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    let (robot, _sim) = arguments.connection.open().await?;
    let state = |robot: State<Robot>| async move { Json(view(robot.state())) };
    let stop = |robot: State<Robot>| async move { robot.stop().await.map_err(refuse) };
    let app = Router::new()
        .route("/move_to", post(move_to))
        .route("/stop", post(stop))
        .route("/state", get(state))
        .route("/events", get(events))
        .with_state(robot.clone());
    let listener = tokio::net::TcpListener::bind(&arguments.listen).await?;
    println!("listening on {}", listener.local_addr()?);
    let quit = async move {
        tokio::signal::ctrl_c().await.expect("Ctrl-C can be heard");
        robot.shutdown().await; // brakes whatever moves; requests and streams under way end with it
    };
    let serving = axum::serve(listener, app).with_graceful_shutdown(quit);
    Ok(serving.await?)
}

/// Moves the hand by this much along the axes of the base, `[m]`, and answers when the arm has
/// arrived. A client that disconnects drops the motion, which brakes the arm.
async fn move_to(robot: State<Robot>, Json([x, y, z]): Json<[f64; 3]>) -> Result<String, Refused> {
    let moving = robot.move_to(Pose::translation(x, y, z) * robot.pose());
    let report = moving.await.map_err(refuse)?;
    Ok(format!("arrived after {:.2?}\n", report.duration))
}

async fn events(robot: State<Robot>) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    let newest = robot.states().throttle(Duration::from_millis(50));
    Sse::new(newest.map(|state| Ok(Event::default().data(view(state).to_string()))))
}

fn view(state: RobotState) -> Value {
    json!({ "time": state.message_id, "mode": state.robot_mode.to_string(), "q": state.q })
}

fn refuse(error: MotionError) -> Refused {
    let status = match error {
        MotionError::Goal(_) => StatusCode::UNPROCESSABLE_ENTITY,
        MotionError::Superseded | MotionError::Stopped => StatusCode::CONFLICT,
        _ => StatusCode::BAD_GATEWAY,
    };
    (status, error.to_string())
}

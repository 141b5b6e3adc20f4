//! A service that accepts jobs at any time and runs one after the other.
//!
//! `cargo run --release --features http --example job_queue [ADDRESS]`, then, with the port that it
//! prints: 5 cm up by `curl 127.0.0.1:PORT/jobs --json '[0, 0, 0.05]'`; the outcomes by
//! `curl 127.0.0.1:PORT/jobs`

use std::net::SocketAddr;

use anyhow::bail;
use axum::http::{Extensions, StatusCode};
use axum::{Json, Router, extract::ConnectInfo, response::IntoResponse, routing::post};
use franka_async::connection::admission::{Admission, Refused};
use franka_async::prelude::*;
use tokio::signal::{ctrl_c, unix};
use tokio::sync::{mpsc, watch};

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let address = std::env::args().nth(1);
    let builder = Robot::builder(address.as_deref().unwrap_or("127.0.0.1"));
    // `Ignore` is for simulators. Without it a real-time kernel is required, as for a robot.
    let robot = builder.realtime(Realtime::Ignore).connect().await?;

    let (queue, mut jobs) = mpsc::channel::<[f64; 3]>(16);
    let (done, outcomes) = watch::channel(Vec::new());
    let (mover, reflexed) = (robot.clone(), robot.clone());
    tokio::spawn(async move {
        while let Some(by) = jobs.recv().await {
            let outcome = mover.move_by(Offset::base(by)).speed(0.5).await;
            let text = outcome.map_or_else(|error| error.to_string(), |_| "arrived".to_owned());
            done.send_modify(|outcomes| outcomes.push(text)); // a real service forgets old ones
        }
    });

    let take = async move |Json(by)| match queue.try_send(by) {
        Ok(()) => (StatusCode::ACCEPTED, String::new()),
        Err(error) => (StatusCode::SERVICE_UNAVAILABLE, error.to_string()),
    };
    let list = async move || Json(outcomes.borrow().clone());
    let recover = async move || match reflexed.recover().await {
        Ok(()) => (StatusCode::OK, String::new()),
        Err(error) => (StatusCode::CONFLICT, error.to_string()),
    };
    let jobs = Router::new().route("/jobs", post(take).get(list));
    let jobs = jobs.route("/recover", post(recover));
    // Requests from other computers, and from pages of other sites in a browser on this computer,
    // are refused.
    let peer = |of: &Extensions| of.get::<ConnectInfo<SocketAddr>>().map(|peer| peer.0);
    let refuse = |refused: Refused| (refused.status(), refused.to_string()).into_response();
    let jobs = jobs.layer(Admission::default().layer(peer, refuse));
    let jobs = jobs.into_make_service_with_connect_info::<SocketAddr>();
    let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await?;
    println!("listening on {}", listener.local_addr()?);
    let mut terminated = unix::signal(unix::SignalKind::terminate())?;
    tokio::select! {
        served = axum::serve(listener, jobs).into_future() => served?,
        reason = robot.closed() => bail!("{reason}"), // a service manager starts it again
        _ = ctrl_c() => {}
        _ = terminated.recv() => {}
    }
    robot.shutdown().await; // brakes if a job is running
    Ok(())
}

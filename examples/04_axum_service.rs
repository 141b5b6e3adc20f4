//! A web service in which motions are jobs: they outlive their request, report their progress, and
//! can be cancelled.
//!
//! ```text
//! cargo run --release --features http --example axum_service -- [ADDRESS] [--listen 127.0.0.1:8080]
//! curl -i localhost:8080/jobs -H 'content-type: application/json' -d '{"by": [0, 0, 0.05]}'
//! curl -N localhost:8080/jobs/1/events
//! curl -X DELETE localhost:8080/jobs/1
//! ```

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use axum::extract::{Path, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use clap::Parser;
use franka_async::connection::CancellationToken;
use franka_async::error::Party;
use franka_async::nalgebra::Translation3;
use franka_async::{MotionError, Offset, Robot, metrics};
use franka_examples::{Job, Serving, admit, serve_until_told};
use serde::Deserialize;
use serde_json::{Value, json};
use tokio_stream::StreamExt;

#[derive(Clone)]
struct Service {
    robot: Robot,
    jobs: Arc<Mutex<BTreeMap<u64, Job>>>,
    closing: CancellationToken,
}

#[derive(Deserialize)]
struct Order {
    /// Displacement of the hand along the axes of the base, `[m]`.
    by: [f64; 3],
    /// Speed, as a factor of the default.
    speed: Option<f64>,
}

type Refused = (StatusCode, String);

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let arguments = Serving::parse();
    let (robot, _sim) = arguments.connection.open().await?;
    let closing = CancellationToken::new();
    let service = Service {
        robot: robot.clone(),
        jobs: Arc::default(),
        closing: closing.clone(),
    };
    let app = Router::new()
        .route("/jobs", post(begin))
        .route("/jobs/{id}", get(newest).delete(cancel))
        .route("/jobs/{id}/events", get(events))
        .route("/state", get(state))
        .route("/recover", post(recover))
        .route("/metrics", get(scrape))
        .with_state(service);
    let (listener, admission) = arguments.listen().await?;
    let app = admit(app, &admission);
    serve_until_told(&robot, closing, arguments.deadline, |quit| {
        let serving = axum::serve(listener, app).with_graceful_shutdown(quit);
        serving.into_future()
    })
    .await
}

/// Answers once the robot moves, with the address of the job, or with the reason for a refusal.
async fn begin(service: State<Service>, Json(order): Json<Order>) -> Result<Response, Refused> {
    let (id, job) = service.start(&order)?;
    job.begun().await.map_err(refuse)?;
    let location = [(header::LOCATION, format!("/jobs/{id}"))];
    Ok((StatusCode::ACCEPTED, location, Json(json!({ "id": id }))).into_response())
}

async fn newest(service: State<Service>, id: Path<u64>) -> Result<Json<Value>, Refused> {
    Ok(Json(service.job(*id)?.newest().stage.to_json()))
}

async fn cancel(service: State<Service>, id: Path<u64>) -> Result<StatusCode, Refused> {
    service.job(*id)?.cancel();
    Ok(StatusCode::ACCEPTED) // the events report when the arm is at rest
}

/// Sends server-sent events. A browser that lost its connection asks again, and names the last
/// event it received.
async fn events(
    service: State<Service>,
    id: Path<u64>,
    headers: HeaderMap,
) -> Result<Response, Refused> {
    let job = service.job(*id)?;
    let seen = headers.get("last-event-id").and_then(|id| id.to_str().ok());
    let seen = seen.and_then(|id| id.parse().ok());
    let newest = job.newest();
    if newest.stage.is_last() && seen == Some(newest.number) {
        return Ok(StatusCode::NO_CONTENT.into_response()); // so it stops asking
    }
    let events = job.events(seen).map(|progress| {
        let event = Event::default().id(progress.number.to_string());
        let event = event.event(progress.stage.name());
        event.json_data(progress.stage.to_json())
    });
    let events = Sse::new(events).keep_alive(KeepAlive::default());
    Ok(events.into_response())
}

async fn state(service: State<Service>) -> Json<Value> {
    let state = service.robot.state();
    Json(json!({ "time": state.message_id, "mode": state.robot_mode.to_string(), "q": state.q }))
}

async fn recover(service: State<Service>) -> Result<(), Refused> {
    let recovered = service.robot.recover().await;
    recovered.map_err(|error| (StatusCode::CONFLICT, error.to_string()))
}

async fn scrape(service: State<Service>) -> impl IntoResponse {
    let content = [(header::CONTENT_TYPE, metrics::CONTENT_TYPE)];
    (content, service.robot.metrics())
}

impl Service {
    /// Starts a job, unless another one uses the arm: otherwise a newer motion would supersede the
    /// older one.
    fn start(&self, order: &Order) -> Result<(u64, Job), Refused> {
        let mut jobs = self.jobs.lock().expect("no panic while it is held");
        if self.closing.is_cancelled() {
            let text = "the service is ending".to_owned();
            return Err((StatusCode::SERVICE_UNAVAILABLE, text));
        }
        let last = jobs.last_key_value();
        if let Some((id, _)) = last.filter(|(_, job)| !job.newest().stage.is_last()) {
            return Err((StatusCode::CONFLICT, format!("job {id} has the arm")));
        }
        let id = last.map_or(1, |(id, _)| id + 1);
        let motion = self
            .robot
            .move_by(Offset::base(Translation3::from(order.by)));
        let job = Job::start(motion.speed(order.speed.unwrap_or(1.0)));
        jobs.insert(id, job.clone());
        if jobs.len() > JOBS {
            jobs.pop_first();
        }
        Ok((id, job))
    }

    fn job(&self, id: u64) -> Result<Job, Refused> {
        let jobs = self.jobs.lock().expect("no panic while it is held");
        let job = jobs.get(&id).cloned();
        job.ok_or_else(|| (StatusCode::NOT_FOUND, format!("no job {id}")))
    }
}

fn refuse(error: MotionError) -> Refused {
    let status = match error {
        MotionError::Goal(_) => StatusCode::UNPROCESSABLE_ENTITY,
        MotionError::ConnectionClosed { .. } => StatusCode::SERVICE_UNAVAILABLE,
        // The link is lost, or a supervised robot is unavailable.
        _ if error.party() == Party::Link => StatusCode::SERVICE_UNAVAILABLE,
        MotionError::Violation(_) | MotionError::Protocol { .. } => StatusCode::BAD_GATEWAY,
        // Another user has the arm or stopped it, or the robot must be recovered first.
        _ => StatusCode::CONFLICT,
    };
    (status, error.to_string())
}

/// Number of jobs whose result is kept.
const JOBS: usize = 100;

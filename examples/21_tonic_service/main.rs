//! A gRPC service: `proto/arm.proto` documents each call. A motion belongs to its call: if the call
//! is cancelled, or its caller disconnects, the arm brakes.
//!
//! `cargo run --release --features grpc --example tonic_service`, then `-- ADDRESS` for the robot
//! there, and `--listen 127.0.0.1:8080` for another port

use std::net::SocketAddr;
use std::pin::Pin;
use std::time::{Duration, Instant};

use clap::Parser;
use franka_async::Robot;
use franka_async::connection::CancellationToken;
use franka_async::connection::admission::Refused;
use franka_async::connection::lease::Holder;
use franka_async::goal::{Lead, OnTimeout};
use franka_examples::{Serving, serve_until_told};
use tokio::sync::{mpsc, watch};
use tokio_stream::wrappers::{ReceiverStream, TcpListenerStream};
use tokio_stream::{Stream, StreamExt};
use tonic::codegen::http;
use tonic::transport::Server;
use tonic::transport::server::TcpConnectInfo;
use tonic::{Request, Response, Status, Streaming};

mod messages;

use messages::proto::arm_server::{Arm, ArmServer};
use messages::proto::{Arrival, MoveRequest, Pose, State, StatesRequest};
use messages::{state, status};

struct Service {
    robot: Robot,
    closing: CancellationToken,
}

type Answers<T> = Pin<Box<dyn Stream<Item = Result<T, Status>> + Send>>;

/// Largest distance of a target ahead of the arm, and the time for which a target is followed
/// without another.
const LEAD: Lead = Lead {
    translation: 0.1,
    rotation: 0.3,
    joints: 0.3,
};
const SILENCE: Duration = Duration::from_millis(500);

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let arguments = Serving::parse();
    let (robot, _sim) = arguments.connection.open().await?;
    let closing = CancellationToken::new();
    let service = Service {
        robot: robot.clone(),
        closing: closing.clone(),
    };
    let (listener, admission) = arguments.listen().await?;
    let listener = TcpListenerStream::new(listener);
    let peer = |of: &http::Extensions| of.get::<TcpConnectInfo>()?.remote_addr();
    serve_until_told(&robot, closing, arguments.deadline, |quit| {
        // A client whose computer has failed does not close its connection: the keepalive detects
        // this, and ends its calls.
        let server = Server::builder().http2_keepalive_interval(Some(Duration::from_secs(1)));
        let server = server.http2_keepalive_timeout(Some(Duration::from_secs(2)));
        let mut server = server.layer(admission.layer(peer, refuse));
        let service = ArmServer::new(service);
        server
            .add_service(service)
            .serve_with_incoming_shutdown(listener, quit)
    })
    .await
}

/// Answers a refused request.
fn refuse(refused: Refused) -> http::Response<tonic::body::Body> {
    let text = refused.to_string();
    let status = match refused {
        Refused::Token => Status::unauthenticated(text),
        _ => Status::permission_denied(text),
    };
    status.into_http()
}

#[tonic::async_trait]
impl Arm for Service {
    type StreamStatesStream = Answers<State>;
    type FollowTargetsStream = Answers<State>;

    async fn get_state(&self, _: Request<()>) -> Result<Response<State>, Status> {
        Ok(Response::new(state(&self.robot, &self.robot.state())))
    }

    async fn stream_states(
        &self,
        request: Request<StatesRequest>,
    ) -> Result<Response<Answers<State>>, Status> {
        let rate = request.into_inner().rate;
        if !(1.0..=100.0).contains(&rate) {
            return Err(Status::invalid_argument(format!(
                "rate {rate}, expected 1 to 100"
            )));
        }
        let robot = self.robot.clone();
        let states = robot.states().throttle(Duration::from_secs_f64(1.0 / rate));
        Ok(Response::new(Box::pin(
            states.map(move |newest| Ok(state(&robot, &newest))),
        )))
    }

    async fn move_to(&self, request: Request<MoveRequest>) -> Result<Response<Arrival>, Status> {
        let _holder = self.lease(request.remote_addr())?;
        let MoveRequest { target, speed } = request.into_inner();
        let target = target.ok_or_else(|| Status::invalid_argument("no target"))?;
        let target = target.to_isometry(&self.robot.pose())?;
        let speed = if speed == 0.0 { 1.0 } else { speed };
        // Dropped if the call is cancelled, which brakes the arm. The lease is then free.
        let moving = self.robot.move_to(target).speed(speed);
        let report = moving.await.map_err(status)?;
        Ok(Response::new(Arrival {
            duration: report.duration.as_secs_f64(),
            error: report.final_error.map_or(0.0, |error| error.translation),
        }))
    }

    async fn follow_targets(
        &self,
        request: Request<Streaming<Pose>>,
    ) -> Result<Response<Answers<State>>, Status> {
        let holder = self.lease(request.remote_addr())?;
        let (robot, (states, answers)) = (self.robot.clone(), mpsc::channel(1));
        tokio::spawn(async move {
            let end = tokio::select! {
                end = follow(&robot, holder, request.into_inner(), &states) => end,
                () = states.closed() => return, // the caller has disconnected: the arm brakes
            };
            if let Err(status) = end {
                let _ = states.send(Err(status)).await; // or the caller disconnects now
            }
        });
        Ok(Response::new(Box::pin(ReceiverStream::new(answers))))
    }

    async fn stop(&self, _: Request<()>) -> Result<Response<()>, Status> {
        self.robot.stop().await.map(Response::new).map_err(status)
    }

    async fn recover(&self, _: Request<()>) -> Result<Response<State>, Status> {
        let recovered = self.robot.recover().await;
        recovered.map_err(|error| Status::failed_precondition(error.to_string()))?;
        Ok(Response::new(state(&self.robot, &self.robot.state())))
    }
}

impl Service {
    /// Takes the lease for a call. It ends with the call, so silence need not be monitored.
    fn lease(&self, peer: Option<SocketAddr>) -> Result<Holder, Status> {
        if self.closing.is_cancelled() {
            return Err(Status::unavailable("the service is ending"));
        }
        let name = peer.map_or_else(|| "unknown".to_owned(), |peer| peer.to_string());
        let holder = self.robot.lease().take(name, Duration::MAX, Instant::now());
        holder.map_err(|taken| Status::failed_precondition(taken.to_string()))
    }
}

/// Follows the caller's targets to their end, and answers with states at 50 Hz. Dropping this
/// future drops the motion, and so brakes the arm; then the lease is free.
async fn follow(
    robot: &Robot,
    _holder: Holder,
    mut targets: Streaming<Pose>,
    states: &mpsc::Sender<Result<State, Status>>,
) -> Result<(), Status> {
    let start = robot.pose();
    let (newest, followed) = watch::channel(start);
    let mut newest = Some(newest);
    let following = robot
        .follow(followed)
        .lead(LEAD)
        .watchdog(SILENCE, OnTimeout::Brake);
    let mut following = following.into_future();
    let mut clock = tokio::time::interval(Duration::from_millis(20));
    loop {
        tokio::select! {
            outcome = &mut following => return outcome.map(drop).map_err(status),
            target = targets.message(), if newest.is_some() => match (target?, &newest) {
                (Some(target), Some(newest)) => drop(newest.send_replace(target.to_isometry(&start)?)),
                _ => newest = None, // the caller has closed its side: move to the last target
            },
            // A caller that does not read misses states, but delays nothing.
            _ = clock.tick() => drop(states.try_send(Ok(state(robot, &robot.state())))),
        }
    }
}

//! Teleoperation over WebSockets. Every socket sees the states; one at a time has the lease on the
//! arm, for as long as its messages come.
//!
//! `cargo run --release --features http --example axum_teleoperation -- [ADDRESS] [--silence 0.3]`,
//! then connect to `ws://localhost:8080/teleoperation` and send
//!
//! ```text
//! {"type": "take"}
//! {"type": "target", "position": [0.3, 0.1, 0.5], "quaternion": [1, 0, 0, 0]}   at any rate
//! {"type": "alive"}                                                             without a target
//! {"type": "release"}
//! {"type": "recover"}                                                           from a reflex, without the lease
//! ```

mod lease;
mod messages;

use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::extract::State;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::response::Response;
use axum::routing::get;
use clap::Parser;
use franka_async::Robot;
use franka_async::connection::CancellationToken;
use franka_examples::{Serving, admit, seconds, serve_until_told};
use tokio::sync::Semaphore;
use tokio::time::{MissedTickBehavior, interval, timeout};

use lease::Lease;
use messages::{Reply, Request, refused};

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    serving: Serving,
    /// Silence of the socket that has the lease after which the arm brakes and the lease ends,
    /// `[s]`.
    #[arg(long, default_value = "0.3", value_parser = seconds, allow_negative_numbers = true)]
    silence: Duration,
}

#[derive(Clone)]
struct Service {
    robot: Robot,
    /// Has one permit: the lease.
    free: Arc<Semaphore>,
    silence: Duration,
    closing: CancellationToken,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let Arguments { serving, silence } = Arguments::parse();
    let (robot, _sim) = serving.connection.open().await?;
    let closing = CancellationToken::new();
    let service = Service {
        robot: robot.clone(),
        free: Arc::new(Semaphore::new(1)),
        silence,
        closing: closing.clone(),
    };
    let connect = async |service: State<Service>, upgrade: WebSocketUpgrade| -> Response {
        upgrade.on_upgrade(|socket| service.0.attend(socket))
    };
    let app = Router::new()
        .route("/teleoperation", get(connect))
        .with_state(service);
    let (listener, admission) = serving.listen().await?;
    let app = admit(app, &admission);
    serve_until_told(&robot, closing, serving.deadline, |quit| {
        let serving = axum::serve(listener, app).with_graceful_shutdown(quit);
        serving.into_future()
    })
    .await
}

impl Service {
    /// Attends to a socket until it ends. Whatever ends it, its lease is dropped here, and with
    /// that the arm brakes.
    async fn attend(self, mut socket: WebSocket) {
        let mut lease = None;
        let mut clock = interval(Duration::from_millis(20));
        clock.set_missed_tick_behavior(MissedTickBehavior::Skip);
        loop {
            let reply = tokio::select! {
                message = socket.recv() => match message {
                    Some(Ok(Message::Text(text))) => self.answer(&text, &mut lease).await,
                    // Libraries answer pings, whatever became of the program that uses them: only
                    // messages of the program itself keep the lease.
                    Some(Ok(Message::Ping(_) | Message::Pong(_) | Message::Binary(_))) => None,
                    Some(Ok(Message::Close(_))) => {
                        drop(lease);
                        // Reading on answers the farewell.
                        let _ = socket.recv().await;
                        return;
                    }
                    Some(Err(_)) | None => return,
                },
                reply = Lease::trouble(&mut lease) => Some(reply),
                _ = clock.tick() => Some(Reply::state(&self.robot)),
                () = self.closing.cancelled() => return,
            };
            let Some(reply) = reply else { continue };
            let text = serde_json::to_string(&reply).expect("replies are plain data");
            // A client that does not read keeps the lease no longer than one that does not write.
            let sent = timeout(self.silence, socket.send(text.into())).await;
            if !matches!(sent, Ok(Ok(()))) {
                return;
            }
        }
    }

    async fn answer(&self, text: &str, lease: &mut Option<Lease>) -> Option<Reply> {
        let request = match serde_json::from_str(text) {
            Ok(request) => request,
            Err(error) => return Some(refused(error)),
        };
        let Some(held) = lease else {
            if !matches!(request, Request::Take | Request::Recover) {
                return Some(refused("this socket does not have the lease"));
            }
            let Ok(permit) = self.free.clone().try_acquire_owned() else {
                return Some(refused("another socket has the lease"));
            };
            if matches!(request, Request::Recover) {
                let recovered = self.robot.recover().await;
                return Some(recovered.map_or_else(refused, |()| Reply::Recovered));
            }
            *lease = match Lease::begin(&self.robot, permit, self.silence).await {
                Ok(begun) => Some(begun),
                Err(error) => return Some(refused(error)),
            };
            return Some(Reply::Taken);
        };
        held.keep_alive();
        match request {
            Request::Target(target) => match target.pose() {
                Some(pose) => held.head_for(pose),
                None => return Some(refused("the quaternion is no rotation")),
            },
            Request::Take | Request::Alive => {}
            Request::Recover => return Some(refused("release the lease first")),
            Request::Release => {
                *lease = None;
                return Some(Reply::Released);
            }
        }
        None
    }
}

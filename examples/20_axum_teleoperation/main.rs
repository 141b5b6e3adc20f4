//! Teleoperation over WebSockets. Every socket receives the states. One at a time has the lease on
//! the arm, as long as its messages arrive.
//!
//! `cargo run --release --features http --example axum_teleoperation -- [ADDRESS] [--silence 0.3]`,
//! then connect to `ws://localhost:8080/teleoperation` and send
//!
//! ```text
//! {"type": "take", "name": "Ada"}                                               the name can be missing
//! {"type": "target", "position": [0.3, 0.1, 0.5], "quaternion": [1, 0, 0, 0]}   at any rate
//! {"type": "alive"}                                                             without a target
//! {"type": "release"}
//! {"type": "stop"}                                                              from anyone
//! {"type": "recover"}                                                           from a reflex, while the lease is free
//! ```

mod messages;
mod session;

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use axum::Router;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::extract::{ConnectInfo, State};
use axum::response::Response;
use axum::routing::get;
use clap::Parser;
use franka_async::Robot;
use franka_async::connection::CancellationToken;
use franka_examples::{Serving, admit, seconds, serve_until_told};
use tokio::time::{MissedTickBehavior, interval, timeout};

use messages::{Reply, Request, refused};
use session::Session;

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    serving: Serving,
    /// Silence of the leading socket after which the arm brakes and the lease ends, `[s]`.
    #[arg(long, default_value = "0.3", value_parser = seconds, allow_negative_numbers = true)]
    silence: Duration,
}

#[derive(Clone)]
struct Service {
    robot: Robot,
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
        silence,
        closing: closing.clone(),
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

async fn connect(
    service: State<Service>,
    peer: ConnectInfo<SocketAddr>,
    upgrade: WebSocketUpgrade,
) -> Response {
    upgrade.on_upgrade(move |socket| service.0.attend(socket, peer.0))
}

impl Service {
    /// Serves a socket until it ends. Its session is then dropped, which brakes the arm.
    async fn attend(self, mut socket: WebSocket, peer: SocketAddr) {
        let mut session = None;
        let mut clock = interval(Duration::from_millis(20));
        clock.set_missed_tick_behavior(MissedTickBehavior::Skip);
        loop {
            let reply = tokio::select! {
                message = socket.recv() => match message {
                    Some(Ok(Message::Text(text))) => self.answer(&text, &mut session, peer).await,
                    // Libraries answer pings even if their program has failed: only messages of the
                    // program itself keep the lease.
                    Some(Ok(Message::Ping(_) | Message::Pong(_) | Message::Binary(_))) => None,
                    Some(Ok(Message::Close(_))) => {
                        drop(session);
                        // A further read answers the close message.
                        let _ = socket.recv().await;
                        return;
                    }
                    Some(Err(_)) | None => return,
                },
                reply = Session::trouble(&mut session) => Some(reply),
                _ = clock.tick() => Some(Reply::state(&self.robot)),
                () = self.closing.cancelled() => return,
            };
            let Some(reply) = reply else { continue };
            let text = serde_json::to_string(&reply).expect("replies are plain data");
            // A client that does not read loses the lease as fast as a client that does not write.
            let sent = timeout(self.silence, socket.send(text.into())).await;
            if !matches!(sent, Ok(Ok(()))) {
                return;
            }
        }
    }

    async fn answer(
        &self,
        text: &str,
        session: &mut Option<Session>,
        peer: SocketAddr,
    ) -> Option<Reply> {
        let request = match serde_json::from_str(text) {
            Ok(request) => request,
            Err(error) => return Some(refused(error)),
        };
        if matches!(request, Request::Stop) {
            let stopped = self.robot.stop().await;
            return Some(stopped.map_or_else(refused, |()| Reply::Stopped));
        }
        let Some(held) = session else {
            return Some(match request {
                Request::Take { name } => match self.take(name, peer).await {
                    Ok(begun) => {
                        *session = Some(begun);
                        Reply::Taken
                    }
                    Err(refused) => refused,
                },
                Request::Recover => self.recover(peer).await.unwrap_or_else(|refused| refused),
                _ => refused("this socket does not have the lease"),
            });
        };
        if let Err(lost) = held.keep_alive() {
            *session = None;
            let why = lost.to_string();
            return Some(Reply::Lost { why });
        }
        match request {
            Request::Target(target) => match target.pose() {
                Some(pose) => held.head_for(pose),
                None => return Some(refused("the quaternion is no rotation")),
            },
            Request::Take { .. } | Request::Alive | Request::Stop => {}
            Request::Recover => return Some(refused("release the lease first")),
            Request::Release => {
                *session = None;
                return Some(Reply::Released);
            }
        }
        None
    }

    async fn take(&self, name: Option<String>, peer: SocketAddr) -> Result<Session, Reply> {
        let name = name.unwrap_or_else(|| peer.to_string());
        let holder = self.robot.lease().take(name, self.silence, Instant::now());
        let holder = holder.map_err(refused)?;
        Session::begin(&self.robot, holder).await.map_err(refused)
    }

    /// Recovers the robot for a client, which holds the lease meanwhile.
    async fn recover(&self, peer: SocketAddr) -> Result<Reply, Reply> {
        let lease = self.robot.lease();
        let holder = lease.take(peer.to_string(), Duration::MAX, Instant::now());
        let _holder = holder.map_err(refused)?;
        self.robot.recover().await.map_err(refused)?;
        Ok(Reply::Recovered)
    }
}

//! The shared parts of services: their options, and the shutdown of a service with a robot.

#[cfg(feature = "http")]
use std::net::SocketAddr;
use std::path::PathBuf;
use std::pin::pin;
use std::time::Duration;

use anyhow::{Context, anyhow, bail};
#[cfg(feature = "http")]
use axum::{
    Router,
    extract::{ConnectInfo, connect_info::IntoMakeServiceWithConnectInfo},
    http::Extensions,
    response::IntoResponse,
};
use clap::Parser;
use franka_async::Robot;
use franka_async::connection::CancellationToken;
#[cfg(feature = "http")]
use franka_async::connection::admission::Refused;
use franka_async::connection::admission::{Admission, Token};
use tokio::net::TcpListener;
use tokio::signal::unix::{SignalKind, signal};
use tokio::time::{Instant, timeout_at};
use tokio_util::sync::WaitForCancellationFutureOwned;

use crate::Connection;

/// Command line of the services.
#[derive(Debug, Parser)]
#[command(about = None)]
pub struct Serving {
    /// The robot.
    #[command(flatten)]
    pub connection: Connection,
    /// Address to listen on. Addresses that other computers can reach need a token.
    #[arg(long, default_value = "127.0.0.1:8080")]
    listen: String,
    /// Require the token in this file from each client; without it, the token in the variable
    /// FRANKA_ACCESS_TOKEN, if it is set.
    #[arg(long, conflicts_with = "new_token")]
    token_file: Option<PathBuf>,
    /// Require a new random token from each client, and print it.
    #[arg(long)]
    new_token: bool,
    /// Time limit for the shutdown, `[s]`.
    #[arg(long, default_value = "5", value_parser = seconds, allow_negative_numbers = true)]
    pub deadline: Duration,
}

impl Serving {
    /// Listens, prints the address, and returns the rules for the requests.
    ///
    /// # Errors
    /// If the address is not available, or other computers can reach it and there is no token.
    pub async fn listen(&self) -> anyhow::Result<(TcpListener, Admission)> {
        let token = match self.new_token {
            true => Some(Token::generate()?),
            false => Token::configured(self.token_file.as_deref())?,
        };
        let listener = TcpListener::bind(&self.listen).await;
        let listener = listener.with_context(|| format!("listening on {}", self.listen))?;
        let address = listener.local_addr()?;
        let admission = match &token {
            Some(token) => Admission::default().token(token.clone()),
            None => Admission::default(),
        };
        let checked = admission.check_listener(address);
        checked.context("no token: see FRANKA_ACCESS_TOKEN, --token-file and --new-token")?;
        println!("listening on {address}");
        if let Some(token) = token.filter(|_| self.new_token) {
            println!("token {}", token.reveal());
        }
        Ok((listener, admission))
    }
}

/// Parses a duration from an argument, `[s]`.
///
/// # Errors
/// If it is not a number, negative, not finite, or too large.
pub fn seconds(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text
        .parse()
        .map_err(|_| format!("got {text:?}, expected seconds"))?;
    match (0.0..=SECONDS_MAX).contains(&seconds) {
        true => Ok(Duration::from_secs_f64(seconds)),
        false => Err(format!("got {seconds} s, expected 0 to {SECONDS_MAX} s")),
    }
}

/// A day: longer times are mistakes, and adding a very long time to another one panics.
const SECONDS_MAX: f64 = 86_400.0;

/// Checks all requests to a web service before it receives them.
#[cfg(feature = "http")]
pub fn admit(
    app: Router,
    admission: &Admission,
) -> IntoMakeServiceWithConnectInfo<Router, SocketAddr> {
    let peer = |of: &Extensions| of.get::<ConnectInfo<SocketAddr>>().map(|peer| peer.0);
    let refuse = |refused: Refused| (refused.status(), refused.to_string()).into_response();
    let app = app.layer(admission.layer(peer, refuse));
    app.into_make_service_with_connect_info()
}

/// Serves until SIGTERM, Ctrl-C or the end of the connection to the robot, and then ends within
/// `deadline`:
///
/// 1. `closing` is cancelled: the service must refuse motions from then on.
/// 2. The arm is braked and released, and the connection closed, while clients still receive
///    answers: clients that wait for a motion are notified that it was stopped.
/// 3. The signal passed to `serve` is sent: the server accepts no more connections and completes
///    its current requests.
/// 4. At the deadline, all open connections are cut. The arm stops within a second, so the
///    remaining time is for the clients.
///
/// # Errors
/// The error of the server; the reason for the end of the robot's connection, so that the service
/// can be restarted; or that the arm was not seen to be at rest.
pub async fn serve_until_told<S, E>(
    robot: &Robot,
    closing: CancellationToken,
    deadline: Duration,
    serve: impl FnOnce(WaitForCancellationFutureOwned) -> S,
) -> anyhow::Result<()>
where
    S: Future<Output = Result<(), E>>,
    E: Into<anyhow::Error>,
{
    let at_rest = CancellationToken::new();
    let mut serving = pin!(serve(at_rest.clone().cancelled_owned()));
    let why = tokio::select! {
        served = &mut serving => return served.map_err(Into::into),
        told = termination() => told.map_err(Into::into),
        reason = robot.closed() => Err(anyhow!("the connection to the robot has ended: {reason}")),
    };
    println!("ending");
    closing.cancel();
    let end = Instant::now() + deadline;
    let resting = async {
        // `shutdown` alone brakes too. `stop` reports whether the arm was seen to be at rest.
        let rested = timeout_at(end, robot.stop()).await;
        let closed = timeout_at(end, robot.shutdown()).await;
        at_rest.cancel();
        rested.and_then(|rested| closed.map(|()| rested))
    };
    let (rested, served) = tokio::join!(resting, timeout_at(end, serving));
    match served {
        Ok(served) => served.map_err(Into::into)?,
        Err(_) => println!("cut the connections that were left"),
    }
    why?;
    match rested {
        Ok(rested) => rested.context("the arm was not seen to rest"),
        Err(_) => bail!("the arm was not seen to rest within {deadline:?}"),
    }
}

/// Resolves when the process receives a signal to end.
async fn termination() -> std::io::Result<()> {
    let mut terminate = signal(SignalKind::terminate())?;
    tokio::select! {
        _ = terminate.recv() => Ok(()),
        interrupted = tokio::signal::ctrl_c() => interrupted,
    }
}

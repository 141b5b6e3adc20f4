//! What services have in common: their options, and how one that has a robot ends.

use std::pin::pin;
use std::time::Duration;

use anyhow::{Context, anyhow, bail};
use clap::Parser;
use franka_async::Robot;
use franka_async::connection::CancellationToken;
use tokio::net::TcpListener;
use tokio::signal::unix::{SignalKind, signal};
use tokio::time::{Instant, timeout_at};
use tokio_util::sync::WaitForCancellationFutureOwned;

use crate::Connection;

/// Command line of the services.
#[derive(Debug, Parser)]
#[command(about = None)]
pub struct Serving {
    /// Which robot.
    #[command(flatten)]
    pub connection: Connection,
    /// Where to listen. Whoever gets there can move the arm: keep it off open networks.
    #[arg(long, default_value = "127.0.0.1:8080")]
    listen: String,
    /// Time to end in, `[s]`.
    #[arg(long, default_value_t = 5.0)]
    deadline: f64,
}

impl Serving {
    /// Listens, and says where.
    ///
    /// # Errors
    /// If the address cannot be had.
    pub async fn listen(&self) -> anyhow::Result<TcpListener> {
        let listener = TcpListener::bind(&self.listen).await;
        let listener = listener.with_context(|| format!("listening on {}", self.listen))?;
        println!("listening on {}", listener.local_addr()?);
        Ok(listener)
    }

    /// Time to end in.
    pub fn deadline(&self) -> Duration {
        Duration::from_secs_f64(self.deadline)
    }
}

/// Serves until SIGTERM, Ctrl-C or the end of the connection to the robot, and then ends within
/// `deadline`:
///
/// 1. `closing` is cancelled: the service has to refuse motions from then on.
/// 2. The arm is braked and let go, and the connection closed, while clients are still answered:
///    those that wait for a motion are told that it was stopped.
/// 3. The signal that `serve` got is given: the server takes no more connections and finishes the
///    requests that it has.
/// 4. At the deadline, whatever is still open is cut. An arm that rests needs a second at most, so
///    that the rest of the time is left to the clients.
///
/// # Errors
/// What made the server end, and why the connection to the robot ended, so that whatever started
/// the service can start it again; that the arm was not seen to rest.
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
        // `shutdown` alone brakes, too. `stop` says whether the arm was seen to rest.
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

/// Resolves when the process is asked to end.
async fn termination() -> std::io::Result<()> {
    let mut terminate = signal(SignalKind::terminate())?;
    tokio::select! {
        _ = terminate.recv() => Ok(()),
        interrupted = tokio::signal::ctrl_c() => interrupted,
    }
}

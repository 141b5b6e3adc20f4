//! `franka guide`: lets a person guide the arm by hand.

use std::time::Duration;

use clap::{Args, ValueEnum};
use franka_async::goal::Free;
use franka_async::{Engage, MotionError};
use serde_json::json;
use tokio::time::timeout;

use crate::ending::Ending;
use crate::interrupt::{Interruption, interrupted};
use crate::motion::{Mover, Moving};
use crate::output::say;
use crate::values::seconds;

/// Guide the arm by hand
///
/// Runs until Ctrl-C; a second Ctrl-C brakes at once. Declare a load at the flange first, or its
/// weight pulls the arm down.
#[derive(Debug, Args)]
pub(crate) struct Guide {
    #[command(flatten)]
    mover: Mover,
    /// Directions that are free
    #[arg(long, value_enum, default_value_t = What::All)]
    free: What,
    /// End after this many seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    seconds: Option<Duration>,
}

/// The directions in which the arm is free.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum What {
    /// Position, orientation and elbow
    All,
    /// Position of the hand
    Position,
    /// Orientation of the hand
    Orientation,
    /// Elbow only; the hand stays in place
    Elbow,
}

impl What {
    fn free(self) -> Free {
        let axes = |position: bool, orientation: bool| {
            let [p, o] = [position, orientation];
            [p, p, p, o, o, o]
        };
        match self {
            Self::All => Free::ALL,
            Self::Position => Free {
                axes: axes(true, false),
                elbow: true,
            },
            Self::Orientation => Free {
                axes: axes(false, true),
                elbow: true,
            },
            Self::Elbow => Free {
                axes: axes(false, false),
                elbow: true,
            },
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::All => "the arm freely",
            Self::Position => "the hand anywhere; it keeps its orientation",
            Self::Orientation => "the hand to any orientation; it stays in place",
            Self::Elbow => "the elbow; the hand stays in place",
        }
    }
}

impl Guide {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        let moving = self.mover.begin().await?;
        let outcome = self.guide(&moving).await;
        let q = moving.end(outcome).await?;
        self.mover.how.output.print(&json!({ "q": q }), || {
            let degrees = crate::output::numbers(&q.map(f64::to_degrees), 2);
            format!("the arm rests at {degrees}  deg")
        })
    }

    async fn guide(&self, moving: &Moving) -> anyhow::Result<[f64; 7]> {
        let robot = &moving.robot;
        let load = robot.state().m_load;
        let what = format!(
            "You can push {}. The declared load is {load:.2} kg.\n\
             speed as fast as you push, within the joint limits",
            self.free.text()
        );
        moving.ask("guide", &what).await?;
        // The handler must be installed before the session begins, so that Ctrl-C always ends the
        // session.
        let interrupt = interrupted()?;
        let guided = async {
            let arm = robot.engage(Engage::default()).await?;
            arm.guide(self.free.free()).await?;
            say("Guide the arm. Ctrl-C ends.");
            let end = async {
                match self.seconds {
                    Some(seconds) => tokio::time::sleep(seconds).await,
                    None => std::future::pending().await,
                }
            };
            let first = tokio::select! {
                () = end => None,
                by = interrupt => Some(by),
                ended = arm.ended() => return Ok(ended.map(drop)?),
            };
            let again = interrupted()?;
            let held = async {
                arm.hold().await?;
                arm.at_rest().await?;
                arm.disengage().await
            };
            // The arm does not stop as long as a person pushes it.
            tokio::select! {
                held = timeout(PATIENCE, held) => match held {
                    Ok(held) => Ok(held.map(drop)?),
                    Err(_) => Err(Guiding::NotAtRest(first)),
                },
                by = again => Err(Guiding::NotAtRest(Some(by))),
            }
        };
        let guided: Result<(), Guiding> = guided.await;
        match guided {
            Ok(()) => Ok(robot.state().q),
            Err(Guiding::NotAtRest(by)) => {
                say("The arm is still pushed and moving.");
                Err(moving.brake(by).await)
            }
            Err(Guiding::Failed(error)) => Err(moving.explain(error).await),
            Err(Guiding::Host(error)) => Err(error.into()),
        }
    }
}

/// Reason why guiding failed.
enum Guiding {
    Failed(MotionError),
    /// The arm did not come to a stop at the end, because a person was still moving it.
    NotAtRest(Option<Interruption>),
    Host(std::io::Error),
}

impl From<MotionError> for Guiding {
    fn from(error: MotionError) -> Self {
        Self::Failed(error)
    }
}

impl From<std::io::Error> for Guiding {
    fn from(error: std::io::Error) -> Self {
        Self::Host(error)
    }
}

/// Time limit for the arm to stop.
const PATIENCE: Duration = Duration::from_secs(5);

//! `franka gripper`: controls the Franka Hand.

use std::future::Future;

use clap::{Args, Subcommand};
use franka_async::Error;
use franka_async::error::GripperError;
use franka_async::gripper::{Grasp, Gripper as Hand, State};
use tokio::time::{Duration, timeout};

use crate::connection::Which;
use crate::ending::{Ending, Failure};
use crate::interrupt::{Interruption, interrupted};
use crate::output::{BOLD, Output, say};
use crate::question;
use crate::values::positive;

/// Move the fingers of the Franka Hand
///
/// ROBOT is the robot with the Hand; a port in an address is the port of the Hand.
#[derive(Debug, Subcommand)]
pub(crate) enum Gripper {
    /// Show the width between the fingers, and if they hold something
    #[command(after_help = "Example: franka gripper state left")]
    State {
        #[command(flatten)]
        which: Which,
        #[command(flatten)]
        output: Output,
    },
    /// Open the fingers
    #[command(after_help = "Example: franka gripper open left --width 0.06")]
    Open {
        #[command(flatten)]
        fingers: Fingers,
        /// Width in metres [default: the largest]
        #[arg(long, value_name = "M", value_parser = positive)]
        width: Option<f64>,
    },
    /// Close the fingers without gripping
    #[command(after_help = "Example: franka gripper close left")]
    Close {
        #[command(flatten)]
        fingers: Fingers,
    },
    /// Grasp an object and hold it
    #[command(after_help = "Example: franka gripper grasp left --width 0.03 --force 20")]
    Grasp {
        #[command(flatten)]
        fingers: Fingers,
        /// Width of the object in metres
        #[arg(long, value_name = "M", value_parser = positive)]
        width: f64,
        /// Accepted deviation of the width in metres
        #[arg(long, value_name = "M", value_parser = positive, default_value = "0.005")]
        within: f64,
        /// Force in newtons
        #[arg(long, value_name = "N", value_parser = positive, default_value = "20")]
        force: f64,
    },
    /// Calibrate the width of the fingers; required once after power-on
    #[command(after_help = "Example: franka gripper home left")]
    Home {
        #[command(flatten)]
        fingers: Fingers,
    },
    /// Stop the fingers and release the object
    #[command(after_help = "Example: franka gripper stop left")]
    Stop {
        #[command(flatten)]
        fingers: Fingers,
    },
}

/// Options of commands that move the fingers.
#[derive(Debug, Args)]
pub(crate) struct Fingers {
    #[command(flatten)]
    which: Which,
    /// Speed of the fingers in m/s
    #[arg(long, value_name = "M/S", value_parser = positive, default_value = "0.1")]
    speed: f64,
    /// Move without asking, for scripts
    #[arg(short, long)]
    yes: bool,
    #[command(flatten)]
    output: Output,
}

impl Gripper {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        match self {
            Self::State { which, output } => {
                let hand = which.place()?.connect_hand().await?;
                print(&hand.state(), output)
            }
            Self::Open { fingers, width } => {
                let hand = fingers.connect().await?;
                let width = width.unwrap_or(hand.state().max_width);
                if width <= 0.0 {
                    let failure = Failure::new(Ending::Failed, "the Hand has not been homed");
                    return Err(failure.advice("First: franka gripper home").into());
                }
                let not = "the fingers did not open to this width";
                let motion = moved(&hand, width, fingers.speed);
                fingers
                    .act(&hand, &fingers.way(&hand, width), motion, not)
                    .await
            }
            Self::Close { fingers } => {
                let hand = fingers.connect().await?;
                let not = "the fingers did not close: an object is between them";
                let motion = moved(&hand, 0.0, fingers.speed);
                fingers
                    .act(&hand, &fingers.way(&hand, 0.0), motion, not)
                    .await
            }
            Self::Grasp {
                fingers,
                width,
                within,
                force,
            } => {
                let hand = fingers.connect().await?;
                let mut grasp = Grasp::new(width, fingers.speed, force);
                grasp.epsilon_inner = within;
                grasp.epsilon_outer = within;
                let way = fingers.way(&hand, width);
                let what = format!("{way}, then grip with {force:.0} N");
                let (width, within) = (width * 1e3, within * 1e3);
                let not = format!(
                    "the fingers hold no object of {width:.1} mm (within \
                    {within:.1} mm)"
                );
                fingers.act(&hand, &what, hand.grasp(grasp), &not).await
            }
            Self::Home { fingers } => {
                let hand = fingers.connect().await?;
                let what = "The fingers close, then open fully";
                let not = "the fingers did not reach both ends of their range";
                fingers.act(&hand, what, hand.homing(), not).await
            }
            Self::Stop { mut fingers } => {
                // A stop needs no confirmation.
                fingers.yes = true;
                let hand = fingers.connect().await?;
                let what = "The fingers stop and release the object";
                let not = "the fingers were not stopped";
                fingers.act(&hand, what, hand.stop(), not).await
            }
        }
    }
}

impl Fingers {
    async fn connect(&self) -> anyhow::Result<Hand> {
        self.which.place()?.connect_hand().await
    }

    fn way(&self, hand: &Hand, width: f64) -> String {
        format!(
            "The fingers move from {:.1} to {:.1} mm, at {:.0} mm/s",
            hand.state().width * 1e3,
            width * 1e3,
            self.speed * 1e3
        )
    }

    /// Asks for consent, moves the fingers, and reports the result. Ctrl-C stops the fingers.
    async fn act(
        &self,
        hand: &Hand,
        what: &str,
        motion: impl Future<Output = Result<bool, GripperError>>,
        not: &str,
    ) -> anyhow::Result<Ending> {
        let place = self.which.place()?;
        let title = format!("{BOLD}gripper: Franka Hand, {place}{BOLD:#}");
        question::ask(&format!("{title}\n{what}."), self.yes).await?;
        let interrupt = interrupted()?;
        let done = tokio::select! {
            biased;
            done = motion => done.map_err(Error::from)?,
            by = interrupt => return Err(stopped(hand, by).await.into()),
        };
        let state = hand.state();
        if !done {
            let message = format!("{not}; the fingers are {:.1} mm apart", state.width * 1e3);
            return Err(Failure::new(Ending::Failed, message).into());
        }
        print(&state, self.output)
    }
}

async fn stopped(hand: &Hand, by: Interruption) -> Failure {
    say(&format!("{by}: stopping the fingers"));
    let why = match timeout(PATIENCE, hand.stop()).await {
        Ok(Ok(true)) => {
            let message = "interrupted: the fingers were stopped and hold nothing";
            return by.failure(message);
        }
        Ok(Ok(false)) => "the Hand refused".to_owned(),
        Ok(Err(error)) => error.to_string(),
        Err(_) => format!("no answer in {} s", PATIENCE.as_secs()),
    };
    Failure::new(
        Ending::Failed,
        format!("the fingers were not stopped: {why}"),
    )
}

/// Moves the fingers. Returns false if the fingers did not reach the width, for example because of
/// an obstacle. The Hand itself would try for minutes.
async fn moved(hand: &Hand, width: f64, speed: f64) -> Result<bool, GripperError> {
    let stuck = async {
        let mut before = hand.state();
        loop {
            tokio::time::sleep(LOOK).await;
            let now = hand.state();
            // The time comes from the Hand's clock, because a Hand that does not report its state
            // may be moving.
            if (now.width - before.width).abs() >= STILL {
                before = now;
            } else if now.message_id.wrapping_sub(before.message_id) >= STUCK_MS {
                break;
            }
        }
    };
    tokio::select! {
        biased;
        arrived = hand.move_to(width, speed) => arrived,
        () = stuck => hand.stop().await.map(|_| false),
    }
}

fn print(state: &State, output: Output) -> anyhow::Result<Ending> {
    output.print(state, || {
        let held = match state.is_grasped {
            true => "holding an object",
            false => "holding nothing",
        };
        let width = state.width * 1e3;
        let most = match state.max_width > 0.0 {
            true => format!(" of {:.1} mm", state.max_width * 1e3),
            false => " (not homed)".into(),
        };
        let temperature = state.temperature;
        format!("fingers {width:.1} mm apart{most}, {held}, {temperature} deg C")
    })
}

/// Time limit for the answer to a stop.
const PATIENCE: Duration = Duration::from_secs(5);

/// Time after which fingers that moved less than [`STILL`] count as blocked.
const STUCK_MS: u32 = 1000;

/// Interval between two checks of the fingers.
const LOOK: Duration = Duration::from_millis(100);

/// Largest change of the width of fingers at rest, `[m]`.
const STILL: f64 = 1e-4;

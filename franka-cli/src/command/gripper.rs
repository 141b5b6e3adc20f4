//! `franka gripper`: the Franka Hand.

use std::future::Future;
use std::pin::pin;

use clap::{Args, Subcommand};
use franka_async::error::GripperError;
use franka_async::gripper::{Grasp, Gripper as Hand, State};
use tokio::time::{Duration, timeout};

use crate::connection::{Place, Which};
use crate::ending::{Ending, Failure};
use crate::interrupt::interrupted;
use crate::output::{BOLD, Output, say};
use crate::question;
use crate::values::positive;

/// Move the fingers of the Franka Hand
///
/// ROBOT is the robot whose Hand it is; a port in an address is that of the Hand.
#[derive(Debug, Subcommand)]
pub(crate) enum Gripper {
    /// Show the width of the fingers, and whether they hold something
    State {
        #[command(flatten)]
        which: Which,
        #[command(flatten)]
        output: Output,
    },
    /// Open the fingers
    Open {
        #[command(flatten)]
        fingers: Fingers,
        /// How wide, metres; as wide as they go by default
        #[arg(long, value_name = "M", value_parser = positive)]
        width: Option<f64>,
    },
    /// Close the fingers, without holding anything
    Close {
        #[command(flatten)]
        fingers: Fingers,
    },
    /// Close the fingers on an object and hold it
    Grasp {
        #[command(flatten)]
        fingers: Fingers,
        /// Width of the object, metres
        #[arg(long, value_name = "M", value_parser = positive)]
        width: f64,
        /// How much wider or narrower it may be, metres
        #[arg(long, value_name = "M", value_parser = positive, default_value = "0.005")]
        within: f64,
        /// Force, newtons
        #[arg(long, value_name = "N", value_parser = positive, default_value = "20")]
        force: f64,
    },
    /// Find how wide the fingers open: once after power-on
    Home {
        #[command(flatten)]
        fingers: Fingers,
    },
    /// Stop the fingers, and let go of what they hold
    Stop {
        #[command(flatten)]
        fingers: Fingers,
    },
}

/// Options of whatever moves the fingers.
#[derive(Debug, Args)]
pub(crate) struct Fingers {
    #[command(flatten)]
    which: Which,
    /// Speed of the fingers, metres per second
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
                let (hand, place) = fingers.connect().await?;
                let width = width.unwrap_or(hand.state().max_width);
                if width <= 0.0 {
                    let failure =
                        Failure::new(Ending::Failed, "the Hand does not know how wide it opens");
                    return Err(failure.advice("First: franka gripper home").into());
                }
                let what = fingers.way(&hand, width);
                let speed = fingers.speed;
                let motion = |hand: Hand| async move { moved(&hand, width, speed).await };
                fingers
                    .act(
                        &hand,
                        &place,
                        &what,
                        motion,
                        "the fingers did not open so far",
                    )
                    .await
            }
            Self::Close { fingers } => {
                let (hand, place) = fingers.connect().await?;
                let what = fingers.way(&hand, 0.0);
                let speed = fingers.speed;
                let motion = |hand: Hand| async move { moved(&hand, 0.0, speed).await };
                fingers
                    .act(
                        &hand,
                        &place,
                        &what,
                        motion,
                        "the fingers did not close: something is between them",
                    )
                    .await
            }
            Self::Grasp {
                fingers,
                width,
                within,
                force,
            } => {
                let (hand, place) = fingers.connect().await?;
                let mut grasp = Grasp::new(width, fingers.speed, force);
                grasp.epsilon_inner = within;
                grasp.epsilon_outer = within;
                let what = format!(
                    "{}, then press with {force:.0} N",
                    fingers.way(&hand, width)
                );
                let motion = |hand: Hand| async move { hand.grasp(grasp).await };
                let not = format!(
                    "nothing of {:.1} mm is held (within {:.1} mm)",
                    width * 1e3,
                    within * 1e3
                );
                fingers.act(&hand, &place, &what, motion, &not).await
            }
            Self::Home { fingers } => {
                let (hand, place) = fingers.connect().await?;
                let what = "The fingers close, and open as wide as they go";
                let motion = |hand: Hand| async move { hand.homing().await };
                fingers
                    .act(
                        &hand,
                        &place,
                        what,
                        motion,
                        "the fingers did not find their ends",
                    )
                    .await
            }
            Self::Stop { fingers } => {
                // Stopping is never asked about.
                let fingers = Fingers {
                    yes: true,
                    ..fingers
                };
                let (hand, place) = fingers.connect().await?;
                let what = "The fingers stop, and let go of what they hold";
                let motion = |hand: Hand| async move { hand.stop().await };
                fingers
                    .act(&hand, &place, what, motion, "the fingers were not stopped")
                    .await
            }
        }
    }
}

impl Fingers {
    async fn connect(&self) -> anyhow::Result<(Hand, Place)> {
        let place = self.which.place()?;
        Ok((place.connect_hand().await?, place))
    }

    fn way(&self, hand: &Hand, width: f64) -> String {
        format!(
            "The fingers go from {:.1} to {:.1} mm, at {:.0} mm/s",
            hand.state().width * 1e3,
            width * 1e3,
            self.speed * 1e3
        )
    }

    /// Asks, lets the fingers do it, and says what came of it. Ctrl-C stops them.
    async fn act<F: Future<Output = Result<bool, GripperError>>>(
        &self,
        hand: &Hand,
        place: &Place,
        what: &str,
        motion: impl FnOnce(Hand) -> F,
        not: &str,
    ) -> anyhow::Result<Ending> {
        let title = format!("{BOLD}gripper: Franka Hand, {place}{BOLD:#}");
        question::ask(&format!("{title}\n{what}."), self.yes).await?;
        let interrupt = interrupted()?;
        let mut motion = pin!(motion(hand.clone()));
        let done = tokio::select! {
            biased;
            done = &mut motion => done,
            () = interrupt => {
                say("Ctrl-C: stopping the fingers");
                let stopped = timeout(PATIENCE, hand.stop()).await;
                return Err(match stopped {
                    Ok(Ok(true)) => Failure::new(
                        Ending::Interrupted,
                        "interrupted: the fingers were stopped, and hold nothing",
                    ),
                    other => Failure::new(
                        Ending::Failed,
                        format!("the fingers were not stopped: {other:?}"),
                    ),
                }.into());
            }
        };
        let done = done.map_err(|error| Failure::new(Ending::Failed, error.to_string()))?;
        let state = hand.state();
        if !done {
            let message = format!("{not}; the fingers are {:.1} mm apart", state.width * 1e3);
            return Err(Failure::new(Ending::Failed, message).into());
        }
        print(&state, self.output)
    }
}

/// Moves the fingers; false if they did not arrive, for instance as something holds them up: the
/// Hand itself would try for minutes.
async fn moved(hand: &Hand, width: f64, speed: f64) -> Result<bool, GripperError> {
    let stuck = async {
        let mut before = hand.state().width;
        loop {
            tokio::time::sleep(STUCK).await;
            let now = hand.state().width;
            if (now - before).abs() < STILL {
                break;
            }
            before = now;
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
            true => "holding something",
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

/// For the answer to a stop.
const PATIENCE: Duration = Duration::from_secs(5);

/// Fingers that come no further than [`STILL`] in this time are held up.
const STUCK: Duration = Duration::from_secs(1);

/// `[m]`.
const STILL: f64 = 1e-4;

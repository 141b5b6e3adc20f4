//! A motion in progress: connection, recording, progress display, and Ctrl-C.

use std::future::Future;
use std::path::PathBuf;
use std::pin::pin;
use std::time::{Duration, Instant};

use clap::Args;
use franka_async::diagnosis::Diagnose;
use franka_async::doctor;
use franka_async::error::IdentifyError;
use franka_async::motion::MotionHandle;
use franka_async::recording::{RecordOptions, RecordStatus, Recorder, Track};
use franka_async::replay::ReplayFailure;
use franka_async::state::RobotState;
use franka_async::{Error, MotionError, Robot};
use indicatif::{ProgressBar, ProgressStyle};

use crate::connection::{Place, Which, check_ready};
use crate::ending::{Ending, Failure};
use crate::interrupt::{Interruption, interrupted};
use crate::output::{Output, say};
use crate::question;
use crate::robots_file::Realtime;

/// Options of all commands that move the arm.
#[derive(Clone, Debug, Args)]
pub(crate) struct Mover {
    #[command(flatten)]
    pub(crate) which: Which,
    #[command(flatten)]
    pub(crate) how: MoverOptions,
}

/// The options of [`Mover`], without the robot.
#[derive(Clone, Debug, Args)]
pub(crate) struct MoverOptions {
    /// Real-time scheduling of the control thread [default: the robot's setting, or enforce]
    #[arg(long, value_enum)]
    realtime: Option<Realtime>,
    /// Also move a robot whose reported pose does not fit its model
    #[arg(long)]
    accept_geometry_error: bool,
    /// Move without asking, for scripts
    #[arg(short, long)]
    pub(crate) yes: bool,
    /// Record every cycle to a new file
    #[arg(long, value_name = "FILE.mcap")]
    pub(crate) record: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) output: Output,
}

/// A connected robot that the command may move.
pub(crate) struct Moving {
    pub(crate) robot: Robot,
    pub(crate) place: Place,
    yes: bool,
    recorder: Option<Recorder>,
}

impl Mover {
    /// Connects to the robot, and checks that it would accept a motion.
    pub(crate) async fn begin(&self) -> anyhow::Result<Moving> {
        self.how.begin(&self.which).await
    }
}

impl MoverOptions {
    /// Connects to the robot, and checks that it would accept a motion.
    pub(crate) async fn begin(&self, which: &Which) -> anyhow::Result<Moving> {
        self.begin_with(which, RecordOptions::default()).await
    }

    /// Like [`Self::begin`], but with these options for the recording.
    pub(crate) async fn begin_with(
        &self,
        which: &Which,
        options: RecordOptions,
    ) -> anyhow::Result<Moving> {
        let place = which.place()?;
        // With this option, an error contains the last second.
        let accepts = self.accept_geometry_error;
        let robot = place.connect(self.realtime, |builder| {
            builder.log_size(1000).accept_geometry_error(accepts)
        });
        let robot = robot.await?;
        check_ready(&robot.state(), &place)?;
        let recorder = match &self.record {
            Some(file) => {
                let recorder = Recorder::to_file(file, options);
                let recorder =
                    recorder.map_err(|error| Failure::new(Ending::Host, error.to_string()))?;
                recorder.attach(&robot, Track::default()).await?;
                Some(recorder)
            }
            None => None,
        };
        Ok(Moving {
            robot,
            place,
            yes: self.yes,
            recorder,
        })
    }
}

impl Moving {
    /// Asks for permission to move the arm. Then checks that the arm has not moved since the
    /// question.
    pub(crate) async fn ask(&self, title: &str, what: &str) -> anyhow::Result<()> {
        let before = self.robot.state();
        let title = question::title(title, self.robot.model().kind(), &self.place);
        question::ask(&format!("{title}\n{what}"), self.yes).await?;
        let now = self.state_from_now().await?;
        check_ready(&now, &self.place)?;
        for (i, (from, to)) in before.q.iter().zip(now.q).enumerate() {
            // A position that is not finite counts as moved.
            let stayed = (to - from).abs() < MOVED;
            if !stayed {
                let message = format!(
                    "joint {} has moved from {from:.3} to {to:.3} rad since the question, \
                     expected an arm at rest. No command was sent.",
                    i + 1
                );
                return Err(Failure::new(Ending::Taken, message).into());
            }
        }
        Ok(())
    }

    async fn state_from_now(&self) -> Result<RobotState, Error> {
        let mut newest = self.robot.state();
        let mut states = self.robot.states();
        // The robot may have sent the first state before this call.
        for _ in 0..2 {
            let before = newest.message_id;
            newest = states.wait_for(|state| state.message_id > before).await?;
        }
        Ok(newest)
    }

    /// Waits for the end of a motion. If its length is known, shows the progress on the terminal.
    /// Ctrl-C and SIGTERM brake the arm.
    pub(crate) async fn drive<T, E: Into<Cause>>(
        &self,
        motion: impl Future<Output = Result<T, E>>,
        length: Option<Length>,
    ) -> anyhow::Result<T> {
        let (bar, begin) = (progress_bar(), Instant::now());
        let mut motion = pin!(motion);
        let mut interrupt = pin!(interrupted()?);
        let mut clock = tokio::time::interval(Duration::from_millis(50));
        let outcome = loop {
            tokio::select! {
                biased;
                outcome = &mut motion => break match outcome {
                    Ok(value) => Ok(value),
                    Err(error) => Err(self.explain(error).await),
                },
                by = &mut interrupt => break Err(self.brake(Some(by)).await),
                _ = clock.tick() => {
                    let gone = length.as_ref().and_then(|length| length.gone(begin));
                    if let Some((part, left)) = gone {
                        bar.set_position((part * 1000.0) as u64);
                        bar.set_message(format!("{:.1} s left", left.as_secs_f64()));
                    }
                }
            }
        };
        bar.finish_and_clear();
        outcome
    }

    /// Brakes the arm, and returns the failure. `by` is the interruption; `None` if the arm
    /// continued to move without one.
    pub(crate) async fn brake(&self, by: Option<Interruption>) -> anyhow::Error {
        say(&by.map_or("braking".into(), |by| format!("{by}: braking")));
        match tokio::time::timeout(PATIENCE, self.robot.stop()).await {
            Ok(Ok(())) => {
                let failure = match by {
                    Some(by) => by.failure("interrupted: the arm was braked and is at rest"),
                    None => Failure::new(Ending::Failed, "the arm was braked and is at rest"),
                };
                failure.into()
            }
            Ok(Err(error)) => self.explain(error).await.context("braking"),
            Err(_) => {
                let seconds = PATIENCE.as_secs();
                let message = format!("the arm still moves after {seconds} s of braking");
                let failure = Failure::new(Ending::Failed, message);
                failure.advice("Press the user stop.").into()
            }
        }
    }

    /// Returns the failure that explains why a motion failed and states the next step.
    pub(crate) async fn explain(&self, error: impl Into<Cause>) -> anyhow::Error {
        let error = match error.into() {
            Cause::Motion(error) => error,
            Cause::Other(text) => return Failure::new(Ending::Failed, text).into(),
        };
        let ending = match &error {
            MotionError::LinkLost { .. } | MotionError::ConnectionClosed { .. } => Ending::NoRobot,
            _ => Ending::Failed,
        };
        let failure = Failure::new(ending, error.to_string()).of(error.party(), error.entry());
        // After missing packets, the text names the causes on this computer. Otherwise it explains
        // why the robot stopped.
        let advice = match doctor::diagnose(&error, self.robot.address().ip()).await {
            Some(diagnosis) => Some(diagnosis.to_string()),
            None => error.diagnose().map(|diagnosis| diagnosis.to_string()),
        };
        let recover = match error.control().is_some_and(|error| error.is_reflex()) {
            true => "After you have removed the cause: franka recover",
            false => "",
        };
        let advice = advice.unwrap_or_default();
        let advice = format!("{}\n{recover}", advice.trim_end());
        match advice.trim() {
            "" => failure.into(),
            advice => failure.advice(advice).into(),
        }
    }

    /// Closes the connection and ends the recording, after a success or a failure.
    pub(crate) async fn end<T>(self, outcome: anyhow::Result<T>) -> anyhow::Result<T> {
        self.robot.shutdown().await;
        let Some(recorder) = self.recorder else {
            return outcome;
        };
        let finished = tokio::task::spawn_blocking(|| recorder.finish()).await?;
        if let Ok(status) = &finished {
            say(&recorded(status));
        }
        let value = outcome?;
        finished?;
        Ok(value)
    }
}

/// Source of a motion's duration.
pub(crate) enum Length {
    /// The motion itself, which reports its progress.
    Of(MotionHandle),
    /// A known or approximate duration.
    About(Duration),
}

impl Length {
    /// Returns the completed share of a motion, in `[0, 1]`, and the remaining time; `None` if they
    /// are unknown.
    fn gone(&self, begin: Instant) -> Option<(f64, Duration)> {
        match self {
            Self::Of(handle) => {
                let progress = handle.progress()?;
                Some((progress.fraction(), progress.remaining))
            }
            Self::About(length) => {
                let elapsed = begin.elapsed();
                let part = elapsed.as_secs_f64() / length.as_secs_f64();
                Some((part.min(1.0), length.saturating_sub(elapsed)))
            }
        }
    }
}

/// Returns a line of text about a recording.
pub(crate) fn recorded(status: &RecordStatus) -> String {
    let file = status.files.first().map(|file| file.display().to_string());
    format!(
        "recorded {} cycles in {}, {} dropped",
        status.cycles,
        file.unwrap_or_default(),
        status.dropped
    )
}

/// Reason why a motion, or a series of motions, failed.
pub(crate) enum Cause {
    Motion(MotionError),
    Other(String),
}

impl From<MotionError> for Cause {
    fn from(error: MotionError) -> Self {
        Self::Motion(error)
    }
}

impl From<IdentifyError> for Cause {
    fn from(error: IdentifyError) -> Self {
        match error {
            IdentifyError::Motion(error) => Self::Motion(error),
            other => Self::Other(other.to_string()),
        }
    }
}

impl From<ReplayFailure> for Cause {
    fn from(error: ReplayFailure) -> Self {
        match error {
            ReplayFailure::Motion(error) => Self::Motion(error),
            other => Self::Other(other.to_string()),
        }
    }
}

/// Returns a progress bar with 1000 steps. The bar is hidden if standard error is not a terminal.
pub(crate) fn progress_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}");
    ProgressBar::new(1000).with_style(style.expect("a template"))
}

/// Waits for a future that takes about `length`, and shows its progress on the terminal.
pub(crate) async fn shown<T>(what: &str, length: Duration, work: impl Future<Output = T>) -> T {
    let (bar, length, begin) = (progress_bar(), Length::About(length), Instant::now());
    bar.set_message(what.to_owned());
    let mut work = pin!(work);
    let mut clock = tokio::time::interval(Duration::from_millis(100));
    let result = loop {
        tokio::select! {
            biased;
            result = &mut work => break result,
            _ = clock.tick() => {
                if let Some((part, _)) = length.gone(begin) {
                    bar.set_position((part * 1000.0) as u64);
                }
            }
        }
    };
    bar.finish_and_clear();
    result
}

/// Runs a function whose duration is unknown, and shows on the terminal that the program is
/// working.
pub(crate) fn while_turning<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let bar = ProgressBar::new_spinner().with_message(what.to_owned());
    bar.enable_steady_tick(Duration::from_millis(100));
    let result = work();
    bar.finish_and_clear();
    result
}

/// Largest distance by which a joint may have moved since the question, `[rad]`.
const MOVED: f64 = 0.01;

/// Time limit for braking. Braking usually takes a quarter of a second.
const PATIENCE: Duration = Duration::from_secs(5);

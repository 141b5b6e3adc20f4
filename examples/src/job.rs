//! Motions as jobs: they belong to a separate task, and not to the request that started them.

use std::time::Duration;

use franka_async::motion::MotionHandle;
use franka_async::{Motion, MotionError};
use serde_json::{Value, json};
use tokio::sync::watch;
use tokio_stream::wrappers::WatchStream;
use tokio_stream::{Stream, StreamExt};

/// A motion that runs until it ends or is cancelled, even if its client disconnects. Dropping a
/// `Job` does not end it.
#[derive(Clone, Debug)]
pub struct Job {
    progress: watch::Receiver<Progress>,
    motion: MotionHandle,
}

/// The newest event of a job.
#[derive(Clone, Debug)]
pub struct Progress {
    /// Number of the event within this job. A reconnecting client sends the last number it
    /// received.
    pub number: u64,
    /// The stage of the job.
    pub stage: Stage,
}

/// The stage of a job.
#[derive(Clone, Debug)]
pub enum Stage {
    /// The robot has not begun the motion.
    Queued,
    /// The robot moves.
    Moving {
        /// Share of the motion's time that has passed, from 0 to 1.
        fraction: f64,
        /// Time until the arm reaches the target, where it then settles.
        remaining: Duration,
    },
    /// The arm is at rest at the target.
    Arrived {
        /// Duration of the motion.
        duration: Duration,
    },
    /// The motion ended before its target: it was refused or cancelled, or failed.
    Failed(MotionError),
}

impl Job {
    /// Starts `motion`.
    pub fn start(motion: Motion) -> Self {
        let queued = Progress {
            number: 0,
            stage: Stage::Queued,
        };
        let (sender, progress) = watch::channel(queued);
        let handle = motion.handle();
        // The task owns the motion: no other code can drop it, and so brake the arm.
        tokio::spawn(run(motion, sender));
        Self {
            progress,
            motion: handle,
        }
    }

    /// Brakes the arm. The job fails as stopped when the arm is at rest.
    pub fn cancel(&self) {
        self.motion.cancel();
    }

    /// Returns the newest event.
    pub fn newest(&self) -> Progress {
        self.progress.borrow().clone()
    }

    /// Resolves when the robot has begun the motion.
    ///
    /// # Errors
    /// The reason for a refusal.
    ///
    /// # Cancel safety
    /// The job continues if the future is dropped.
    pub async fn begun(&self) -> Result<(), MotionError> {
        let mut progress = self.progress.clone();
        let begun = |progress: &Progress| !matches!(progress.stage, Stage::Queued);
        match progress.wait_for(begun).await.as_deref() {
            Ok(Progress {
                stage: Stage::Failed(error),
                ..
            }) => Err(error.clone()),
            _ => Ok(()),
        }
    }

    /// Returns the events from now on, beginning with the newest one unless it is `seen`; ends with
    /// the job.
    pub fn events(&self, seen: Option<u64>) -> impl Stream<Item = Progress> + Send + use<> {
        let events = WatchStream::new(self.progress.clone());
        events.filter(move |progress| Some(progress.number) > seen)
    }
}

impl Stage {
    /// True if it is the last event.
    pub fn is_last(&self) -> bool {
        matches!(self, Self::Arrived { .. } | Self::Failed(_))
    }

    /// Returns its name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Queued => "queued",
            Self::Moving { .. } => "moving",
            Self::Arrived { .. } => "arrived",
            Self::Failed(_) => "failed",
        }
    }

    /// Returns all its data for a client.
    pub fn to_json(&self) -> Value {
        let mut json = match self {
            Self::Queued => json!({}),
            Self::Moving {
                fraction,
                remaining,
            } => json!({ "fraction": fraction, "remaining": remaining.as_secs_f64() }),
            Self::Arrived { duration } => json!({ "seconds": duration.as_secs_f64() }),
            Self::Failed(error) => json!({ "text": error.to_string(), "party": error.party() }),
        };
        json["stage"] = self.name().into();
        json
    }
}

async fn run(motion: Motion, progress: watch::Sender<Progress>) {
    let tell = |stage| {
        progress.send_modify(|newest| {
            *newest = Progress {
                number: newest.number + 1,
                stage,
            }
        });
    };
    let handle = motion.handle();
    let mut moving = motion.into_future();
    let mut clock = tokio::time::interval(Duration::from_millis(50));
    let outcome = loop {
        tokio::select! {
            outcome = &mut moving => break outcome,
            _ = clock.tick() => if let Some(progress) = handle.progress() {
                let (fraction, remaining) = (progress.fraction(), progress.remaining);
                tell(Stage::Moving { fraction, remaining });
            },
        }
    };
    tell(match outcome {
        Ok(report) => Stage::Arrived {
            duration: report.duration,
        },
        Err(error) => Stage::Failed(error),
    });
}

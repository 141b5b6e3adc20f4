//! Motions as jobs: they belong to a task of their own, and not to the request that began them.

use std::time::Duration;

use franka_async::motion::MotionHandle;
use franka_async::{Motion, MotionError};
use serde_json::{Value, json};
use tokio::sync::watch;
use tokio_stream::wrappers::WatchStream;
use tokio_stream::{Stream, StreamExt};

/// A motion that runs until it ends or is cancelled, whoever goes away meanwhile. Dropping a `Job`
/// does not end it.
#[derive(Clone, Debug)]
pub struct Job {
    progress: watch::Receiver<Progress>,
    motion: MotionHandle,
}

/// The newest event of a job.
#[derive(Clone, Debug)]
pub struct Progress {
    /// Counts the events of this job. A client that comes back says which one it has seen.
    pub number: u64,
    /// What has become of the job.
    pub stage: Stage,
}

/// How far a job has come.
#[derive(Clone, Debug)]
pub enum Stage {
    /// The robot has not begun the motion.
    Queued,
    /// The robot moves.
    Moving {
        /// The share of its time that has passed, from 0 to 1.
        fraction: f64,
        /// Until the arm is at the target, where it then settles.
        remaining: Duration,
    },
    /// The arm rests at the target.
    Arrived {
        /// How long the motion took.
        duration: Duration,
    },
    /// The motion ended short of its target: it was refused or cancelled, or failed.
    Failed(MotionError),
}

impl Job {
    /// Begins `motion`.
    pub fn start(motion: Motion) -> Self {
        let queued = Progress {
            number: 0,
            stage: Stage::Queued,
        };
        let (sender, progress) = watch::channel(queued);
        let handle = motion.handle();
        // The task owns the motion: nobody else can drop it, and so brake the arm.
        tokio::spawn(run(motion, sender));
        Self {
            progress,
            motion: handle,
        }
    }

    /// Brakes the arm. The job fails as stopped when it rests.
    pub fn cancel(&self) {
        self.motion.cancel();
    }

    /// The newest event.
    pub fn newest(&self) -> Progress {
        self.progress.borrow().clone()
    }

    /// Resolves when the robot has begun the motion.
    ///
    /// # Errors
    /// Why it was refused.
    ///
    /// # Cancel safety
    /// The job goes on if the future is dropped.
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

    /// The events from now on, beginning with the newest one unless it is `seen`; ends with the
    /// job.
    pub fn events(&self, seen: Option<u64>) -> impl Stream<Item = Progress> + Send + use<> {
        let events = WatchStream::new(self.progress.clone());
        events.filter(move |progress| Some(progress.number) > seen)
    }
}

impl Stage {
    /// True if nothing comes after it.
    pub fn is_last(&self) -> bool {
        matches!(self, Self::Arrived { .. } | Self::Failed(_))
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Queued => "queued",
            Self::Moving { .. } => "moving",
            Self::Arrived { .. } => "arrived",
            Self::Failed(_) => "failed",
        }
    }

    /// All of it, for a client.
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

//! Recordings that viewers start and end, in a folder of the server.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use franka_async::Robot;
use franka_async::connection::CancellationToken;
use franka_async::gripper::Gripper;
use franka_async::recording::{HostTime, RecordOptions, RecordStatus, Recorder, Track};
use serde::Serialize;
use tokio::sync::watch;
use tokio::time::{MissedTickBehavior, interval};

/// The recordings of a server. Only one recording can run at a time.
pub(crate) struct Recordings {
    folder: PathBuf,
    writing: Writing,
    end: Mutex<CancellationToken>,
    progress: watch::Sender<Option<Progress>>,
}

/// The current recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Progress {
    /// Name of the recording's file in the folder.
    file: String,
    cycles: u64,
    dropped: u64,
    bytes: u64,
}

impl Recordings {
    pub(crate) fn new(folder: PathBuf, writing: Writing) -> Self {
        Self {
            folder,
            writing,
            end: Mutex::default(),
            progress: watch::Sender::default(),
        }
    }

    /// Returns the current recording, if any.
    pub(crate) fn progress(&self) -> Option<Progress> {
        self.progress.borrow().clone()
    }

    /// Ends the current recording, if any.
    pub(crate) fn end(&self) {
        self.lock().cancel();
    }

    /// Records the robot and its gripper, if it has one. The recording ends through [`Self::end`],
    /// after [`LONGEST`], when the connection ends, or with an error. The future then resolves with
    /// a line of text about the recording. If another recording is running, the future has no
    /// effect and resolves with `None`.
    pub(crate) async fn record(
        &self,
        robot: &Robot,
        gripper: Option<&Gripper>,
    ) -> Option<Result<String, String>> {
        let time = HostTime::now().to_string().replace(['-', ':'], "");
        let progress = Progress {
            file: format!("{time}.mcap"),
            cycles: 0,
            dropped: 0,
            bytes: 0,
        };
        let file = progress.file.clone();
        let end = {
            let mut newest = self.lock();
            if self.progress.borrow().is_some() {
                return None;
            }
            *newest = CancellationToken::new();
            self.progress.send_replace(Some(progress));
            newest.clone()
        };
        let _one = self.writing.begin();
        let recorded = self.write(robot, gripper, &file, end).await;
        self.progress.send_replace(None);
        Some(recorded.map(|status| {
            format!(
                "Recorded {} cycles in {file}, {} dropped",
                status.cycles, status.dropped
            )
        }))
    }

    async fn write(
        &self,
        robot: &Robot,
        gripper: Option<&Gripper>,
        file: &str,
        end: CancellationToken,
    ) -> Result<RecordStatus, String> {
        let path = self.folder.join(file);
        let begin = move || Recorder::to_file(path, RecordOptions::default());
        let recorder = off_the_runtime(begin).await?;
        let recorder = recorder.map_err(|error| error.to_string())?;
        let attached = recorder.attach(robot, Track::default()).await;
        attached.map_err(|error| error.to_string())?;
        if let Some(gripper) = gripper {
            let attached = recorder.attach_gripper(gripper, "");
            attached.map_err(|error| error.to_string())?;
        }
        let watch = async {
            let mut clock = interval(PROGRESS);
            clock.set_missed_tick_behavior(MissedTickBehavior::Skip);
            loop {
                clock.tick().await;
                let status = recorder.status();
                self.progress.send_modify(|progress| {
                    if let Some(progress) = progress {
                        progress.cycles = status.cycles;
                        progress.dropped = status.dropped;
                        progress.bytes = status.bytes;
                    }
                });
                if status.error.is_some() {
                    break;
                }
            }
        };
        tokio::select! {
            () = end.cancelled() => {}
            _ = robot.closed() => {}
            () = tokio::time::sleep(LONGEST) => {}
            () = watch => {}
        }
        let finished = off_the_runtime(move || recorder.finish()).await?;
        finished.map_err(|error| error.to_string())
    }

    fn lock(&self) -> MutexGuard<'_, CancellationToken> {
        self.end.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Number of recordings, over all servers, that are not completely written.
#[derive(Clone, Debug, Default)]
pub(crate) struct Writing(Arc<watch::Sender<usize>>);

impl Writing {
    /// Counts one recording as unfinished until the returned value is dropped.
    fn begin(&self) -> impl Drop + use<> {
        struct One(Writing);
        impl Drop for One {
            fn drop(&mut self) {
                self.0.0.send_modify(|count| *count -= 1);
            }
        }
        self.0.send_modify(|count| *count += 1);
        One(self.clone())
    }

    /// Waits until all recordings are written.
    pub(crate) async fn none(self) {
        // The sender lives as long as `self`.
        let _ = self.0.subscribe().wait_for(|count| *count == 0).await;
    }
}

/// Runs a function that waits for the disk, and does not delay other tasks.
async fn off_the_runtime<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, String> {
    let done = tokio::task::spawn_blocking(work).await;
    done.map_err(|error| error.to_string())
}

/// Longest duration of a recording. The limit is necessary because closing a page does not end its
/// recording.
const LONGEST: Duration = Duration::from_secs(3600);

/// Interval between two updates of the progress.
const PROGRESS: Duration = Duration::from_millis(200);

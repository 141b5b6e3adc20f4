//! `franka record`: records a robot.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
#[cfg(feature = "foxglove")]
use franka_async::recording::Live;
use franka_async::recording::{BlackBox, RecordOptions, Recorder, Track};
use indicatif::ProgressBar;
use serde_json::json;

use crate::connection::Which;
use crate::ending::{Ending, Failure};
use crate::interrupt::interrupted;
use crate::motion::recorded;
use crate::output::{Output, say};
use crate::values::seconds;

/// Record a robot that this program does not move
///
/// Records every state until Ctrl-C, for instance while you guide the arm or use Desk. Commands
/// that move the arm have --record.
#[derive(Debug, Args)]
pub(crate) struct Record {
    /// New file; Foxglove and Rerun can open it
    #[arg(value_name = "FILE.mcap")]
    file: PathBuf,
    #[command(flatten)]
    which: Which,
    /// End after this many seconds
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    seconds: Option<Duration>,
    /// Folder for the last seconds before each incident
    #[arg(long, value_name = "FOLDER")]
    black_box: Option<PathBuf>,
    /// Stream live to Foxglove on this local address [default: 127.0.0.1:8765]
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1)]
    live: Option<Option<SocketAddr>>,
    #[command(flatten)]
    output: Output,
}

impl Record {
    pub(super) async fn run(self) -> anyhow::Result<Ending> {
        #[cfg(not(feature = "foxglove"))]
        if self.live.is_some() {
            return Err(Failure::without("--live", "foxglove").into());
        }
        let (robot, place) = self.which.connect().await?;
        let mut interrupt = std::pin::pin!(interrupted()?);
        let options = RecordOptions {
            black_box: self.black_box.map(BlackBox::new),
            ..RecordOptions::default()
        };
        let recorder = Recorder::to_file(&self.file, options);
        let recorder = recorder.map_err(|error| Failure::new(Ending::Host, error.to_string()))?;
        #[cfg(feature = "foxglove")]
        if let Some(address) = self.live {
            let mut live = Live::default();
            live.address = address.unwrap_or(live.address);
            let served = recorder.serve(&live);
            let address = served.map_err(|error| Failure::new(Ending::Host, error.to_string()))?;
            say(&format!("Foxglove can watch at ws://{address}"));
        }
        recorder.attach(&robot, Track::default()).await?;
        say(&format!(
            "recording {place} to {}; Ctrl-C ends",
            self.file.display()
        ));
        let (bar, begin) = (ProgressBar::new_spinner(), Instant::now());
        let mut clock = tokio::time::interval(Duration::from_millis(100));
        let lost = loop {
            tokio::select! {
                _ = &mut interrupt => break None,
                reason = robot.closed() => break Some(reason),
                _ = clock.tick() => {
                    let elapsed = begin.elapsed();
                    if self.seconds.is_some_and(|end| elapsed >= end) {
                        break None;
                    }
                    let cycles = recorder.status().cycles;
                    bar.set_message(format!("{:.1} s, {cycles} cycles", elapsed.as_secs_f64()));
                }
            }
        };
        bar.finish_and_clear();
        robot.shutdown().await;
        let status = tokio::task::spawn_blocking(|| recorder.finish()).await?;
        let status = status.map_err(|error| Failure::new(Ending::Host, error.to_string()))?;
        let value = json!({
            "files": status.files,
            "black_boxes": status.black_boxes,
            "cycles": status.cycles,
            "dropped": status.dropped,
        });
        self.output.print(&value, || recorded(&status))?;
        match lost {
            None => Ok(Ending::Done),
            Some(reason) => {
                let message = format!("the link to the robot at {place} is lost: {reason}");
                Err(Failure::new(Ending::NoRobot, message).into())
            }
        }
    }
}

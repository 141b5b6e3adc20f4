//! `franka export`: exports recordings as tables, and as datasets for training.

use std::convert::Infallible;
use std::error::Error;
use std::io;
#[cfg(feature = "export")]
use std::path::Path;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use clap::Args;
#[cfg(feature = "export")]
use franka_async::export::lerobot::{Action, Dataset, DatasetOptions};
#[cfg(feature = "export")]
use franka_async::export::write_parquet;
use franka_async::export::{Columns, ExportError, NewFile, write_csv};
#[cfg(feature = "export")]
use franka_async::model::RobotKind;
use franka_async::recording::Cycle;
#[cfg(feature = "export")]
use franka_async::recording::{Episode, RobotRecording, Sample, Samples};
use serde_json::json;

use super::explain::{Recorded, Source};
use crate::ending::{Ending, Failure};
use crate::interrupt::{Interruption, interrupted};
use crate::motion::while_turning;
use crate::output::Output;

/// Export a recording as tables, or as a dataset for training
///
/// FILE is a recording, or a table of libfranka's logToCSV. Tables have one row per cycle. A
/// dataset has the episodes of the recording, in LeRobot's layout. Existing files are never
/// replaced. Ctrl-C deletes incomplete output.
#[derive(Debug, Args)]
#[group(id = "to", required = true, multiple = true, args = ["csv", "parquet", "lerobot"])]
pub(crate) struct Export {
    #[command(flatten)]
    recorded: Recorded,
    /// Write a CSV table, with a line of units
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Write a Parquet table
    #[arg(long, value_name = "FILE.parquet")]
    parquet: Option<PathBuf>,
    /// Columns of the tables [default: all]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    columns: Vec<String>,
    /// Add the episodes to this dataset; it is created if missing
    #[arg(long, value_name = "FOLDER")]
    lerobot: Option<PathBuf>,
    /// Names of the episodes to add [default: all]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    episodes: Vec<String>,
    /// Frames per second of the dataset
    #[arg(long, value_name = "HZ", default_value_t = 30, value_parser = clap::value_parser!(u16).range(1..=1000))]
    fps: u16,
    /// Omit the gripper from the dataset
    #[arg(long)]
    no_gripper: bool,
    /// Use measured positions as actions (for hand-guided demonstrations)
    #[arg(long)]
    measured: bool,
    #[command(flatten)]
    output: Output,
}

impl Export {
    pub(super) fn run(self) -> anyhow::Result<Ending> {
        #[cfg(not(feature = "export"))]
        for (option, is_given) in [
            ("--parquet", self.parquet.is_some()),
            ("--lerobot", self.lerobot.is_some()),
        ] {
            if is_given {
                return Err(Failure::without(option, "export").into());
            }
        }
        let stop = Stop::begin()?;
        self.export(&stop).map_err(|error| match stop.by() {
            Some(by) => by.failure("interrupted: the export is not complete").into(),
            None => error,
        })
    }

    fn export(self, stop: &Stop) -> anyhow::Result<Ending> {
        #[cfg_attr(not(feature = "export"), expect(unused_mut))]
        let mut dataset: Option<(usize, u64)> = None;
        let rows = match self.recorded.open_any()? {
            Source::Recording(opened) => {
                let robot = opened.recording.robot(&opened.name)?;
                let rows = self.write_tables(|| robot.cycles(), &Columns::all(), stop)?;
                #[cfg(feature = "export")]
                if let Some(folder) = &self.lerobot {
                    dataset = Some(self.add_to_dataset(
                        folder,
                        &robot,
                        opened.model.model.kind(),
                        stop,
                    )?);
                }
                rows
            }
            Source::Log(file) => {
                let path = self.recorded.file.display();
                if self.lerobot.is_some() {
                    let message = format!("{path} is a log of libfranka: it has no episodes");
                    return Err(Failure::usage(message).into());
                }
                if file.log.is_empty() {
                    let message = format!("{path} has the text of an exception, expected a table");
                    return Err(Failure::usage(message).into());
                }
                let cycles = || file.cycles().map(Ok::<_, Infallible>);
                self.write_tables(cycles, &Columns::of_log(), stop)?
            }
        };
        let (episodes, frames) = dataset.unzip();
        let value = json!({ "rows": rows, "episodes": episodes, "frames": frames });
        self.output.print(&value, || {
            let tables = rows.map(|rows| format!("{rows} rows\n"));
            let dataset = episodes.zip(frames);
            let dataset =
                dataset.map(|(episodes, frames)| format!("{episodes} episodes, {frames} frames\n"));
            tables.into_iter().chain(dataset).collect()
        })
    }

    /// Writes the requested tables with the selected columns, and returns the number of rows.
    fn write_tables<E, I>(
        &self,
        cycles: impl Fn() -> I,
        columns: &Columns,
        stop: &Stop,
    ) -> anyhow::Result<Option<u64>>
    where
        E: Error + Send + Sync + 'static,
        I: Iterator<Item = Result<Cycle, E>>,
    {
        let columns = match self.columns.is_empty() {
            true => columns.clone(),
            false => columns
                .choose(self.columns.iter().map(String::as_str))
                .map_err(|error| Failure::usage(error.to_string()))?,
        };
        let mut rows = None;
        if let Some(path) = &self.csv {
            let write = || {
                let mut file = NewFile::create(path)?;
                let rows = write_csv(stop.until_asked(cycles()), &columns, true, &mut file)?;
                file.finish()?;
                Ok(rows)
            };
            rows = Some(while_turning("writing the table", write).map_err(of_file)?);
        }
        #[cfg(feature = "export")]
        if let Some(path) = &self.parquet {
            let write = || write_parquet(stop.until_asked(cycles()), &columns, path);
            rows = Some(while_turning("writing the table", write).map_err(of_file)?);
        }
        Ok(rows)
    }

    /// Adds the selected episodes to a dataset, and returns the numbers of episodes and frames.
    #[cfg(feature = "export")]
    fn add_to_dataset(
        &self,
        folder: &Path,
        robot: &RobotRecording<'_>,
        kind: RobotKind,
        stop: &Stop,
    ) -> anyhow::Result<(usize, u64)> {
        let kind = match kind {
            RobotKind::Fer => "franka_fer",
            _ => "franka_fr3",
        };
        let mut options = DatasetOptions::new(kind).fps(self.fps);
        options = options.gripper(!self.no_gripper);
        if self.measured {
            options = options.action(Action::Measured);
        }
        let mut found = Episode::of(robot.events())?;
        if found.is_empty() {
            let message = format!("{} has no finished episode", self.recorded.file.display());
            let failure = Failure::new(Ending::Failed, message);
            return Err(failure
                .advice("A program marks them while it records: Recorder::begin_episode and end_episode.")
                .into());
        }
        if !self.episodes.is_empty() {
            found = Episode::named(found, &self.episodes)
                .map_err(|error| Failure::usage(error.to_string()))?;
        }
        let mut dataset = match folder.join("meta").exists() {
            true => Dataset::open(folder, options)?,
            false => Dataset::create(folder, options)?,
        };
        let mut count = 0;
        for episode in &found {
            let part = robot.from(episode.begin).to(episode.end);
            let samples = Samples::new(part.cycles(), robot.to(episode.end).gripper_states());
            let samples: Vec<Sample> = stop.until_asked(samples).collect::<Result<_, _>>()?;
            let add = || dataset.add_episode(&episode.task, episode.success, samples);
            let added = while_turning("adding an episode", add);
            count += added.map_err(|error| {
                let message = format!("{:?}: {error}", episode.name);
                Failure::new(Ending::Failed, message).advice(
                    "--measured uses measured positions, --no-gripper omits the gripper, and \
                     --episodes chooses other episodes.",
                )
            })?;
        }
        dataset.finish()?;
        Ok((found.len(), count))
    }
}

/// Ends an export on Ctrl-C. The incomplete output is then deleted, as after any other error.
struct Stop(Arc<OnceLock<Interruption>>);

impl Stop {
    fn begin() -> io::Result<Self> {
        let by = Arc::<OnceLock<Interruption>>::default();
        let (interrupt, to) = (interrupted()?, by.clone());
        tokio::spawn(async move {
            // Only the first signal counts.
            let _ = to.set(interrupt.await);
        });
        Ok(Self(by))
    }

    fn by(&self) -> Option<Interruption> {
        self.0.get().copied()
    }

    /// Returns the items. After Ctrl-C, the next item is an error.
    fn until_asked<T, E: Error + Send + Sync + 'static>(
        &self,
        items: impl Iterator<Item = Result<T, E>>,
    ) -> impl Iterator<Item = io::Result<T>> {
        items.map(|item| match self.by() {
            Some(_) => Err(io::ErrorKind::Interrupted.into()),
            None => item.map_err(io::Error::other),
        })
    }
}

pub(super) fn of_file(error: ExportError) -> anyhow::Error {
    match error {
        ExportError::Exists { .. } | ExportError::Io { .. } => {
            Failure::new(Ending::Host, error.to_string()).into()
        }
        _ => error.into(),
    }
}

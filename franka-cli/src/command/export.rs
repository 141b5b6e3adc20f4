//! `franka export`: recordings as tables, and as datasets for training.

use std::convert::Infallible;
use std::error::Error;
use std::fs::File;
#[cfg(feature = "export")]
use std::path::Path;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
#[cfg(feature = "export")]
use franka_async::export::lerobot::{Action, Dataset, DatasetOptions};
#[cfg(feature = "export")]
use franka_async::export::write_parquet;
use franka_async::export::{Columns, write_csv};
#[cfg(feature = "export")]
use franka_async::model::RobotKind;
use franka_async::recording::Cycle;
#[cfg(feature = "export")]
use franka_async::recording::{Episode, RobotRecording, Sample, Samples};
use serde_json::json;

use super::explain::{Recorded, Source};
use crate::ending::{Ending, Failure};
use crate::motion::while_turning;
use crate::output::Output;

/// Export a recording as tables, or as a dataset for training
///
/// FILE is a recording, or a table of libfranka's logToCSV. Tables have a row per cycle; a dataset
/// has the episodes of the recording, in the layout of LeRobot.
#[derive(Debug, Args)]
#[group(id = "to", required = true, multiple = true, args = ["csv", "parquet", "lerobot"])]
pub(crate) struct Export {
    #[command(flatten)]
    recorded: Recorded,
    /// Write a table as comma-separated text, with a line of units
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Write a table as Parquet
    #[arg(long, value_name = "FILE.parquet")]
    parquet: Option<PathBuf>,
    /// Columns of the tables; all by default
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    columns: Vec<String>,
    /// Add the episodes to a dataset, a new one if there is none
    #[arg(long, value_name = "FOLDER")]
    lerobot: Option<PathBuf>,
    /// Episodes of the dataset, by their names; all by default
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    episodes: Vec<String>,
    /// Frames per second of the dataset
    #[arg(long, value_name = "HZ", default_value_t = 30, value_parser = clap::value_parser!(u16).range(1..=1000))]
    fps: u16,
    /// Leave the gripper out of the dataset
    #[arg(long)]
    no_gripper: bool,
    /// Take where the arm was for its actions: for demonstrations by hand
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
        #[cfg_attr(not(feature = "export"), expect(unused_mut))]
        let mut dataset: Option<(usize, u64)> = None;
        #[cfg_attr(not(feature = "export"), expect(unused_variables))]
        let rows = match self.recorded.open_any()? {
            Source::Recording(recording, name, model) => {
                let robot = recording.robot(&name)?;
                let rows = self.write_tables(|| robot.cycles(), &Columns::all())?;
                #[cfg(feature = "export")]
                if let Some(folder) = &self.lerobot {
                    dataset = Some(self.add_to_dataset(folder, &robot, model.kind())?);
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
                    let message = format!("{path} has the text of an exception, and no table");
                    return Err(Failure::usage(message).into());
                }
                let cycles = || file.cycles().map(Ok::<_, Infallible>);
                self.write_tables(cycles, &Columns::of_log())?
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

    /// Writes the tables that were asked for, of the chosen ones of these columns; returns the
    /// number of rows.
    fn write_tables<E, I>(
        &self,
        cycles: impl Fn() -> I,
        columns: &Columns,
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
            let file = File::create_new(path);
            let file = file.with_context(|| format!("writing {}", path.display()))?;
            let write = || write_csv(cycles(), &columns, true, file);
            rows = Some(while_turning("writing the table", write)?);
        }
        #[cfg(feature = "export")]
        if let Some(path) = &self.parquet {
            let write = || write_parquet(cycles(), &columns, path);
            rows = Some(while_turning("writing the table", write)?);
        }
        Ok(rows)
    }

    /// Adds the chosen episodes to a dataset, and returns how many episodes and frames.
    #[cfg(feature = "export")]
    fn add_to_dataset(
        &self,
        folder: &Path,
        robot: &RobotRecording<'_>,
        kind: RobotKind,
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
            let message = format!(
                "{} has no episode that has ended",
                self.recorded.file.display()
            );
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
            let samples: Vec<Sample> = samples.collect::<Result<_, _>>()?;
            let add = || dataset.add_episode(&episode.task, episode.success, samples);
            let added = while_turning("adding an episode", add);
            count += added.map_err(|error| {
                let message = format!("{:?}: {error}", episode.name);
                Failure::new(Ending::Failed, message).advice(
                    "--measured takes where the arm was; --no-gripper leaves the gripper out; \
                     --episodes chooses others.",
                )
            })?;
        }
        dataset.finish()?;
        Ok((found.len(), count))
    }
}

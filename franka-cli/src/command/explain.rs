//! `franka explain`: why a recorded motion ended.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::Context as _;
use clap::Args;
use franka_async::explain::Explanation;
use franka_async::model::Model;
use franka_async::recording::{HostTime, Recording};

use crate::ending::{Ending, Failure};
use crate::motion::while_turning;
use crate::output::{Output, say};

/// Say why a recorded motion ended, and where the arm was touched
///
/// Of several the newest that the robot stopped, a guard gave up or a lost link ended.
#[derive(Debug, Args)]
pub(crate) struct Explain {
    #[command(flatten)]
    recorded: Recorded,
    /// Explain an earlier end of a motion: 1 is the one before the newest
    #[arg(long, value_name = "N", default_value_t = 0)]
    earlier: u64,
    /// Draw the last second to a file
    #[arg(long, value_name = "FILE.svg")]
    figure: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
}

/// A robot of a recording.
#[derive(Debug, Args)]
pub(crate) struct Recorded {
    /// The recording
    #[arg(value_name = "FILE.mcap")]
    pub(super) file: PathBuf,
    /// Which robot of the recording; needed if it has several
    #[arg(long, value_name = "NAME")]
    of: Option<String>,
}

impl Recorded {
    /// Opens the recording; returns it with the name and the model of the robot.
    pub(super) fn open(&self) -> anyhow::Result<(Recording, String, &'static Model)> {
        let recording = Recording::open(&self.file);
        let recording = recording.map_err(|error| Failure::new(Ending::Host, error.to_string()))?;
        if let Some(damage) = recording.damage() {
            say(&format!("{} ends early: {damage}", self.file.display()));
        }
        let robots = recording.robots();
        let names: Vec<&str> = robots.iter().map(|robot| robot.name.as_str()).collect();
        let robot = match (&self.of, robots) {
            (None, [only]) => Some(only),
            (Some(name), robots) => robots.iter().find(|robot| robot.name == *name),
            (None, _) => None,
        };
        let robot = robot.ok_or_else(|| {
            let message = format!("which robot of {}?", self.file.display());
            Failure::usage(message).advice(format!("--of one of {names:?}"))
        })?;
        let kind = robot.kind.with_context(|| {
            format!("{} does not say which robot it is of", self.file.display())
        })?;
        let name = robot.name.clone();
        Ok((recording, name, Model::of(kind)))
    }
}

impl Explain {
    pub(super) fn run(self) -> anyhow::Result<Ending> {
        let (recording, name, model) = self.recorded.open()?;
        let robot = recording.robot(&name)?;
        let explain = |until| Explanation::of_recording(&robot.to(until), model);
        let explain = |until| while_turning("looking at every cycle", || explain(until));
        let newest = explain(HostTime::from_nanos(u64::MAX));
        if self.earlier > newest.earlier {
            let message = format!(
                "--earlier {}: of the ends before the newest there are {}",
                self.earlier, newest.earlier
            );
            return Err(Failure::usage(message).into());
        }
        let mut explanation = newest;
        for _ in 0..self.earlier {
            let end = explanation.received.unwrap_or_default();
            explanation = explain(end - Duration::from_nanos(1));
        }
        if let Some(file) = &self.figure {
            let written = fs::write(file, explanation.figure());
            written.with_context(|| format!("writing {}", file.display()))?;
        }
        self.output.print(&explanation, || explanation.to_string())
    }
}

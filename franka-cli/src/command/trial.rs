//! `franka trial`: makes the first motions of an arm, small and slow, with checks and a report.

mod limits;
mod look;
mod report;
mod steps;

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::PathBuf;
use std::pin::pin;

use clap::Args;
use franka_async::export::NewFile;
use franka_async::recording::RecordOptions;

use super::export::of_file;
use crate::ending::{Ending, Failure};
use crate::interrupt::interrupted;
use crate::motion::{Mover, Moving};
use crate::output::say;
use report::Report;

pub(super) const EXAMPLES: &str = "\
Examples:
  franka trial                            writes trial.md and trial.mcap
  franka trial left --report left.md      of the robot left: writes left.md and left.mcap
  franka trial sim --yes                  without questions, for simulators";

/// Make the first motions of an arm, with checks, and write a report
///
/// Checks the arm at rest, then asks before each of five steps: hold, 1 cm up and back, 5 cm up and
/// back, joint 7, a stream of targets. Each step is slow and limited to 15 N. A bad result ends the
/// trial. Ctrl-C brakes. The report is always written, and states if it is incomplete.
#[derive(Debug, Args)]
pub(crate) struct Trial {
    #[command(flatten)]
    mover: Mover,
    /// New report (Markdown). The recording gets the same name with .mcap, unless --record names
    /// another
    #[arg(long, value_name = "FILE.md", default_value = "trial.md")]
    report: PathBuf,
}

impl Trial {
    pub(super) async fn run(mut self) -> anyhow::Result<Ending> {
        // After this line, every signal ends the trial in the regular way, also between two steps.
        let mut interrupt = pin!(interrupted()?);
        let recording = self.recording()?;
        let mut file = NewFile::create(&self.report).map_err(of_file)?;
        let options = RecordOptions {
            // Users share recordings of trials, so the recording does not name the host.
            metadata: BTreeMap::from([("host".to_owned(), String::new())]),
            ..RecordOptions::default()
        };
        // A signal during this call is handled after the call, so that there is a report in
        // addition to the recording.
        let moving = self.mover.how.begin_with(&self.mover.which, options);
        let moving = moving.await?;
        let secrets = secrets(&moving);
        let mut report = Report::new(&moving.robot, recording);
        let outcome = tokio::select! {
            biased;
            outcome = steps::all(&moving, &mut report) => outcome,
            by = &mut interrupt => Err(moving.brake(Some(by)).await),
        };
        let outcome = moving.end(outcome).await;
        report.end(&outcome, &secrets);
        let written = report
            .markdown()
            .map_err(anyhow::Error::from)
            .and_then(|text| {
                file.write_all(text.as_bytes())?;
                file.finish().map_err(of_file)
            });
        match &written {
            Ok(()) => say(&format!("report in {}", self.report.display())),
            Err(error) if outcome.is_err() => say(&format!("no report: {error:#}")),
            Err(_) => {}
        }
        outcome?;
        written?;
        let output = self.mover.how.output;
        output.print(&report, || report.summary())
    }

    /// Sets the name of the recording if the user gave no name. Returns the name without its
    /// folder.
    fn recording(&mut self) -> anyhow::Result<String> {
        let beside = self.report.with_extension("mcap");
        let path = self.mover.how.record.get_or_insert(beside);
        if *path == self.report {
            let message = format!(
                "the report and the recording would have the same name, {}",
                path.display()
            );
            return Err(Failure::usage(message).into());
        }
        if path.exists() {
            let message = format!(
                "{} already exists, and a trial never overwrites a file",
                path.display()
            );
            let failure = Failure::new(Ending::Host, message);
            return Err(failure.advice("Choose another name with --report.").into());
        }
        let name = path.file_name().unwrap_or_default();
        Ok(name.to_string_lossy().into_owned())
    }
}

/// Returns texts that must not appear in a report, for example addresses.
fn secrets(moving: &Moving) -> Vec<String> {
    let address = moving.robot.address();
    vec![
        moving.place.to_string(),
        moving.place.address.to_string(),
        address.to_string(),
        address.ip().to_string(),
    ]
}

/// Speed as a factor of the default. The result is at most 75 mm/s.
const PACE: f64 = 0.25;

/// Largest force at the hand, `[N]`.
const FORCE: f64 = 15.0;

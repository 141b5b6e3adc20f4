//! `franka explain`: explains why a motion ended, from a recording or a log of libfranka.

use std::io::Write as _;
use std::path::PathBuf;
use std::time::Duration;

use anyhow::Context as _;
use clap::Args;
use franka_async::explain::Explanation;
use franka_async::export::NewFile;
use franka_async::model::Model;
use franka_async::recording::control_log::{ControlLogError, ControlLogFile};
use franka_async::recording::{HostTime, RecordedModel, Recording, RecordingError};
use franka_async::state::{Errors, RobotError};
use serde_json::Value;

use super::export::of_file;
use super::limits::Kind;
use crate::ending::{Ending, Failure};
use crate::motion::while_turning;
use crate::output::{Output, say};

/// Explain why a motion ended, and where the arm was touched
///
/// FILE is a recording, a table of libfranka's logToCSV, or a text with the message of a
/// ControlException; a text can contain both. Of several motions, the command explains the newest
/// motion that the robot or a guard stopped, or that ended with a lost link.
#[derive(Debug, Args)]
pub(crate) struct Explain {
    #[command(flatten)]
    recorded: Recorded,
    /// Explain an earlier stop; 1 is the second-newest stop
    #[arg(long, value_name = "N", default_value_t = 0)]
    earlier: u64,
    /// Plot the last second to a new file
    #[arg(long, value_name = "FILE.svg")]
    figure: Option<PathBuf>,
    /// Kind of the robot, for a log of libfranka, which does not contain it
    #[arg(long, value_enum)]
    kind: Option<Kind>,
    /// Errors of the motion, by the vendor's names, for a table without a message
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = error_of)]
    errors: Vec<RobotError>,
    #[command(flatten)]
    output: Output,
}

fn error_of(name: &str) -> Result<RobotError, String> {
    let known = || RobotError::ALL.map(RobotError::name).join(", ");
    RobotError::from_name(name).ok_or_else(|| format!("expected one of {}", known()))
}

/// A robot of a recording, or a log of libfranka.
#[derive(Debug, Args)]
pub(crate) struct Recorded {
    /// Recording, or text with a log of libfranka
    #[arg(value_name = "FILE")]
    pub(super) file: PathBuf,
    /// Robot of the recording; required if it has several
    #[arg(long, value_name = "NAME")]
    of: Option<String>,
}

/// Content of a file.
pub(crate) enum Source {
    /// A recording.
    Recording(Box<Opened>),
    /// A log of libfranka.
    Log(ControlLogFile),
}

/// An open recording, and the name of one of its robots.
pub(crate) struct Opened {
    pub(super) recording: Recording,
    pub(super) name: String,
    pub(super) model: RecordedModel,
}

impl Recorded {
    /// Opens the file. The content of the file determines whether it is a recording or a log.
    pub(super) fn open_any(&self) -> anyhow::Result<Source> {
        match Recording::open(&self.file) {
            Ok(recording) => Ok(Source::Recording(Box::new(self.of_recording(recording)?))),
            Err(RecordingError::NotMcap { .. }) => Ok(Source::Log(self.open_log()?)),
            Err(error) => Err(self.unreadable(&error).into()),
        }
    }

    pub(super) fn open(&self) -> anyhow::Result<Opened> {
        let recording = Recording::open(&self.file);
        self.of_recording(recording.map_err(|error| self.unreadable(&error))?)
    }

    fn unreadable(&self, error: &RecordingError) -> Failure {
        let message = match error {
            RecordingError::File { .. } => error.to_string(),
            error => format!("{}: {error}", self.file.display()),
        };
        Failure::new(Ending::Host, message)
    }

    fn of_recording(&self, recording: Recording) -> anyhow::Result<Opened> {
        if let Some(damage) = recording.damage() {
            say(&format!("{} ends early: {damage}", self.file.display()));
        }
        let robots = recording.robots();
        if robots.is_empty() {
            let message = format!("{} has no robot", self.file.display());
            return Err(Failure::new(Ending::Host, message).into());
        }
        let names: Vec<&str> = robots.iter().map(|robot| robot.name.as_str()).collect();
        let robot = match (&self.of, robots) {
            (None, [only]) => Some(only),
            (Some(name), robots) => robots.iter().find(|robot| robot.name == *name),
            (None, _) => None,
        };
        let robot = robot.ok_or_else(|| {
            let message = format!("no robot of {} was chosen", self.file.display());
            Failure::usage(message).advice(format!("Choose one with --of: {names:?}"))
        })?;
        let name = robot.name.clone();
        let model = recording.robot(&name)?.model().with_context(|| {
            format!(
                "{} does not name the kind of its robot",
                self.file.display()
            )
        })?;
        Ok(Opened {
            recording,
            name,
            model,
        })
    }

    fn open_log(&self) -> anyhow::Result<ControlLogFile> {
        let path = self.file.display();
        let file = ControlLogFile::open(&self.file).map_err(|error| match error {
            ControlLogError::File { .. } => Failure::new(Ending::Host, error.to_string()),
            error => Failure::new(Ending::Host, format!("{path}: {error}")),
        })?;
        Ok(file)
    }
}

impl Explain {
    pub(super) fn run(self) -> anyhow::Result<Ending> {
        let opened = match self.recorded.open_any()? {
            Source::Recording(opened) => opened,
            Source::Log(file) => return self.explain_log(file),
        };
        if !self.errors.is_empty() || self.kind.is_some() {
            let message = "got --errors or --kind for a recording, expected them only for logs of \
                libfranka";
            return Err(Failure::usage(message).into());
        }
        let robot = opened.recording.robot(&opened.name)?;
        let explain = |until| Explanation::of_recording(&robot.to(until), &opened.model);
        let explain = |until| while_turning("reading every cycle", || explain(until));
        let newest = explain(HostTime::from_nanos(u64::MAX));
        if self.earlier > newest.earlier {
            let message = format!(
                "--earlier {}: expected at most {}, the number of earlier stops in this recording",
                self.earlier, newest.earlier
            );
            return Err(Failure::usage(message).into());
        }
        let mut explanation = newest;
        for _ in 0..self.earlier {
            let end = explanation.received.unwrap_or_default();
            explanation = explain(end - Duration::from_nanos(1));
        }
        self.draw(&explanation)?;
        self.output.print(&explanation, || explanation.to_string())
    }

    fn explain_log(&self, mut file: ControlLogFile) -> anyhow::Result<Ending> {
        let model = self.kind.map(Kind::model);
        let model = model.or_else(|| file.kind().map(Model::of));
        // Without a table, no number in the text depends on the kind of robot.
        if model.is_none() && !file.log.is_empty() {
            let path = self.recorded.file.display();
            let message = format!("{path} does not name the kind of the robot, expected --kind");
            return Err(Failure::usage(message)
                .advice("Add --kind fr3 or --kind fer.")
                .into());
        }
        if self.earlier > 0 {
            let message = "got --earlier for a log, expected it only for recordings: a log is \
                explained up to its newest motion";
            return Err(Failure::usage(message).into());
        }
        if !self.errors.is_empty() {
            let named = file.errors();
            if !named.is_empty() {
                let message =
                    format!("got --errors, but the file names the errors itself: {named}");
                return Err(Failure::usage(message).into());
            }
            file = file.with_errors(self.errors.iter().copied().collect::<Errors>());
        }
        let explanation = Explanation::of_control_log(&file, model.unwrap_or(Model::fr3()));
        self.draw(&explanation)?;
        let mut value = serde_json::to_value(&explanation)?;
        if let (None, Value::Object(fields)) = (model, &mut value) {
            fields.remove("robot");
        }
        self.output.print(&value, || explanation.to_string())
    }

    fn draw(&self, explanation: &Explanation) -> anyhow::Result<()> {
        if let Some(file) = &self.figure {
            let draw = || {
                let mut to = NewFile::create(file)?;
                to.write_all(explanation.figure().as_bytes())?;
                to.finish()
            };
            draw().map_err(of_file)?;
        }
        Ok(())
    }
}

//! The result of a trial, as a text that people and programs can read.

use std::fmt::Write as _;

use franka_async::Robot;
use serde::Serialize;
use serde_json::{Value, json};

use super::{FORCE, PACE};
use crate::connection::kind_name;
use crate::ending::{Ending, Failure};
use crate::output::{BAD, GOOD, WARN, say};

/// Findings of a trial, in order.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    driver: &'static str,
    kind: &'static str,
    fci_version: u16,
    /// Priority of the control thread; `None` without real-time scheduling.
    priority: Option<i32>,
    kernel: Option<String>,
    machine: &'static str,
    speed: f64,
    force_cap: f64,
    recording: String,
    complete: bool,
    /// Reason why the report is incomplete; `None` if it is complete.
    ended: Option<Ended>,
    pub(super) steps: Vec<Step>,
}

#[derive(Debug, Serialize)]
pub(super) struct Step {
    name: &'static str,
    findings: Vec<Finding>,
}

/// A check of the trial and its numbers.
#[derive(Debug, Serialize)]
pub(super) struct Finding {
    check: &'static str,
    verdict: Verdict,
    text: String,
    figures: Value,
}

/// Result of a check: whether a finding matches its expected value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Verdict {
    Good,
    /// The finding is unusual, but no reason to stop.
    Look,
    /// The finding ends the trial.
    Bad,
}

impl Verdict {
    /// Returns good up to the first limit, and unusual up to the second limit.
    pub(super) fn of(value: f64, [good, bad]: [f64; 2]) -> Self {
        match value {
            value if value <= good => Self::Good,
            value if value <= bad => Self::Look,
            // NaN also matches here.
            _ => Self::Bad,
        }
    }

    fn text(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Look => "look",
            Self::Bad => "bad",
        }
    }
}

/// The early end of a trial.
#[derive(Debug, Serialize)]
struct Ended {
    step: &'static str,
    kind: &'static str,
    exit_code: u8,
    text: String,
}

impl Report {
    pub(super) fn new(robot: &Robot, recording: String) -> Self {
        let kernel = std::fs::read_to_string("/proc/sys/kernel/osrelease");
        Self {
            driver: env!("CARGO_PKG_VERSION"),
            kind: kind_name(robot.model().kind()),
            fci_version: robot.version().number(),
            priority: robot.granted().priority,
            kernel: kernel.ok().map(|text| text.trim().to_owned()),
            machine: std::env::consts::ARCH,
            speed: PACE,
            force_cap: FORCE,
            recording,
            complete: false,
            ended: None,
            steps: Vec::new(),
        }
    }

    pub(super) fn begin(&mut self, name: &'static str) {
        let findings = Vec::new();
        self.steps.push(Step { name, findings });
    }

    /// Records and prints a finding of this step.
    ///
    /// # Errors
    /// Returns an error, which ends the trial, if the finding is bad.
    pub(super) fn note(
        &mut self,
        check: &'static str,
        verdict: Verdict,
        text: String,
        figures: Value,
    ) -> Result<(), Failure> {
        let style = match verdict {
            Verdict::Good => GOOD,
            Verdict::Look => WARN,
            Verdict::Bad => BAD,
        };
        // Each part is on its own line, because a terminal has 80 columns.
        let lines = text.replace("; ", &format!(";\n{:20}", ""));
        let said = verdict.text();
        say(&format!(
            "  {style}{said:<4}{style:#}  {check:<10}  {lines}"
        ));
        let failed = (verdict == Verdict::Bad).then(|| format!("{check}: {text}"));
        if let Some(step) = self.steps.last_mut() {
            step.findings.push(Finding {
                check,
                verdict,
                text,
                figures,
            });
        }
        match failed {
            Some(text) => Err(Failure::new(Ending::Failed, text)),
            None => Ok(()),
        }
    }

    /// Records how the trial ended, and removes the texts in `secrets`.
    pub(super) fn end(&mut self, outcome: &anyhow::Result<()>, secrets: &[String]) {
        self.complete = outcome.is_ok();
        self.ended = outcome.as_ref().err().map(|error| {
            let ending = Ending::of(error);
            Ended {
                step: self.steps.last().map_or("connecting", |step| step.name),
                kind: ending.kind(),
                exit_code: ending as u8,
                text: without(&format!("{error:#}"), secrets),
            }
        });
    }

    /// Returns the result of the trial in one line.
    pub(super) fn summary(&self) -> String {
        let all = self.steps.iter().flat_map(|step| &step.findings);
        let count = |verdict| all.clone().filter(|it| it.verdict == verdict).count();
        let looks = count(Verdict::Look);
        let of = format!("{} checks, {looks} of them to look at", all.clone().count());
        match &self.ended {
            None => format!("complete: {} steps, {of}", self.steps.len()),
            Some(ended) => format!(
                "incomplete: ended at the step \"{}\", {of}: {}",
                ended.step, ended.text
            ),
        }
    }

    /// Returns the report as Markdown. All data is at the end, as JSON.
    pub(super) fn markdown(&self) -> serde_json::Result<String> {
        let priority = match self.priority {
            Some(priority) => format!("real-time scheduling, priority {priority}"),
            None => "no real-time scheduling".to_owned(),
        };
        let mut text = format!(
            "# Trial of a robot arm: {kind}\n\n\
             **{summary}**\n\n\
             | | |\n|---|---|\n\
             | driver | `franka` {driver} |\n\
             | robot | {kind}, FCI version {version} |\n\
             | control thread | {priority} |\n\
             | computer | {machine}, kernel {kernel} |\n\
             | limits | {speed} of the default speed, {force:.0} N |\n\
             | recording | `{recording}`, in the folder of this report unless another was named |\n\n\
             This report holds no names, addresses or serial numbers of the robot or the computer, \
             and no time of day.\nThe recording holds every state of the robot, the description \
             that the robot serves, the kernel of the\ncomputer and the time of day; the name of \
             the computer is left out.\n",
            kind = self.kind,
            summary = escaped(&self.summary()),
            driver = self.driver,
            version = self.fci_version,
            machine = self.machine,
            kernel = self.kernel.as_deref().unwrap_or("unknown"),
            speed = self.speed,
            force = self.force_cap,
            recording = self.recording,
        );
        for (number, step) in self.steps.iter().enumerate() {
            let _ = write!(text, "\n## {number}. {}\n\n", step.name);
            if step.findings.is_empty() {
                text.push_str("Nothing was measured.\n");
                continue;
            }
            text.push_str("| check | verdict | found |\n|---|---|---|\n");
            for Finding {
                check,
                verdict,
                text: found,
                ..
            } in &step.findings
            {
                let (verdict, found) = (verdict.text(), escaped(found));
                let _ = writeln!(text, "| {check} | {verdict} | {found} |");
            }
        }
        let all = serde_json::to_string_pretty(&json!({ "schema": SCHEMA, "trial": self }))?;
        let _ = write!(text, "\n## All figures\n\n```json\n{all}\n```\n");
        Ok(text)
    }
}

fn escaped(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

/// Returns the text with a placeholder for each of `secrets`.
fn without(text: &str, secrets: &[String]) -> String {
    let mut secrets: Vec<_> = secrets.iter().filter(|it| !it.is_empty()).collect();
    // A secret may be a part of another secret.
    secrets.sort_by_key(|it| std::cmp::Reverse(it.len()));
    secrets.iter().fold(text.to_owned(), |text, secret| {
        text.replace(*secret, "ROBOT")
    })
}

/// Version of the JSON data in a report. It increases when a value is removed or changes its
/// meaning.
const SCHEMA: u32 = 1;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_and_names_are_taken_out() {
        let secrets = ["left (10.0.0.2)", "10.0.0.2", "", "10.0.0.2:1337"].map(str::to_owned);
        let text = "robot at left (10.0.0.2) is silent: 10.0.0.2:1337";
        assert_eq!(without(text, &secrets), "robot at ROBOT is silent: ROBOT");
    }

    #[test]
    fn verdict_of_nan_is_bad() {
        let limits = [1.0, 2.0];
        assert_eq!(Verdict::of(1.0, limits), Verdict::Good);
        assert_eq!(Verdict::of(1.5, limits), Verdict::Look);
        assert_eq!(Verdict::of(2.5, limits), Verdict::Bad);
        assert_eq!(Verdict::of(f64::NAN, limits), Verdict::Bad);
    }
}

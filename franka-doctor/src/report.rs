//! Findings as text, as JSON, and as a shell script.

use core::fmt::Write as _;
use std::collections::BTreeMap;

use crate::finding::{Finding, Group, Needs, Purpose, Verdict};

/// The findings about a host.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Report {
    /// Version of the report's JSON format ([`SCHEMA`]).
    pub schema: u32,
    /// The purpose of the host.
    pub purpose: Purpose,
    /// The findings, sorted by group.
    pub findings: Vec<Finding>,
    /// All values that were read, by path or by query.
    pub readings: BTreeMap<String, String>,
}

/// Version of the JSON format of reports.
pub const SCHEMA: u32 = 1;

impl Report {
    /// Adds more findings, for example the [`arrivals`](crate::arrivals) of a connected robot.
    pub fn add(&mut self, findings: impl IntoIterator<Item = Finding>) {
        self.findings.extend(findings);
        self.findings.sort_by_key(|finding| finding.group);
    }

    /// Returns the number of findings with this verdict.
    pub fn count(&self, verdict: Verdict) -> usize {
        let has = |finding: &&Finding| finding.verdict == verdict;
        self.findings.iter().filter(has).count()
    }

    /// Returns the report as text. Each group has a line with its worst verdict, followed by the
    /// findings that are not good. The last line is a count.
    pub fn to_text(&self, color: bool) -> String {
        self.text(color, false)
    }

    /// Like [`Self::to_text`], but includes the good findings, and the reason and the source of
    /// every finding.
    pub fn to_detailed_text(&self, color: bool) -> String {
        self.text(color, true)
    }

    fn text(&self, color: bool, detailed: bool) -> String {
        let mut text = String::new();
        // The commands that were already shown, with their checks.
        let mut named: Vec<(&str, &str)> = Vec::new();
        for group in Group::ALL {
            let of_group = || {
                self.findings
                    .iter()
                    .filter(|finding| finding.group == group)
            };
            if of_group().next().is_none() {
                continue;
            }
            let worst = of_group().max_by_key(|finding| weight(finding.verdict));
            let verdict = worst.map_or(Verdict::Unknown, |finding| finding.verdict);
            let _ = writeln!(text, "{} {group}", mark(verdict, color));
            let shown: Vec<&Finding> = of_group()
                .filter(|finding| finding.verdict != Verdict::Good || detailed)
                .collect();
            // Consecutive findings with the same text are shown once.
            let same = |a: &&Finding, b: &&Finding| {
                let is_short = !detailed && matches!(a.verdict, Verdict::Info | Verdict::Unknown);
                is_short && (a.verdict, &a.read) == (b.verdict, &b.read)
            };
            for alike in shown.chunk_by(same) {
                let finding = alike[0];
                let ids: Vec<&str> = alike.iter().map(|finding| finding.id).collect();
                let mark = mark(finding.verdict, color);
                let read = format!("{}: {}", ids.join(", "), finding.read);
                wrapped(&mut text, &format!("    {mark} "), &read);
                let matters = matches!(finding.verdict, Verdict::Warning | Verdict::Failure);
                if matters || detailed {
                    wrapped(&mut text, "        wanted: ", finding.wanted);
                    wrapped(&mut text, "        why: ", finding.why);
                    wrapped(&mut text, "        source: ", finding.source);
                }
                if let Some(fix) = finding.fix.as_ref().filter(|_| matters || detailed) {
                    let then = match fix.needs {
                        Needs::Nothing => "",
                        Needs::Login => " (then log in again)",
                        Needs::Reboot => " (then reboot)",
                    };
                    match named.iter().find(|(command, _)| *command == fix.command) {
                        Some((_, id)) => {
                            let _ = writeln!(text, "        fix{then}: as for {id}");
                        }
                        // The command must stay on one line, so that the user can copy it.
                        None => {
                            named.push((&fix.command, finding.id));
                            let _ = writeln!(text, "        fix{then}: {}", fix.command);
                        }
                    }
                }
            }
        }
        let _ = writeln!(
            text,
            "{} good, {} for information, {}, {}, {} unknown, for {}",
            self.count(Verdict::Good),
            self.count(Verdict::Info),
            counted(self.count(Verdict::Warning), "warning"),
            counted(self.count(Verdict::Failure), "failure"),
            self.count(Verdict::Unknown),
            match self.purpose {
                Purpose::Sim => "simulating",
                Purpose::Read => "reading states",
                Purpose::Move => "moving a robot",
            }
        );
        text
    }

    /// Returns the report, including all values read, as JSON.
    #[cfg(feature = "serde")]
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("texts and numbers, with texts as keys")
    }

    /// Returns a shell script that contains the fixes for warnings and failures. Read the script
    /// before you run it. This method runs nothing.
    pub fn fix_script(&self) -> String {
        let mut script = "#!/bin/sh\n# Fixes of `franka doctor`. Read before running.\n".to_owned();
        let mut done: Vec<&str> = Vec::new();
        let mut needs = Needs::Nothing;
        for finding in &self.findings {
            let matters = matches!(finding.verdict, Verdict::Warning | Verdict::Failure);
            let Some(fix) = finding.fix.as_ref().filter(|_| matters) else {
                continue;
            };
            let _ = writeln!(script, "\n# {}: {}", finding.id, one_line(&finding.read));
            if done.contains(&fix.command.as_str()) {
                let _ = writeln!(script, "# The command above.");
                continue;
            }
            let _ = writeln!(script, "{}", fix.command);
            done.push(&fix.command);
            needs = match (needs, fix.needs) {
                (Needs::Reboot, _) | (_, Needs::Reboot) => Needs::Reboot,
                (Needs::Login, _) | (_, Needs::Login) => Needs::Login,
                _ => Needs::Nothing,
            };
        }
        match needs {
            Needs::Nothing => {}
            Needs::Login => script += "\necho 'Log in again for this to take effect.'\n",
            Needs::Reboot => script += "\necho 'Reboot for this to take effect.'\n",
        }
        script
    }

    /// Returns the exit code for a program: 1 if the report contains a failure, and 0 otherwise. A
    /// program should return 2 if it could not run the checks.
    pub fn exit_code(&self) -> u8 {
        u8::from(self.count(Verdict::Failure) > 0)
    }
}

/// Appends `lead` and then `words`, in lines of at most [`COLUMNS`] columns. All lines after the
/// first are indented. A word is never split.
fn wrapped(text: &mut String, lead: &str, words: &str) {
    *text += lead;
    let mut column = columns_of(lead);
    for (index, word) in words.split_whitespace().enumerate() {
        let length = word.chars().count();
        if index > 0 && column + 1 + length > COLUMNS {
            let _ = write!(text, "\n{:INDENT$}", "");
            column = INDENT;
        } else if index > 0 {
            *text += " ";
            column += 1;
        }
        *text += word;
        column += length;
    }
    *text += "\n";
}

/// Returns the number of columns of `lead`, without its colour codes.
fn columns_of(lead: &str) -> usize {
    let mut is_colour = false;
    let shown = lead.chars().filter(|&c| {
        is_colour |= c == '\x1b';
        let shown = !is_colour;
        is_colour &= c != 'm';
        shown
    });
    shown.count()
}

/// Usual number of columns of a terminal.
const COLUMNS: usize = 80;

/// Indentation of all lines after the first.
const INDENT: usize = 12;

pub(crate) fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Returns `text` without line breaks, for use as a comment in a script.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns the weight of a verdict. The verdict of a group is the verdict with the greatest weight.
fn weight(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::Info => 0,
        Verdict::Good => 1,
        Verdict::Unknown => 2,
        Verdict::Warning => 3,
        Verdict::Failure => 4,
    }
}

/// Returns a mark of four characters, like `flutter doctor`.
fn mark(verdict: Verdict, color: bool) -> String {
    let (mark, code) = match verdict {
        Verdict::Good => ("[OK]", 32),
        Verdict::Info => ("[i]", 36),
        Verdict::Warning => ("[!]", 33),
        Verdict::Failure => ("[X]", 31),
        Verdict::Unknown => ("[?]", 35),
    };
    match color {
        true => format!("\x1b[{code}m{mark}\x1b[0m"),
        false => mark.to_owned(),
    }
}

//! Error messages of failed commands, as text for people and as JSON for programs.

use std::io;

use anstyle::{AnsiColor, Style};
use serde::Serialize;
use serde_json::json;

use crate::ending::{Ending, Failure, origin_of};
use crate::output::json_line;

/// Prints why a command failed, and also prints it as JSON if `json` is true. Returns the ending of
/// the program.
pub(crate) fn report(error: &anyhow::Error, json: bool) -> Ending {
    let ending = Ending::of(error);
    // The reader has closed the pipe and would not see an error text.
    if is_broken_pipe(error) {
        return Ending::Done;
    }
    if json {
        // The error is ignored, because the reader may have closed the pipe. The exit code is still
        // set.
        let _ = json_line(&json!({ "error": Reported::of(error) }));
    }
    let style = Style::new().fg_color(Some(AnsiColor::Red.into())).bold();
    anstream::eprintln!("{style}error:{style:#} {error:#}");
    let failure = error.downcast_ref::<Failure>();
    if let Some(advice) = failure.and_then(|failure| failure.advice.as_ref()) {
        anstream::eprintln!("{advice}");
    }
    if let Some((_, entry)) = origin_of(error) {
        anstream::eprintln!("In the book: errors.md#{entry}");
    }
    ending
}

/// The failure of a command, in JSON.
#[derive(Debug, Serialize)]
struct Reported {
    /// The name of the exit code.
    kind: &'static str,
    exit_code: u8,
    /// Who can act on an error of the driver.
    party: Option<String>,
    /// Row of the error in the book's chapter on errors.
    entry: Option<&'static str>,
    text: String,
    advice: Option<String>,
}

impl Reported {
    fn of(error: &anyhow::Error) -> Self {
        let ending = Ending::of(error);
        let failure = error.downcast_ref::<Failure>();
        let origin = origin_of(error);
        Self {
            kind: ending.kind(),
            exit_code: ending as u8,
            party: origin.map(|(party, _)| party.to_string()),
            entry: origin.map(|(_, entry)| entry),
            text: format!("{error:#}"),
            advice: failure.and_then(|failure| failure.advice.clone()),
        }
    }

    fn usage(text: &str) -> Self {
        Self {
            kind: Ending::Usage.kind(),
            exit_code: Ending::Usage as u8,
            party: None,
            entry: None,
            text: text.trim_end().to_owned(),
            advice: None,
        }
    }
}

/// Prints the error of invalid arguments as JSON.
pub(crate) fn report_usage(text: &str) {
    // The error is ignored, as in `report`.
    let _ = json_line(&json!({ "error": Reported::usage(text) }));
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let io = error.downcast_ref::<io::Error>();
    io.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}

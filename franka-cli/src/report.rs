//! Error messages of failed commands: for people, and as JSON for programs.

use std::io;

use anstyle::{AnsiColor, Style};
use serde::Serialize;
use serde_json::json;

use crate::ending::{Ending, Failure, origin_of};
use crate::output::json_line;

/// Prints why a command failed, if `json` is true also as JSON. Returns how the program ends.
pub(crate) fn report(error: &anyhow::Error, json: bool) -> Ending {
    let ending = Ending::of(error);
    // The reader has closed the pipe, so an error text would not be seen.
    if is_broken_pipe(error) {
        return Ending::Done;
    }
    if json {
        // The reader may have closed the pipe; the exit code is still set.
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

/// The failure of a command in JSON, for programs.
#[derive(Debug, Serialize)]
struct Reported {
    /// The name of the exit code.
    kind: &'static str,
    exit_code: u8,
    /// Who can act on an error of the driver.
    party: Option<String>,
    /// The error's row in the book's chapter of errors.
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
    // As in `report`.
    let _ = json_line(&json!({ "error": Reported::usage(text) }));
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    let io = error.downcast_ref::<io::Error>();
    io.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}

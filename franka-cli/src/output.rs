//! Results on standard output, as text for people or as JSON for programs.

use std::io::Write;

use anstyle::{AnsiColor, Style};
use serde::Serialize;

use crate::ending::Ending;

/// Format of results.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub(crate) struct Output {
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

impl Output {
    /// Prints a value as JSON, or as the text that `text` returns.
    pub(crate) fn print(
        self,
        value: &impl Serialize,
        text: impl FnOnce() -> String,
    ) -> anyhow::Result<Ending> {
        if self.json {
            line(&serde_json::to_string_pretty(&Versioned::new(value))?)?;
        } else {
            line(text().trim_end_matches('\n'))?;
        }
        Ok(Ending::Done)
    }
}

pub(crate) fn json_line(value: &impl Serialize) -> anyhow::Result<()> {
    line(&serde_json::to_string(&Versioned::new(value))?)
}

/// A result (a JSON object) and the version of its format.
#[derive(Serialize)]
struct Versioned<'a, T> {
    schema: u32,
    #[serde(flatten)]
    facts: &'a T,
}

impl<'a, T> Versioned<'a, T> {
    fn new(facts: &'a T) -> Self {
        Self {
            schema: SCHEMA,
            facts,
        }
    }
}

/// Version of the JSON output of the commands. It increases when a field is removed or changes its
/// meaning, but not when a field is added. `franka doctor` has a separate version.
const SCHEMA: u32 = 1;

/// Prints a line on standard output. Removes colours if they are disabled.
pub(crate) fn line(text: &str) -> anyhow::Result<()> {
    let mut out = anstream::stdout().lock();
    writeln!(out, "{text}")?;
    out.flush()?;
    Ok(())
}

/// Prints a message for the user on standard error.
pub(crate) fn say(text: &str) {
    anstream::eprintln!("{text}");
}

pub(crate) const BOLD: Style = Style::new().bold();
pub(crate) const GOOD: Style = AnsiColor::Green.on_default();
/// Style of values near a limit.
pub(crate) const WARN: Style = AnsiColor::Yellow.on_default();
pub(crate) const BAD: Style = AnsiColor::Red.on_default().bold();
/// Style of less important text.
pub(crate) const DIM: Style = Style::new().dimmed();

/// Formats numbers in aligned columns that have space for signs.
pub(crate) fn numbers(values: &[f64], decimals: usize) -> String {
    let width = decimals + 6;
    let cells = values.iter().map(|value| {
        let value = unsigned_zero(*value, decimals as i32);
        format!("{value:>width$.decimals$}")
    });
    cells.collect()
}

/// Returns the value. Removes its minus sign if the value is shown as zero.
pub(crate) fn unsigned_zero(value: f64, decimals: i32) -> f64 {
    let is_zero = value.abs() < 0.5 * 0.1_f64.powi(decimals);
    if is_zero { 0.0 } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        assert_eq!(numbers(&[-0.01, -135.0, 5.25], 1), "    0.0 -135.0    5.2");
    }
}

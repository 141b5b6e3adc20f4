//! `franka completions`: prints shell completion scripts.

use std::fmt::Write as _;

use clap::builder::ValueHint;
use clap::{Args, Command, CommandFactory};
use clap_complete::Shell;

use crate::Program;
use crate::ending::Ending;
use crate::output::line;

/// Print shell completions
#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// Shell
    shell: Shell,
}

impl Completions {
    pub(super) fn run(self) -> anyhow::Result<Ending> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Program::command(), "franka", &mut script);
        let mut script = String::from_utf8(script)?;
        if self.shell == Shell::Fish {
            script += &positionals(&Program::command())?;
        }
        line(script.trim_end())?;
        Ok(Ending::Done)
    }
}

/// Returns two kinds of fish lines that `clap_complete` omits: the values of positional arguments,
/// and lines that suppress file names for arguments that are not files.
fn positionals(program: &Command) -> Result<String, std::fmt::Error> {
    let mut lines = String::new();
    for command in program.get_subcommands() {
        let using = format!("__fish_franka_using_subcommand {}", command.get_name());
        if !command.has_subcommands() {
            add(&mut lines, &using, command)?;
        }
        for inner in command.get_subcommands() {
            let seen = inner.get_name();
            let using = format!("{using}; and __fish_seen_subcommand_from {seen}");
            add(&mut lines, &using, inner)?;
        }
    }
    Ok(lines)
}

fn add(lines: &mut String, using: &str, command: &Command) -> std::fmt::Result {
    let takes_a_file = command.get_positionals().any(|argument| {
        let hint = argument.get_value_hint();
        matches!(
            hint,
            ValueHint::AnyPath | ValueHint::FilePath | ValueHint::DirPath
        )
    });
    if takes_a_file {
        return Ok(());
    }
    let values = command
        .get_positionals()
        .flat_map(|argument| argument.get_possible_values());
    let names: Vec<_> = values.map(|value| value.get_name().to_owned()).collect();
    write!(lines, "complete -c franka -n \"{using}\" -f")?;
    if !names.is_empty() {
        write!(lines, " -a \"{}\"", names.join(" "))?;
    }
    writeln!(lines)
}

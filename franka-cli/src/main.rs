//! `franka`: one command line for the robot, the simulator and what they record.
//!
//! ```text
//! arguments --> command --> [robot: robots file, connection] --> [question] --> facts or a motion --> exit code
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`ending`] | exit codes, and errors that say what to do next |
//! | [`robots_file`] | robots by name |
//! | [`connection`] | which robot, connecting to it, whether it may be moved |
//! | [`question`] | what will move, how far and how fast; asked before it does |
//! | [`motion`] | a motion under way: progress, recording, braking |
//! | [`fields`] | a state by the names of its fields |
//! | [`interrupt`] | Ctrl-C |
//! | [`output`] | text and JSON |
//! | [`values`] | checked values of arguments |
//! | [`command`] | a file per command |

mod command;
mod connection;
mod ending;
mod fields;
mod interrupt;
mod motion;
mod output;
mod question;
mod robots_file;
mod values;

use std::io::IsTerminal;
use std::process::ExitCode;

use clap::Parser;

use command::Command;
use ending::Ending;

/// Franka robots from the command line: state, motions, simulator, recordings.
///
/// ROBOT is the name of a robot in the file of `franka robots`, or an address: a host name or an
/// IP address, with a port if it is not the usual one. Without it, FRANKA_ROBOT counts, and then
/// the only robot in the file. Whatever moves says so first and asks. Lengths are in metres, angles
/// in radians unless said otherwise.
#[derive(Debug, Parser)]
#[command(name = "franka", version, after_help = ending::TABLE, subcommand_required = true, arg_required_else_help = true)]
struct Program {
    /// Log what the driver does, on standard error
    #[arg(short, long, global = true)]
    verbose: bool,
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    let program = Program::parse();
    if program.verbose || program.command.logs() {
        tracing_subscriber::fmt()
            .with_writer(std::io::stderr)
            .with_ansi(std::io::stderr().is_terminal())
            .with_target(false)
            .init();
    }
    match program.command.run() {
        Ok(ending) => ending.code(),
        Err(error) => Ending::report(&error).code(),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        use clap::CommandFactory;
        Program::command().debug_assert();
    }

    /// Lines of shell blocks that begin with `franka`, up to a comment.
    #[test]
    fn the_commands_of_the_book_are_understood() {
        let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/src");
        let mut folders = vec![book];
        let mut count = 0;
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(&folder).expect("a folder") {
                let path = entry.expect("an entry").path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|extension| extension == "md") {
                    let page = fs::read_to_string(&path).expect("a page");
                    for command in commands(&page) {
                        count += 1;
                        if let Err(error) = Program::try_parse_from(command.split_whitespace()) {
                            panic!("{}: {command}\n{error}", path.display());
                        }
                    }
                }
            }
        }
        assert!(count > 25, "{count} commands");
    }

    fn commands(page: &str) -> impl Iterator<Item = &str> {
        let mut in_shell = false;
        page.lines().filter_map(move |line| {
            if line.starts_with("```") {
                in_shell = line == "```sh";
            }
            let command = line.split(" #").next()?.trim_end_matches([' ', '&']);
            (in_shell && command.starts_with("franka ")).then_some(command)
        })
    }
}

//! `franka`: one command line for the robot, the simulator and recordings.
//!
//! ```text
//! arguments --> command --> [robot: robots file, connection] --> [question] --> facts or a motion --> exit code
//! ```
//!
//! | module | content |
//! |---|---|
//! | [`ending`] | exit codes, and errors with the next step |
//! | [`report`] | error messages |
//! | [`robots_file`] | robots by name |
//! | [`connection`] | selection of the robot, connection, permission to move it |
//! | [`question`] | the description of a motion, and its confirmation |
//! | [`motion`] | a running motion: progress, recording, braking |
//! | [`fields`] | a state by the names of its fields |
//! | [`interrupt`] | Ctrl-C and SIGTERM |
//! | [`output`] | text and JSON |
//! | [`values`] | checked values of arguments |
//! | [`command`] | the commands, one file each |

mod command;
mod connection;
mod ending;
mod fields;
mod interrupt;
mod motion;
mod output;
mod question;
mod report;
mod robots_file;
mod values;

use std::process::ExitCode;

use clap::{ArgAction, Parser};
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::prelude::*;

use command::Command;
use report::report_usage;

/// Franka robots from the command line: state, motions, simulator, recordings.
///
/// ROBOT is a name from `franka robots`, or an address: a host name or an IP address, with a port
/// unless it is the default. It defaults to FRANKA_ROBOT, then to the only robot with a name.
/// Commands that move the robot describe the motion and ask first. Lengths are in metres and angles
/// in radians, unless stated otherwise.
#[derive(Debug, Parser)]
#[command(name = "franka", version, after_help = ending::TABLE, subcommand_required = true, arg_required_else_help = true)]
struct Program {
    /// Log the driver's actions to standard error; -vv logs more, RUST_LOG selects modules
    #[arg(short, long, global = true, action = ArgAction::Count)]
    verbose: u8,
    #[command(flatten)]
    color: colorchoice_clap::Color,
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    let json = std::env::args_os().any(|argument| argument == "--json");
    let program = match Program::try_parse() {
        Ok(program) => program,
        Err(error) => {
            if json && error.use_stderr() {
                report_usage(&error.render().to_string());
            }
            error.exit()
        }
    };
    program.color.write_global();
    let verbose = program.verbose.max(program.command.logs().into());
    start_log(verbose);
    match program.command.run() {
        Ok(ending) => ending.code(),
        Err(error) => report::report(&error, json).code(),
    }
}

/// Logs to standard error, at the levels of RUST_LOG or as chosen by the number of `-v`.
fn start_log(verbose: u8) {
    let level = match verbose {
        0 => LevelFilter::OFF,
        1 => LevelFilter::INFO,
        _ => LevelFilter::DEBUG,
    };
    let mut levels = Targets::new()
        .with_default(level.min(LevelFilter::INFO))
        .with_target("franka", level);
    if let Ok(chosen) = std::env::var("RUST_LOG") {
        match chosen.parse::<Targets>() {
            Ok(chosen) if chosen.iter().next().is_some() => levels = chosen,
            Ok(_) => (),
            // The variable may be meant for another program and must not prevent a stop.
            Err(error) => output::say(&format!("note: RUST_LOG={chosen} is ignored: {error}")),
        }
    }
    let log = tracing_subscriber::fmt::layer()
        .with_writer(std::io::stderr)
        .with_ansi(has_colours(&std::io::stderr()))
        .with_target(false);
    tracing_subscriber::registry()
        .with(log.with_filter(levels))
        .init();
}

/// Returns true if this stream shows colours. As for all other output, this depends on --color,
/// NO_COLOR, CLICOLOR_FORCE and similar variables.
fn has_colours(stream: &impl anstream::stream::RawStream) -> bool {
    anstream::AutoStream::choice(stream) != anstream::ColorChoice::Never
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

    /// Reads lines of shell blocks that begin with `franka`, up to a comment.
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

    #[test]
    fn every_help_has_an_example_that_is_understood() {
        use clap::CommandFactory;
        let mut commands = vec![(Program::command(), String::new())];
        let mut count = 0;
        while let Some((command, path)) = commands.pop() {
            let path = format!("{path}{} ", command.get_name());
            let inner = command.get_subcommands();
            commands.extend(inner.map(|inner| (inner.clone(), path.clone())));
            if command.has_subcommands() {
                continue;
            }
            let help = command.get_after_help().expect(&path).to_string();
            let lines = help
                .lines()
                .map(|line| line.trim_start_matches("Example: "));
            let lines = lines.map(|line| line.trim_start().split("  ").next().unwrap_or_default());
            let examples = lines.filter(|line| line.starts_with(path.trim_end()));
            let mut missing = true;
            for example in examples {
                missing = false;
                if let Err(error) = Program::try_parse_from(example.split(' ')) {
                    panic!("{example}\n{error}");
                }
            }
            assert!(!missing, "{path}: {help}");
            count += 1;
        }
        assert!(count > 30, "{count} commands");
    }

    /// Commands that act on a robot or change its settings.
    const ACTING: [&str; 11] = [
        "bench",
        "collision",
        "gripper",
        "guide",
        "move",
        "recover",
        "replay",
        "stop",
        "test",
        "tool",
        "trial",
    ];

    /// Texts that recommend such a command because it is necessary there.
    const ADVISED: [(&str, &str); 8] = [
        // The robot has stopped itself. The text first recommends to remove the cause.
        ("franka-cli/src/connection.rs", "recover"),
        ("franka-cli/src/motion.rs", "recover"),
        ("franka-doctor/src/at_rest.rs", "recover"),
        ("franka-doctor/src/at_rest.rs", "recover"),
        // Fingers do not know their width until they have been homed.
        ("franka-cli/src/command/gripper.rs", "gripper"),
        // Examples in the command's own help.
        ("franka-cli/src/command/trial.rs", "trial"),
        ("franka-cli/src/command/trial.rs", "trial"),
        ("franka-cli/src/command/trial.rs", "trial"),
    ];

    /// Searches the texts of the programs, without comments and tests. A text must not advise a
    /// reader with a damaged file or a busy host to run a command that acts on a robot.
    #[test]
    fn texts_advise_no_command_that_acts_on_a_robot_unless_listed() {
        use clap::CommandFactory;
        let known: Vec<_> = Program::command()
            .get_subcommands()
            .map(|command| command.get_name().to_owned())
            .collect();
        for command in ACTING {
            assert!(known.iter().any(|it| it == command), "{command}");
        }
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let crates = fs::read_dir(&root).expect("the workspace");
        let crates = crates.map(|entry| entry.expect("an entry").path());
        let mut folders: Vec<_> = crates
            .filter(|path| path.join("Cargo.toml").is_file() && path.join("src").is_dir())
            .flat_map(|path| [path.join("src"), path.join("python")])
            .filter(|path| path.is_dir())
            .collect();
        let (mut found, mut files) = (Vec::new(), 0);
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(&folder).expect("a folder") {
                let path = entry.expect("an entry").path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|it| it == "rs" || it == "py") {
                    files += 1;
                    let source = fs::read_to_string(&path).expect("a source");
                    let name = path.strip_prefix(&root).expect("it is below");
                    let name = name.to_str().expect("text").to_owned();
                    let advised = advised(&source).into_iter();
                    found.extend(advised.map(|command| (name.clone(), command)));
                }
            }
        }
        assert!(files > 500, "{files} sources");
        found.sort();
        let mut allowed = ADVISED.map(|(file, command)| (file.to_owned(), command));
        allowed.sort();
        assert_eq!(found, allowed);
        let unsafe_advice = "#[error(\"damaged; `franka recover` helps\")]\n// franka move\n";
        assert_eq!(advised(unsafe_advice), ["recover"]);
    }

    /// Returns the commands that act on a robot and that a source file's texts name.
    fn advised(source: &str) -> Vec<&'static str> {
        let mut found = Vec::new();
        for line in source.lines() {
            let line = line.trim_start();
            if line.starts_with("mod tests") {
                break;
            }
            if line.starts_with("//") || line.starts_with('#') && !line.starts_with("#[error") {
                continue;
            }
            for (at, _) in line.match_indices("franka ") {
                if line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '-') {
                    continue;
                }
                let word = line[at + 7..].split(|c: char| !c.is_alphanumeric()).next();
                found.extend(ACTING.into_iter().filter(|it| Some(*it) == word));
            }
        }
        found
    }
}

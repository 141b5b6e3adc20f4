//! A simulated Franka robot for any client that speaks its protocol: `franka_sim::command_line` as
//! a binary.

use std::io::{IsTerminal, Write};
use std::process::ExitCode;

use clap::Parser;
use franka_sim::command_line::Arguments;

#[tokio::main(flavor = "current_thread")]
async fn main() -> ExitCode {
    tracing_subscriber::fmt()
        .with_writer(std::io::stderr)
        .with_ansi(has_colours())
        .with_target(false)
        .init();
    let ready = async |_: &_, lines: &str| writeln!(std::io::stdout(), "{lines}");
    match Arguments::parse().run(ready).await {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("franka-sim: {error}");
            ExitCode::FAILURE
        }
    }
}

/// True if the log has colours: on a terminal, unless NO_COLOR has a value.
fn has_colours() -> bool {
    let no_colour = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    std::io::stderr().is_terminal() && !no_colour
}

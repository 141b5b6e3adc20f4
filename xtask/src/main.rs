//! `cargo xtask test` runs the tests of this workspace. Every other task is passed on to the
//! package `xtask-tools`, which has more dependencies and is built on first use.

use std::env;
use std::ffi::OsString;
use std::process::ExitCode;

use lexopt::{Arg, Parser, ValueExt as _};
use xtask::step;
use xtask::test_steps::STEPS;
use xtask::workspace::Workspace;

fn main() -> ExitCode {
    let result = match env::args_os().nth(1) {
        Some(task) if task == "test" => test(),
        _ => pass_on(env::args_os().skip(1)),
    };
    match result {
        Ok(code) => code,
        Err(error) => {
            eprintln!("\nerror: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn test() -> anyhow::Result<ExitCode> {
    let mut only = Vec::new();
    let mut arguments = Parser::from_args(env::args_os().skip(2));
    while let Some(argument) = arguments.next()? {
        match argument {
            Arg::Long("only") => {
                let names = arguments.value()?.string()?;
                only.extend(names.split(',').map(str::to_owned));
            }
            Arg::Short('h') | Arg::Long("help") => {
                println!("{HELP}\n\nSteps:");
                for step in STEPS {
                    println!("  {:10} {}", step.name, step.about);
                }
                return Ok(ExitCode::SUCCESS);
            }
            unexpected => return Err(unexpected.unexpected().into()),
        }
    }
    step::run(&Workspace::find()?, STEPS, &only)?;
    Ok(ExitCode::SUCCESS)
}

fn pass_on(arguments: impl Iterator<Item = OsString>) -> anyhow::Result<ExitCode> {
    let workspace = Workspace::find()?;
    let mut command = workspace.cargo();
    command.args(["run", "--quiet", "--package", "xtask-tools"]);
    command
        .arg("--manifest-path")
        .arg(workspace.root().join("Cargo.toml"));
    command.arg("--").args(arguments);
    // Paths among the arguments are relative to the current directory.
    command.current_dir(env::current_dir()?);
    let status = command.status()?;
    Ok(match status.code() {
        Some(code) => u8::try_from(code).unwrap_or(1).into(),
        None => ExitCode::FAILURE,
    })
}

const HELP: &str = "\
Run the tests of this workspace, and stop at the first step that fails.

Usage: cargo xtask test [--only STEP[,STEP...]]

Options:
      --only STEP  Run these steps only
  -h, --help       Print this help

Example: cargo xtask test --only tests";

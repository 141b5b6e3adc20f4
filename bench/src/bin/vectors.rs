//! Runs every golden suite on a directory of vectors: `vectors [DIR]`.

use std::env;
use std::path::PathBuf;
use std::process::ExitCode;

use franka_tests::golden::{self, SUITES};

fn main() -> ExitCode {
    let own = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/vectors");
    let dir = PathBuf::from(env::args_os().nth(1).unwrap_or(own.into()));
    if !dir.is_dir() {
        eprintln!("{} is not a directory", dir.display());
        return ExitCode::from(2);
    }
    let outcomes = golden::run(&dir, SUITES);
    for outcome in &outcomes {
        println!("{outcome}");
    }
    let bad = outcomes.iter().filter(|outcome| outcome.failed()).count();
    let absent = outcomes.iter().filter(|outcome| outcome.absent()).count();
    let good = outcomes.len() - bad - absent;
    println!("{good} suites passed, {bad} failed, {absent} absent");
    if golden::failed(&outcomes) {
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

//! Selections of tests, and how they run.

use std::process::Stdio;

use crate::realtime;
use crate::step::Outcome;
use crate::workspace::Workspace;

/// Runs the tests of these targets of these packages that the filter of cargo-nextest selects.
/// Without cargo-nextest, `cargo test` runs all tests of the targets, one binary after the other.
///
/// # Errors
/// If a test fails or cannot be built.
pub fn tests(
    workspace: &Workspace,
    chosen: &[&str],
    targets: &[&str],
    filter: &str,
) -> anyhow::Result<Outcome> {
    let realtime = realtime::obtain();
    let mut nextest = workspace.cargo();
    nextest.args(["nextest", "--version"]);
    nextest.stdout(Stdio::null()).stderr(Stdio::null());
    let has_nextest = nextest.status().is_ok_and(|status| status.success());
    let mut command = workspace.cargo();
    if has_nextest {
        command.args(["nextest", "run"]);
        command.args(["--filterset", filter]);
    } else {
        println!("without cargo-nextest, one test binary after the other:");
        command.arg("test");
    }
    command.args(packages(chosen)).args(targets);
    if realtime.is_ok() {
        command.env(realtime::GRANTED, "1");
    }
    workspace.run(&mut command)?;
    Ok(match realtime {
        Ok(()) => Outcome::Passed,
        Err(why) => Outcome::Partly(why),
    })
}

/// The arguments that select packages.
pub fn packages(names: &[&str]) -> Vec<String> {
    names
        .iter()
        .map(|name| format!("--package={name}"))
        .collect()
}

/// Driver and simulator, without the parts that few programs need: recordings as tables, dashboard,
/// command line, Python.
pub const PACKAGES: [&str; 8] = [
    "franka-proto",
    "franka-model",
    "franka-otg",
    "franka-rt",
    "franka-diagnosis",
    "franka-sim",
    "franka-async",
    "franka-tests",
];

/// The live tests of connections, motions, control at 1 kHz and their ends.
pub const LIVE: &str = "binary(live) and \
     test(/^(cancelling|connecting|control|dropping|engaging|failing|fer|moving|starving)::/)";

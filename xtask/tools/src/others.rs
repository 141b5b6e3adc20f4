//! The packages whose tests `cargo xtask test` leaves out.

use std::process::Command;

use xtask::selection::packages;
use xtask::workspace::Workspace;

/// Builds and runs one test binary of the other packages, with the features of the step `rest`, to
/// reuse its build.
pub(crate) fn other_test(workspace: &Workspace, name: &str) -> Command {
    let mut test = workspace.cargo();
    test.args(["test", "--features=franka-cli/full,franka-examples/all"]);
    test.args(packages(&OTHERS));
    test.args(["--test", name, "--"]);
    test
}

/// The packages with tests, except the driver's and the simulator's.
pub(crate) const OTHERS: [&str; 10] = [
    "franka-bench",
    "franka-cli",
    "franka-dash",
    "franka-doctor",
    "franka-examples",
    "franka-lockstep",
    "franka-loom",
    "franka-record",
    "xtask",
    "xtask-tools",
];

//! The steps of `cargo xtask test`: the tests of the product, in the order in which they are likely
//! to fail.
//!
//! Tests that need more time or dependencies are steps of `cargo xtask check`, or of
//! `cargo xtask nightly`.

use crate::peers;
use crate::selection::{LIVE, PACKAGES, packages, tests};
use crate::step::{Outcome, Step, step};
use crate::workspace::Workspace;

/// All steps, in their order.
pub const STEPS: &[Step] = &[
    step(
        "tests",
        "unit, golden, lockstep, conformance and live tests",
        |workspace| {
            let filter = format!("not binary(live) or {LIVE}");
            tests(workspace, &PACKAGES, &TARGETS, &filter)
        },
    ),
    step("doctests", "the examples of the documentation", doctests),
    step(
        "client",
        "the vendor's Python client against the simulator",
        |workspace| peers::run(workspace, peers::Set::Smoke),
    ),
];

fn doctests(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let mut command = workspace.cargo();
    command.args(["test", "--quiet", "--doc"]);
    workspace.run(command.args(packages(&PACKAGES)))?;
    Ok(Outcome::Passed)
}

/// Test binaries of these packages: libraries and integration tests by name. Each further one links
/// driver and simulator again.
const TARGETS: [&str; 10] = [
    "--lib",
    "--test=conformance",
    "--test=golden_vectors",
    "--test=live",
    "--test=lockstep",
    "--test=models",
    "--test=no_alloc",
    "--test=protocol",
    "--test=robot",
    "--test=thread",
];

//! The steps of `cargo xtask test`: the tests of the product, in the order in which they are likely
//! to fail.
//!
//! Tests that need more time or dependencies are steps of `cargo xtask check`, or of
//! `cargo xtask nightly`.

use std::str::FromStr;

use anyhow::bail;

use crate::peers;
use crate::selection::{LIVE, PACKAGES, packages, tests};
use crate::step::{Outcome, Steps};
use crate::workspace::Workspace;

/// A step that can be chosen with `--only`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Unit, property, golden, lockstep and conformance tests, and a live set.
    Tests,
    /// The examples of the documentation.
    Doctests,
    /// The vendor's client against the simulator.
    Client,
}

impl Step {
    /// All steps, in their order.
    pub const ALL: [Self; 3] = [Self::Tests, Self::Doctests, Self::Client];

    /// The name of the step for `--only`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tests => "tests",
            Self::Doctests => "doctests",
            Self::Client => "client",
        }
    }

    /// One line of description.
    pub fn about(self) -> &'static str {
        match self {
            Self::Tests => "unit, golden, lockstep, conformance and live tests",
            Self::Doctests => "the examples of the documentation",
            Self::Client => "the vendor's Python client against the simulator",
        }
    }

    fn run(self, workspace: &Workspace) -> anyhow::Result<Outcome> {
        match self {
            Self::Tests => {
                let filter = format!("not binary(live) or {LIVE}");
                tests(workspace, &PACKAGES, &TARGETS, &filter)
            }
            Self::Doctests => {
                let mut command = workspace.cargo();
                command.args(["test", "--quiet", "--doc"]);
                workspace.run(command.args(packages(&PACKAGES)))?;
                Ok(Outcome::Passed)
            }
            Self::Client => peers::run(workspace, peers::Set::Smoke),
        }
    }
}

impl FromStr for Step {
    type Err = anyhow::Error;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match Self::ALL.into_iter().find(|step| step.name() == name) {
            Some(step) => Ok(step),
            None => bail!(
                "got the step `{name}`, expected one of {}; the other checks are steps of `cargo xtask check`",
                Self::ALL.map(Self::name).join(", ")
            ),
        }
    }
}

/// Runs the chosen steps, or all if none is chosen, up to the first failure.
///
/// # Errors
/// The error of the first step that fails.
pub fn run(workspace: &Workspace, only: &[Step]) -> anyhow::Result<()> {
    let mut steps = Steps::default();
    for step in Step::ALL {
        if only.is_empty() || only.contains(&step) {
            steps.take(step.name(), step.about(), || step.run(workspace))?;
        }
    }
    println!("\n{}", steps.summary());
    Ok(())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_have_names_that_parse() {
        for step in Step::ALL {
            assert_eq!(step.name().parse::<Step>().unwrap(), step);
        }
        let error = "clippy".parse::<Step>().unwrap_err().to_string();
        assert!(
            error.starts_with("got the step `clippy`, expected"),
            "{error}"
        );
    }
}

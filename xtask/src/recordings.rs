//! Recordings, read by the standard reader in Python.

use crate::mujoco;
use crate::python::{NEWEST, Python, Version};
use crate::step::Outcome;
use crate::workspace::Workspace;

/// Installs the reader in a virtual environment of its own, and has it decode recordings of both
/// robots.
pub(crate) fn run(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let python = match Python::find(OLDEST..=NEWEST) {
        Ok(python) => python,
        Err(why) => return Outcome::without(why),
    };
    let requirements = workspace.root().join("franka-record/tests/python");
    let requirements = requirements.join("requirements.txt");
    let interpreter = python.environment(workspace, "python-recordings", &requirements)?;
    let mut test = workspace.cargo();
    // With the features of the step that runs all tests: what it has built is used again.
    test.args(["test", "--workspace", "--test=recording", "--features"]);
    test.arg(mujoco::features(workspace)?).arg("--");
    test.args(["--ignored", "--nocapture", "python_decodes"]);
    workspace.run(test.env("FRANKA_RECORD_PYTHON", interpreter))?;
    Ok(Outcome::Passed)
}

/// The oldest Python that the packages have wheels for.
const OLDEST: Version = (3, 10);

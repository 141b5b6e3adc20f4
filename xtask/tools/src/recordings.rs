//! Recordings and datasets, read by the standard readers in Python.

use crate::others;
use xtask::python;
use xtask::step::Outcome;
use xtask::workspace::Workspace;

/// Installs the readers in a separate virtual environment, and decodes recordings of both robots
/// and a dataset with them. LeRobot's own loader, which is large, also reads the dataset if
/// `FRANKA_LEROBOT_PYTHON` names an interpreter that has it.
pub(crate) fn run(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let requirements = "franka-record/tests/python/requirements.txt";
    let interpreter = python::environment(workspace, "python-recordings", requirements)?;
    let mut test = others::other_test(workspace, "recording");
    test.args(["--ignored", "--nocapture", "python_"]);
    workspace.run(test.env("FRANKA_RECORD_PYTHON", interpreter))?;
    Ok(Outcome::Passed)
}

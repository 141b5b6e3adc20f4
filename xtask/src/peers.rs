//! Other clients against the simulator: pytest runs `tests/peers`, several scripts at once.

use std::env;
use std::path::PathBuf;

use anyhow::bail;

use crate::python::Uv;
use crate::selection::{PACKAGES, packages};
use crate::step::{Missing, Outcome};
use crate::workspace::Workspace;

/// A choice of clients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Set {
    /// The vendor's client: set-up, motions, torques, reflexes, the hand.
    Smoke,
    /// All others: further scripts, franka-rs, a cassette.
    Rest,
}

/// Runs the vendor's client, and with [`Set::Rest`] also our client beside other ones, against
/// simulators: as many at once as there are processors.
///
/// # Errors
/// If a program fails, or the machine lacks a requirement of the vendor's client.
pub fn run(workspace: &Workspace, set: Set) -> anyhow::Result<Outcome> {
    let interpreter = interpreter(workspace)?;
    // The simulator as the tests build it, to reuse their build: Cargo builds the binaries of a
    // package with its integration tests.
    let mut build = workspace.cargo();
    build.args(["test", "--no-run", "--quiet", "--test=robot"]);
    workspace.run(build.args(packages(&PACKAGES)))?;
    if set == Set::Rest {
        let mut build = workspace.cargo();
        build.args(["build", "--quiet", "--package", "franka-bench"]);
        workspace.run(build.args(["--bin=beside_franka_rs", "--bin=cassette_peer"]))?;
        // A separate workspace, which reuses the common part of this one's build.
        let mut build = workspace.cargo();
        build.args(["build", "--quiet", "--locked", "--manifest-path"]);
        build.arg(directory(workspace).join("franka_rs/Cargo.toml"));
        workspace.run(build.arg("--target-dir").arg(workspace.target()))?;
    }
    let mut test = workspace.program(interpreter);
    test.env("FRANKA_PROGRAMS", workspace.target().join("debug"));
    test.args(["-m", "pytest", "--numprocesses=auto", "--durations=0", "-m"]);
    test.arg(match set {
        Set::Smoke => "smoke",
        Set::Rest => "not smoke",
    });
    workspace.run(test.arg(directory(workspace)))?;
    Ok(Outcome::Passed)
}

/// A Python interpreter with the vendor's client.
///
/// # Errors
/// If the client cannot be installed, or has no wheels for this machine.
pub fn interpreter(workspace: &Workspace) -> anyhow::Result<PathBuf> {
    let (system, machine) = (env::consts::OS, env::consts::ARCH);
    if (system, machine) != ("linux", "x86_64") {
        bail!(Missing(format!(
            "pylibfranka has wheels for Linux on x86-64 only, this is {system} on {machine}"
        )));
    }
    let requirements = directory(workspace).join("requirements.txt");
    Uv::find(workspace)?.environment(workspace, "python", PYTHON, &requirements)
}

/// Directory of the scripts.
pub fn directory(workspace: &Workspace) -> PathBuf {
    workspace.root().join("tests").join("peers")
}

/// Versions of Python with wheels of the vendor.
const PYTHON: &str = ">=3.9,<3.13";

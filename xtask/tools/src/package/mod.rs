//! The Python package: builds its wheel, installs it into a separate virtual environment, and runs
//! its tests and the checks of its types and of its [`wheels`].

pub(crate) mod wheels;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

use anyhow::Context as _;

use xtask::python::{ANY, Uv};
use xtask::step::Outcome;
use xtask::workspace::Workspace;

/// Builds and installs the package and the requirements of its tests. Returns the interpreter that
/// has them.
pub(crate) fn prepare(workspace: &Workspace) -> anyhow::Result<PathBuf> {
    // The profile of the tests, in which the computations of a cycle are optimised.
    Ok(install(workspace, "python-package", ANY, "tests", "dev")?.0)
}

/// Builds the package optimised and installs it together with the packages for comparison. Returns
/// the interpreter that has them.
pub(crate) fn prepare_bench(workspace: &Workspace) -> anyhow::Result<PathBuf> {
    // Some packages have no wheels for newer versions, but ours does.
    let of_all = ">=3.10,<3.13";
    let has_them = Uv::find(workspace)?.has(of_all);
    let versions = if has_them { of_all } else { ANY };
    Ok(install(workspace, "python-bench", versions, "bench", "dist")?.0)
}

/// Builds the package and installs it in a virtual environment with the requirements in one of its
/// directories; returns the interpreter and the wheel.
fn install(
    workspace: &Workspace,
    environment: &str,
    versions: &str,
    requirements: &str,
    profile: &str,
) -> anyhow::Result<(PathBuf, PathBuf)> {
    let uv = Uv::find(workspace)?;
    let requirements = directory(workspace)
        .join(requirements)
        .join("requirements.txt");
    let interpreter = uv.environment(workspace, environment, versions, &requirements)?;
    let options = ["--interpreter", interpreter.to_str().context("path")?];
    let wheel = wheels::maturin(workspace, &interpreter, profile, "here", &options)?;
    let mut install = uv.pip(workspace, "install", &interpreter);
    install.args(["--reinstall", "--no-deps", "--no-index"]);
    workspace.run(install.arg(&wheel))?;
    Ok((interpreter, wheel))
}

/// Runs the tests and the checks of the types at the same time.
pub(crate) fn run(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let (interpreter, wheel) = install(workspace, "python-package", ANY, "tests", "dev")?;
    thread::scope(|scope| {
        let beside = scope.spawn(|| {
            types(workspace, &interpreter)?;
            println!("{}", wheels::import(workspace, &wheel)?);
            anyhow::Ok(Outcome::Passed)
        });
        let mut tests = module(workspace, &interpreter, "pytest");
        // Most tests mostly wait. A finished worker takes over tests of the others.
        tests.args(["--quiet", "-n", "4", "--dist", "worksteal"]);
        tests.arg("franka-py/tests");
        workspace.run(&mut tests)?;
        beside.join().expect("no panic")
    })
}

/// Checks the tests and examples against the stubs, and the stubs against the package.
fn types(workspace: &Workspace, interpreter: &Path) -> anyhow::Result<()> {
    let mut check = module(workspace, interpreter, "mypy");
    check.args(["--strict", "--config-file", "franka-py/pyproject.toml"]);
    check.args(["franka-py/tests", "franka-py/examples"]);
    workspace.run(&mut check)?;
    let mut stubs = module(workspace, interpreter, "mypy.stubtest");
    stubs.args(["--mypy-config-file", "franka-py/pyproject.toml"]);
    stubs.args(["--allowlist", "franka-py/tests/stubs.allowed"]);
    // The other modules contain their types.
    workspace.run(stubs.args(["franka_async._native", "franka_async.sync"]))
}

/// Runs a module of the virtual environment as a program.
pub(crate) fn module(workspace: &Workspace, interpreter: &Path, name: &str) -> Command {
    let mut command = workspace.program(interpreter);
    command.args(["-m", name]);
    command
}

/// Directory of the package.
pub(crate) fn directory(workspace: &Workspace) -> PathBuf {
    workspace.root().join("franka-py")
}

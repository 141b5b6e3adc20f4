//! The Python package: builds its wheel, installs it into a separate virtual environment, and runs
//! its tests and the checks of its types and of its [`wheels`].

pub(crate) mod wheels;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

use xtask::python::{ANY, Uv};
use xtask::step::Outcome;
use xtask::workspace::Workspace;

/// Builds and installs the package and the requirements of its tests. Returns the interpreter that
/// has them, or the reason why none is available.
pub(crate) fn prepare(workspace: &Workspace) -> anyhow::Result<Result<PathBuf, String>> {
    // The profile of the tests, in which the computations of a cycle are optimised.
    match Uv::find(workspace)? {
        Ok(uv) => install(workspace, &uv, "python-package", ANY, "tests", "dev"),
        Err(why) => Ok(Err(why)),
    }
}

/// Builds the package optimised and installs it together with the packages for comparison. Returns
/// the interpreter that has them, or the reason why none is available.
pub(crate) fn prepare_bench(workspace: &Workspace) -> anyhow::Result<Result<PathBuf, String>> {
    let uv = match Uv::find(workspace)? {
        Ok(uv) => uv,
        Err(why) => return Ok(Err(why)),
    };
    // Some packages have no wheels for newer versions, but ours does.
    let of_all = ">=3.10,<3.13";
    let versions = if uv.has(of_all) { of_all } else { ANY };
    install(workspace, &uv, "python-bench", versions, "bench", "dist")
}

/// Builds the package and installs it in a virtual environment with the requirements in one of its
/// directories; returns the interpreter.
fn install(
    workspace: &Workspace,
    uv: &Uv,
    environment: &str,
    versions: &str,
    requirements: &str,
    profile: &str,
) -> anyhow::Result<Result<PathBuf, String>> {
    let requirements = directory(workspace)
        .join(requirements)
        .join("requirements.txt");
    let environment = uv.environment(workspace, environment, versions, &requirements)?;
    let interpreter = match environment {
        Ok(interpreter) => interpreter,
        Err(why) => return Ok(Err(why)),
    };
    let wheels = built(workspace, profile);
    if wheels.exists() {
        // A wheel of an earlier version must not be mistaken for this one.
        fs::remove_dir_all(&wheels)?;
    }
    let mut build = module(workspace, &interpreter, "maturin");
    build.args(["build", "--quiet", "--locked", "--profile", profile]);
    build.args(["--manifest-path", "franka-py/Cargo.toml", "--out"]);
    build.arg(&wheels).arg("--interpreter").arg(&interpreter);
    build.env("CARGO_TARGET_DIR", workspace.target());
    workspace.run(&mut build)?;
    let mut install = uv.pip(workspace, "install", &interpreter);
    install.args(["--reinstall", "--no-deps", "--no-index", "--find-links"]);
    workspace.run(install.arg(&wheels).arg("franka-async"))?;
    Ok(Ok(interpreter))
}

/// Runs the tests and the checks of the types at the same time.
pub(crate) fn run(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let interpreter = match prepare(workspace)? {
        Ok(interpreter) => interpreter,
        Err(why) => return Outcome::without(why),
    };
    thread::scope(|scope| {
        let beside = scope.spawn(|| {
            types(workspace, &interpreter)?;
            let wheel = wheels::only_wheel(&built(workspace, "dev"))?;
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

/// Directory of the wheel for this machine.
fn built(workspace: &Workspace, profile: &str) -> PathBuf {
    workspace.target().join("wheels").join(profile)
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

//! `cargo xtask wheels`: wheels of the Python package, built by maturin with zig, for every
//! platform that this machine can build for. This machine's wheel is imported by every installed
//! Python.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail, ensure};

use crate::cross::{STD, lacks, path_with};
use crate::package::{directory, module};
use xtask::python::{self, Uv};
use xtask::step::{Missing, or_missing};
use xtask::workspace::Workspace;

/// The platforms, the most common first, and the oldest C library that each supports. maturin fails
/// if a wheel needs a newer one.
const PLATFORMS: [(&str, &str); 4] = [
    ("x86_64-unknown-linux-gnu", "manylinux2014"),
    ("x86_64-unknown-linux-musl", "musllinux_1_2"),
    ("aarch64-unknown-linux-gnu", "manylinux2014"),
    ("aarch64-unknown-linux-musl", "musllinux_1_2"),
];

/// Builds the optimised wheels of all platforms, or of the chosen ones, and reports the result of
/// each. Fails if no wheel was built; with `CI=true`, fails if any was not built.
pub(crate) fn run(workspace: &Workspace, only: &[String]) -> anyhow::Result<()> {
    let is_chosen = |target: &str| only.is_empty() || only.iter().any(|it| it == target);
    let chosen = PLATFORMS.iter().filter(|(target, _)| is_chosen(target));
    let (mut built, mut lines) = (0, Vec::new());
    for (target, compatibility) in chosen.clone() {
        lines.push(match or_missing(build(workspace, target, compatibility))? {
            Ok(wheel) => {
                built += 1;
                let by = match *target == this_machine() {
                    true => import(workspace, &wheel)?,
                    false => "NOT IMPORTED: it is for another machine".to_owned(),
                };
                format!("{}: {by}", wheel.display())
            }
            Err(why) => format!("{target}: NOT BUILT: {why}"),
        });
    }
    println!("\n{}", lines.join("\n"));
    ensure!(built > 0, "no wheel was built");
    ensure!(
        built == chosen.count() || !xtask::workspace::is_ci(),
        "with CI=true every chosen wheel has to be built"
    );
    Ok(())
}

/// The optimised wheel for this machine.
pub(crate) fn for_this_machine(workspace: &Workspace) -> anyhow::Result<PathBuf> {
    let this = this_machine();
    match PLATFORMS.iter().find(|(target, _)| *target == this) {
        Some((target, compatibility)) => build(workspace, target, compatibility),
        None => bail!(Missing(format!("no wheels are made for {this}"))),
    }
}

fn this_machine() -> String {
    let libc = match cfg!(target_env = "musl") {
        true => "musl",
        false => "gnu",
    };
    format!("{}-unknown-{}-{libc}", env::consts::ARCH, env::consts::OS)
}

/// The wheel for a platform.
fn build(workspace: &Workspace, target: &str, compatibility: &str) -> anyhow::Result<PathBuf> {
    if let Some(why) = lacks(target, STD) {
        bail!(Missing(why));
    }
    let requirements = "franka-py/wheels/build.txt";
    let interpreter = python::environment(workspace, "python-wheels", requirements)?;
    let target = [
        "--target",
        target,
        "--compatibility",
        compatibility,
        "--zig",
    ];
    maturin(workspace, &interpreter, "dist", target[1], &target)
}

/// Builds a wheel in a separate directory, which it returns.
pub(crate) fn maturin(
    workspace: &Workspace,
    interpreter: &Path,
    profile: &str,
    name: &str,
    options: &[&str],
) -> anyhow::Result<PathBuf> {
    let out = workspace.target().join("wheels").join(name).join(profile);
    // A wheel of an earlier version must not be mistaken for this one.
    if out.exists() {
        fs::remove_dir_all(&out)?;
    }
    let mut build = module(workspace, interpreter, "maturin");
    build.args(["build", "--quiet", "--locked", "--profile", profile]);
    build.args(["--manifest-path", "franka-py/Cargo.toml", "--out"]);
    build.arg(&out).args(options);
    build.env("CARGO_TARGET_DIR", workspace.target());
    if options.contains(&"--zig") {
        build.env("PATH", path_with(interpreter)?);
    }
    workspace.run(&mut build)?;
    only_wheel(&out)
}

/// The only wheel in a directory, for every Python.
pub(crate) fn only_wheel(directory: &Path) -> anyhow::Result<PathBuf> {
    let mut wheels = Vec::new();
    for entry in fs::read_dir(directory)? {
        wheels.push(entry?.path());
    }
    let [wheel] = &wheels[..] else {
        bail!("expected one wheel in {}", directory.display());
    };
    let name = wheel.file_name().context("a file has a name")?;
    ensure!(
        name.to_string_lossy().contains("-cp310-abi3-"),
        "the wheel {} is not for every Python",
        wheel.display()
    );
    Ok(wheel.clone())
}

/// Installs a wheel into an environment of each Python of this machine, and imports it there.
/// Returns their versions.
pub(crate) fn import(workspace: &Workspace, wheel: &Path) -> anyhow::Result<String> {
    let uv = Uv::find(workspace)?;
    let requirements = directory(workspace).join("wheels/import.txt");
    let mut by = Vec::new();
    let versions = (10..=14).map(|minor| format!("3.{minor}"));
    for version in versions.filter(|version| uv.has(version)) {
        let name = format!("python-imports/{version}");
        let interpreter = uv.environment(workspace, &name, &version, &requirements)?;
        let mut install = uv.pip(workspace, "install", &interpreter);
        install.args(["--reinstall", "--no-deps", "--no-index"]);
        workspace.run(install.arg(wheel))?;
        workspace.run(workspace.program(&interpreter).args(["-c", PROGRAM]))?;
        by.push(version);
    }
    ensure!(!by.is_empty(), "there is no Python to import it with");
    Ok(format!("imported by Python {}", by.join(", ")))
}

/// Calls into the native module, with arrays in both directions.
const PROGRAM: &str =
    "import franka_async as f; assert f.Model.fr3().pose('flange', f.READY).shape == (4, 4)";

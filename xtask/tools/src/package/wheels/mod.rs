//! `cargo xtask wheels`: wheels of the Python package for every platform that this machine can
//! build for, checked by their names and, where they can run, by importing them.
//!
//! ```text
//! standard library of the target? ── maturin --zig ──> wheel ── name says abi3, platform? ── import:
//!    this machine ── each Python that is installed, in a virtual environment
//!    another one ── qemu, in a directory that FRANKA_PYTHON_ROOT_<TARGET> names
//! ```
//!
//! | module | content |
//! |---|---|
//! | this | platforms, and building for them |
//! | `import` | importing a wheel, here and under qemu |

mod import;

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail, ensure};

use crate::cross::{architecture, lacks, path_with, sysroot};
use crate::package::{directory, module};
use import::{Imported, import, import_here};
use xtask::python::{NEWEST, OLDEST, Python};
use xtask::step::Outcome;
use xtask::workspace::Workspace;

/// Platform of a wheel.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Platform {
    target: &'static str,
    /// Compatibility for maturin: the oldest supported C library.
    compatibility: &'static str,
    /// End of the wheel's name.
    tag: &'static str,
}

/// The platforms, the most common first.
pub(crate) const PLATFORMS: [Platform; 4] = [
    Platform {
        target: "x86_64-unknown-linux-gnu",
        compatibility: "manylinux2014",
        tag: "manylinux2014_x86_64.manylinux_2_17_x86_64",
    },
    Platform {
        target: "x86_64-unknown-linux-musl",
        compatibility: "musllinux_1_2",
        tag: "musllinux_1_2_x86_64",
    },
    Platform {
        target: "aarch64-unknown-linux-gnu",
        compatibility: "manylinux2014",
        tag: "manylinux2014_aarch64.manylinux_2_17_aarch64",
    },
    Platform {
        target: "aarch64-unknown-linux-musl",
        compatibility: "musllinux_1_2",
        tag: "musllinux_1_2_aarch64",
    },
];

/// Builds the optimised wheels of all platforms, or of the chosen ones, and reports the result of
/// each. Fails if no wheel was built; with `CI=true`, fails if any was not built.
pub(crate) fn run(workspace: &Workspace, only: &[String]) -> anyhow::Result<()> {
    let is_chosen = |platform: &&Platform| {
        only.is_empty() || only.iter().any(|target| target == platform.target)
    };
    let chosen: Vec<&Platform> = PLATFORMS.iter().filter(is_chosen).collect();
    ensure!(!chosen.is_empty(), "the targets are {}", targets());
    let (mut built, mut lines) = (0, Vec::new());
    for platform in chosen {
        let line = match build(workspace, platform, "dist")? {
            Ok(wheel) => {
                built += 1;
                let name = name_of(&wheel)?.to_owned();
                format!("{name}: {}", import(workspace, platform, &wheel)?)
            }
            Err(why) => format!("{}: NOT BUILT: {why}", platform.target),
        };
        lines.push(line);
    }
    println!("\n{}", lines.join("\n"));
    ensure!(built > 0, "no wheel was built");
    let is_missing = lines.iter().any(|line| line.contains("NOT BUILT"));
    ensure!(
        !(is_missing && xtask::step::is_ci()),
        "with CI=true every chosen wheel must be built"
    );
    Ok(())
}

/// The optimised wheel for this machine, or the missing requirement to build it.
pub(crate) fn for_this_machine(workspace: &Workspace) -> anyhow::Result<Result<PathBuf, String>> {
    match PLATFORMS.iter().find(|it| it.is_of_this_machine()) {
        Some(platform) => build(workspace, platform, "dist"),
        None => Ok(Err(format!(
            "got this machine, expected one of {}",
            targets()
        ))),
    }
}

/// The step `python`: imports the wheel of this machine, which is already built, with every
/// installed Python, and builds the wheels for other machines if possible.
pub(crate) fn check(workspace: &Workspace, wheel: &Path) -> anyhow::Result<Outcome> {
    let mut unchecked = Vec::new();
    for platform in &PLATFORMS {
        if platform.is_of_this_machine() {
            println!("{}: {}", name_of(wheel)?, import_here(workspace, wheel)?);
            continue;
        }
        match build(workspace, platform, "dev")? {
            Ok(wheel) => {
                let imported = import(workspace, platform, &wheel)?;
                println!("{}: {imported}", name_of(&wheel)?);
                if let Imported::Not(why) = imported {
                    unchecked.push(format!(
                        "{} was built and not imported: {why}",
                        platform.target
                    ));
                }
            }
            Err(why) => unchecked.push(format!("no wheel for {}: {why}", platform.target)),
        }
    }
    Ok(match unchecked.is_empty() {
        true => Outcome::Passed,
        false => Outcome::Partly(unchecked.join("; ")),
    })
}

impl Platform {
    fn is_of_this_machine(&self) -> bool {
        let libc = match cfg!(target_env = "musl") {
            true => "musl",
            false => "gnu",
        };
        architecture(self.target) == env::consts::ARCH && self.target.ends_with(libc)
    }

    /// Fails unless the name declares this platform, and every Python.
    fn check_name(&self, name: &str) -> anyhow::Result<()> {
        let (major, minor) = OLDEST;
        let expected = format!("-cp{major}{minor}-abi3-{}.whl", self.tag);
        ensure!(
            name.ends_with(&expected),
            "the wheel is {name}, expected a name that ends with {expected}"
        );
        Ok(())
    }
}

/// The wheel for a platform, or the missing requirement to build it.
fn build(
    workspace: &Workspace,
    platform: &Platform,
    profile: &str,
) -> anyhow::Result<Result<PathBuf, String>> {
    if let Some(why) = lacks(platform.target, &sysroot()?) {
        return Ok(Err(why));
    }
    let python = match Python::find(OLDEST..=NEWEST) {
        Ok(python) => python,
        Err(why) => return Ok(Err(why)),
    };
    let requirements = directory(workspace).join("wheels/build.txt");
    let interpreter = python.environment(workspace, "python-wheels", &requirements)?;
    let out = workspace
        .target()
        .join("wheels")
        .join(platform.target)
        .join(profile);
    // A wheel of an earlier version must not be mistaken for this one.
    if out.exists() {
        fs::remove_dir_all(&out)?;
    }
    let mut build = module(workspace, &interpreter, "maturin");
    build.args([
        "build",
        "--quiet",
        "--locked",
        "--zig",
        "--profile",
        profile,
    ]);
    build.args([
        "--target",
        platform.target,
        "--compatibility",
        platform.compatibility,
    ]);
    build.args(["--manifest-path", "franka-py/Cargo.toml", "--out"]);
    build.arg(&out).env("CARGO_TARGET_DIR", workspace.target());
    build.env("PATH", path_with(&interpreter)?);
    workspace.run(&mut build)?;
    let wheel = only_wheel(&out)?;
    platform.check_name(name_of(&wheel)?)?;
    Ok(Ok(wheel))
}

/// The only wheel in a directory.
pub(crate) fn only_wheel(directory: &Path) -> anyhow::Result<PathBuf> {
    let mut wheels = Vec::new();
    for entry in fs::read_dir(directory)? {
        wheels.push(entry?.path());
    }
    wheels.retain(|path| path.extension().is_some_and(|end| end == "whl"));
    match <[PathBuf; 1]>::try_from(wheels) {
        Ok([wheel]) => Ok(wheel),
        Err(wheels) => bail!(
            "{} has {} wheels, expected one",
            directory.display(),
            wheels.len()
        ),
    }
}

fn name_of(wheel: &Path) -> anyhow::Result<&str> {
    let name = wheel.file_name().and_then(|name| name.to_str());
    name.with_context(|| format!("{} is no wheel", wheel.display()))
}

fn targets() -> String {
    PLATFORMS.map(|platform| platform.target).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn platform(target: &str) -> &'static Platform {
        let mut platforms = PLATFORMS.iter();
        platforms.find(|it| it.target == target).expect("it is one")
    }

    #[test]
    fn a_wheel_is_named_after_its_platform_and_every_python() {
        let gnu = platform("x86_64-unknown-linux-gnu");
        let tag = "manylinux2014_x86_64.manylinux_2_17_x86_64";
        gnu.check_name(&format!("franka_async-0.1.0-cp310-abi3-{tag}.whl"))
            .unwrap();
        for wrong in [
            format!("franka_async-0.1.0-cp311-cp311-{tag}.whl"),
            "franka_async-0.1.0-cp310-abi3-linux_x86_64.whl".to_owned(),
            "franka_async-0.1.0-cp310-abi3-manylinux_2_36_x86_64.whl".to_owned(),
        ] {
            assert!(gnu.check_name(&wrong).is_err(), "{wrong}");
        }
    }

    /// A new directory for one test.
    pub(super) fn tempdir(name: &str) -> PathBuf {
        let name = format!("franka-xtask-{}-{name}", std::process::id());
        let directory = env::temp_dir().join(name);
        fs::create_dir_all(&directory).unwrap();
        directory
    }
}

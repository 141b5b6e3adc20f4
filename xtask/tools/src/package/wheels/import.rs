//! Importing a wheel: with every Python of this machine, or under qemu.

use std::env;
use std::path::{Path, PathBuf};

use anyhow::ensure;

use super::Platform;
use crate::cross::{architecture, emulator, is_installed};
use crate::package::{directory, module};
use xtask::python::{NEWEST, OLDEST, Python};
use xtask::workspace::Workspace;

/// Result of importing a wheel.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Imported {
    /// Imported by these interpreters.
    By(String),
    /// Not imported, for this reason.
    Not(String),
}

impl std::fmt::Display for Imported {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::By(what) => write!(f, "imported by {what}"),
            Self::Not(why) => write!(f, "NOT IMPORTED: {why}"),
        }
    }
}

pub(super) fn import(
    workspace: &Workspace,
    platform: &Platform,
    wheel: &Path,
) -> anyhow::Result<Imported> {
    if platform.is_of_this_machine() {
        return import_here(workspace, wheel).map(Imported::By);
    }
    let root = env::var_os(platform.root_variable()).map(PathBuf::from);
    let (emulator, root) = match platform.emulated(is_installed, root) {
        Ok(found) => found,
        Err(why) => return Ok(Imported::Not(why)),
    };
    let unpacked = wheel.with_extension("unpacked");
    let mut unpack = workspace.program("python3");
    unpack
        .args(["-m", "zipfile", "--extract"])
        .arg(wheel)
        .arg(&unpacked);
    workspace.run(&mut unpack)?;
    let mut import = workspace.program(&emulator);
    import
        .arg("-L")
        .arg(&root)
        .arg(root.join(PYTHON))
        .args(["-c", PROGRAM]);
    import.env(
        "PYTHONPATH",
        env::join_paths([&unpacked, &root.join(DIST_PACKAGES)])?,
    );
    workspace.run(&mut import)?;
    Ok(Imported::By(emulator))
}

/// Installs a wheel into an environment of each Python of this machine, and imports it there.
/// Returns their versions.
pub(super) fn import_here(workspace: &Workspace, wheel: &Path) -> anyhow::Result<String> {
    let pythons = Python::all(OLDEST..=NEWEST);
    ensure!(!pythons.is_empty(), "there is no Python to import it with");
    let requirements = directory(workspace).join("wheels/import.txt");
    let mut by = Vec::new();
    for python in pythons {
        let (major, minor) = python.version();
        let version = format!("{major}.{minor}");
        let environment = format!("python-imports/{version}");
        let interpreter = python.environment(workspace, &environment, &requirements)?;
        let mut install = module(workspace, &interpreter, "pip");
        install.args([
            "install",
            "--quiet",
            "--force-reinstall",
            "--no-deps",
            "--no-index",
        ]);
        workspace.run(install.arg("--disable-pip-version-check").arg(wheel))?;
        workspace.run(workspace.program(&interpreter).args(["-c", PROGRAM]))?;
        by.push(version);
    }
    Ok(format!("Python {}", by.join(", ")))
}

impl Platform {
    /// The environment variable that names a root directory with a Python of this platform.
    fn root_variable(&self) -> String {
        format!(
            "FRANKA_PYTHON_ROOT_{}",
            self.target.replace('-', "_").to_uppercase()
        )
    }

    /// The emulator and the root directory with which its programs run here, or the missing
    /// requirement.
    fn emulated(
        &self,
        has: impl Fn(&str) -> bool,
        root: Option<PathBuf>,
    ) -> Result<(String, PathBuf), String> {
        let emulator = emulator(architecture(self.target), has)?;
        let variable = self.root_variable();
        let root = root.ok_or(format!(
            "{variable} names no root directory with its Python and numpy"
        ))?;
        match root.join(PYTHON).exists() {
            true => Ok((emulator, root)),
            false => Err(format!(
                "{variable} is {}, which has no {PYTHON}",
                root.display()
            )),
        }
    }
}

/// Path of Python in a root directory.
const PYTHON: &str = "usr/bin/python3";

/// Debian's directory of packages for it; other systems have them on Python's default path.
const DIST_PACKAGES: &str = "usr/lib/python3/dist-packages";

/// Calls into the native module, with arrays in both directions.
const PROGRAM: &str =
    "import franka_async as f; assert f.Model.fr3().pose('flange', f.READY).shape == (4, 4)";

#[cfg(test)]
mod tests {
    use std::fs;

    use super::super::tests::{platform, tempdir};
    use super::*;

    #[test]
    fn an_import_elsewhere_needs_an_emulator_and_a_python() {
        let arm = platform("aarch64-unknown-linux-gnu");
        let why = arm.emulated(|_| false, None).unwrap_err();
        assert_eq!(why, "qemu-aarch64-static is not installed");
        let why = arm
            .emulated(|name| name == "qemu-aarch64", None)
            .unwrap_err();
        assert!(
            why.starts_with("FRANKA_PYTHON_ROOT_AARCH64_UNKNOWN_LINUX_GNU names no"),
            "{why}"
        );
        let root = tempdir("root");
        let why = arm.emulated(|_| true, Some(root.clone())).unwrap_err();
        assert!(why.ends_with("which has no usr/bin/python3"), "{why}");
        fs::create_dir_all(root.join("usr/bin")).unwrap();
        fs::write(root.join(PYTHON), "").unwrap();
        let found = arm.emulated(|name| name == "qemu-aarch64", Some(root.clone()));
        assert_eq!(found, Ok(("qemu-aarch64".to_owned(), root.clone())));
        fs::remove_dir_all(root).unwrap();
    }
}

//! Builds for other machines, and runs the results.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, ensure};

use xtask::python;
use xtask::step::Outcome;
use xtask::workspace::Workspace;

/// The directory of the compiler's libraries.
pub(crate) fn sysroot() -> anyhow::Result<PathBuf> {
    let output = Command::new("rustc")
        .args(["--print", "sysroot"])
        .output()?;
    ensure!(output.status.success(), "rustc does not report its sysroot");
    Ok(String::from_utf8(output.stdout)?.trim().into())
}

/// The part of a toolchain's sysroot that is missing to build for a target, if any.
pub(crate) fn lacks(target: &str, sysroot: &Path) -> Option<String> {
    let libraries = sysroot.join("lib/rustlib").join(target).join("lib");
    let is_std = |entry: fs::DirEntry| {
        let name = entry.file_name().to_string_lossy().into_owned();
        name.starts_with("libstd-") && name.ends_with(".rlib")
    };
    let has_std = fs::read_dir(&libraries)
        .is_ok_and(|mut entries| entries.any(|entry| entry.is_ok_and(is_std)));
    (!has_std).then(|| {
        format!("its standard library is not installed; `rustup target add {target}` installs it")
    })
}

/// The step `targets`: checks the portable parts for other systems and machines, if the toolchain
/// has their standard library.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let sysroot = sysroot()?;
    let (there, missing): (Vec<_>, Vec<_>) = TARGETS
        .into_iter()
        .partition(|(target, _)| lacks(target, &sysroot).is_none());
    let missing: Vec<&str> = missing.iter().map(|(target, _)| *target).collect();
    let missing = format!("not installed: `rustup target add {}`", missing.join(" "));
    if there.is_empty() {
        return Ok(Outcome::Skipped(missing));
    }
    let path = match zig(workspace)? {
        Ok(path) => path,
        Err(why) => return Outcome::without(why),
    };
    for (target, what) in &there {
        // zig compiles the parts in C.
        let mut check = workspace.program("cargo-zigbuild");
        check
            .args(["check", "--locked", "--target", target])
            .args(*what);
        workspace.run(check.env("PATH", &path))?;
    }
    Ok(match there.len() == TARGETS.len() {
        true => Outcome::Passed,
        false => Outcome::Partly(missing),
    })
}

/// Other systems for development, and other machines for running programs, with the packages for
/// each.
const TARGETS: [(&str, &[&str]); 4] = [
    ("aarch64-apple-darwin", UNIX),
    ("aarch64-unknown-linux-gnu", UNIX),
    ("aarch64-unknown-linux-musl", UNIX),
    ("x86_64-pc-windows-msvc", ANYWHERE),
];

/// Driver, simulator, dashboard, doctor, the program `franka`, the Python package and the first
/// example.
const UNIX: &[&str] = &[
    "--package=franka-cli",
    "--package=franka-py",
    "--package=franka-async",
    "--lib",
    "--bins",
    "--example=quickstart",
];

/// Packages that need no Unix, unlike the driver.
const ANYWHERE: &[&str] = &[
    "--package=franka-proto",
    "--package=franka-model",
    "--package=franka-otg",
];

/// The architecture of a target.
pub(crate) fn architecture(target: &str) -> &str {
    target.split('-').next().unwrap_or_default()
}

/// The emulator that runs programs of an architecture here, or the missing requirement; `has`
/// returns true for an installed program.
pub(crate) fn emulator(architecture: &str, has: impl Fn(&str) -> bool) -> Result<String, String> {
    let emulators = [
        format!("qemu-{architecture}-static"),
        format!("qemu-{architecture}"),
    ];
    let found = emulators.iter().find(|name| has(name)).cloned();
    found.ok_or_else(|| format!("{} is not installed", emulators[0]))
}

/// True if a program is installed.
pub(crate) fn is_installed(program: &str) -> bool {
    let mut command = Command::new(program);
    command
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command.status().is_ok_and(|status| status.success())
}

/// The value of `PATH` with which Cargo finds zig and the programs that build with it, or the
/// missing requirement.
pub(crate) fn zig(workspace: &Workspace) -> anyhow::Result<Result<OsString, String>> {
    match python::environment(workspace, "python-dist", "franka-cli/dist/build.txt")? {
        Ok(interpreter) => path_with(&interpreter).map(Ok),
        Err(why) => Ok(Err(why)),
    }
}

/// The value of `PATH` with which the programs of a virtual environment come first. Programs that
/// build with zig look for it as a module of the first Python.
pub(crate) fn path_with(interpreter: &Path) -> anyhow::Result<OsString> {
    let first = interpreter
        .parent()
        .context("an interpreter is in a directory")?
        .to_owned();
    let path = env::var_os("PATH").unwrap_or_default();
    let path = std::iter::once(first).chain(env::split_paths(&path));
    Ok(env::join_paths(path)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_needs_its_standard_library() {
        let name = format!("franka-xtask-{}-sysroot", std::process::id());
        let sysroot = env::temp_dir().join(name);
        fs::create_dir_all(&sysroot).unwrap();
        let musl = "x86_64-unknown-linux-musl";
        let why = lacks(musl, &sysroot).expect("there is nothing");
        assert!(
            why.ends_with("`rustup target add x86_64-unknown-linux-musl` installs it"),
            "{why}"
        );
        let libraries = sysroot.join("lib/rustlib").join(musl).join("lib");
        fs::create_dir_all(&libraries).unwrap();
        fs::write(libraries.join("libcore-1.rlib"), "").unwrap();
        assert!(lacks(musl, &sysroot).is_some(), "core alone will not do");
        fs::write(libraries.join("libstd-1.rlib"), "").unwrap();
        assert_eq!(lacks(musl, &sysroot), None);
        assert!(lacks("aarch64-unknown-linux-gnu", &sysroot).is_some());
        fs::remove_dir_all(sysroot).unwrap();
    }

    #[test]
    fn an_emulator_is_the_static_one_if_there_is_one() {
        let why = emulator("aarch64", |_| false).unwrap_err();
        assert_eq!(why, "qemu-aarch64-static is not installed");
        let any = emulator("aarch64", |_| true);
        assert_eq!(any, Ok("qemu-aarch64-static".to_owned()));
        let found = emulator("aarch64", |name| name == "qemu-aarch64");
        assert_eq!(found, Ok("qemu-aarch64".to_owned()));
    }
}

//! Builds for other machines, and runs the results.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::Context as _;

use xtask::python;
use xtask::realtime::succeeds;
use xtask::step::{Missing, Outcome};
use xtask::workspace::Workspace;

/// The directory of the compiler's libraries.
pub(crate) fn sysroot(workspace: &Workspace) -> anyhow::Result<PathBuf> {
    let mut rustc = workspace.program("rustc");
    let sysroot = workspace.output(rustc.args(["--print", "sysroot"]))?;
    Ok(sysroot.trim().into())
}

/// The part of the toolchain that is missing to build for a target, if any: `library` begins the
/// name of `libstd-` or `libcore-`.
pub(crate) fn lacks(target: &str, library: &str) -> Option<String> {
    let mut rustc = Command::new("rustc");
    rustc.args(["--print", "target-libdir", "--target", target]);
    let output = rustc.stderr(Stdio::null()).output();
    let path = output.map_or(String::new(), |it| {
        String::from_utf8_lossy(&it.stdout).trim().to_owned()
    });
    let is_it = |entry: fs::DirEntry| {
        let name = entry.file_name().to_string_lossy().into_owned();
        name.starts_with(library) && name.ends_with(".rlib")
    };
    let is_there = fs::read_dir(path).is_ok_and(|entries| entries.flatten().any(is_it));
    (!is_there).then(|| {
        format!("its standard library is not installed; `rustup target add {target}` installs it")
    })
}

/// The step `targets`: checks the portable parts for other systems and machines, if the toolchain
/// has their standard library.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let (there, missing): (Vec<_>, Vec<_>) = TARGETS
        .into_iter()
        .partition(|(target, _)| lacks(target, STD).is_none());
    let missing: Vec<&str> = missing.iter().map(|(target, _)| *target).collect();
    let missing = format!("not installed: `rustup target add {}`", missing.join(" "));
    if there.is_empty() {
        return Ok(Outcome::Skipped(missing));
    }
    let path = zig(workspace)?;
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

/// The emulator that runs programs of an architecture here, preferably the static one.
pub(crate) fn emulator(architecture: &str) -> anyhow::Result<String> {
    let mut emulators = ["-static", ""]
        .map(|it| format!("qemu-{architecture}{it}"))
        .into_iter();
    let missing = || Missing(format!("qemu-{architecture}-static is not installed"));
    Ok(emulators
        .find(|name| is_installed(name))
        .ok_or_else(missing)?)
}

/// True if a program is installed.
pub(crate) fn is_installed(program: &str) -> bool {
    succeeds(&[program, "--version"])
}

/// The value of `PATH` with which Cargo finds zig and the programs that build with it.
pub(crate) fn zig(workspace: &Workspace) -> anyhow::Result<OsString> {
    path_with(&python::environment(
        workspace,
        "python-dist",
        "franka-cli/dist/build.txt",
    )?)
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

/// Begins the name of the standard library.
pub(crate) const STD: &str = "libstd-";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_needs_its_standard_library() {
        let host = format!("{}-unknown-linux-gnu", env::consts::ARCH);
        if cfg!(all(target_os = "linux", target_env = "gnu")) {
            assert_eq!(lacks(&host, STD), None);
            assert!(lacks(&host, "libnone-").is_some());
        }
        let why = lacks("no-such-target", STD).expect("there is nothing");
        assert!(
            why.ends_with("`rustup target add no-such-target` installs it"),
            "{why}"
        );
    }
}

//! Programs from crates.io that tasks need, at the version that they were tried with.

use std::env;
use std::ffi::OsString;

use xtask::workspace::Workspace;

/// Builds fuzz targets, and runs them.
pub(crate) const FUZZ: &str = "cargo-fuzz@0.13.2";
/// Packs programs for Debian.
pub(crate) const DEB: &str = "cargo-deb@3.8.0";

/// Builds a program into the build directory, which takes minutes, unless it is there. Returns the
/// value of `PATH` with which Cargo finds it.
pub(crate) fn path_with(workspace: &Workspace, program: &str) -> anyhow::Result<OsString> {
    let root = workspace.target().join("tools");
    let mut install = workspace.cargo();
    install.args(["install", "--quiet", "--locked", "--root"]);
    install.arg(&root).arg(program);
    install.env("CARGO_TARGET_DIR", root.join("build"));
    workspace.run(&mut install)?;
    let path = env::var_os("PATH").unwrap_or_default();
    let path = std::iter::once(root.join("bin")).chain(env::split_paths(&path));
    Ok(env::join_paths(path)?)
}

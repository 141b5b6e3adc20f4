//! Metadata of the workspace's packages, and copying of files.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Context as _;
use serde_json::Value;
use xtask::workspace::Workspace;

/// Name of each library and program of the workspace, and the file of its root.
pub(crate) fn crates(workspace: &Workspace) -> anyhow::Result<Vec<(String, PathBuf)>> {
    let mut crates = Vec::new();
    for package in packages(workspace)? {
        for target in list(&package["targets"]) {
            let kinds = list(&target["kind"]);
            if kinds.iter().any(|kind| kind == "lib" || kind == "bin") {
                crates.push((text(&target["name"]), text(&target["src_path"]).into()));
            }
        }
    }
    Ok(crates)
}

/// Cargo's description of each package of the workspace.
pub(crate) fn packages(workspace: &Workspace) -> anyhow::Result<Vec<Value>> {
    Ok(list(&of(workspace)?["packages"]).to_vec())
}

/// Cargo's description of the workspace.
pub(crate) fn of(workspace: &Workspace) -> anyhow::Result<Value> {
    let mut metadata = workspace.cargo();
    metadata.args(["metadata", "--format-version=1", "--no-deps"]);
    Ok(serde_json::from_str(&workspace.output(&mut metadata)?)?)
}

/// The elements of an array; none if the value is no array.
pub(crate) fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// A text; empty if the value is none.
pub(crate) fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

/// The command that builds and runs a benchmark or measuring program, in the release profile;
/// appended arguments go to the program.
pub(crate) fn measuring_program(workspace: &Workspace, features: &[&str], name: &str) -> Command {
    let mut command = workspace.cargo();
    command.args(["run", "--profile", "dist", "--package", "franka-bench"]);
    command.args(["--bin", name, "--features", &features.join(","), "--"]);
    command
}

/// Copies a directory with its content.
pub(crate) fn copy_directory(from: &Path, to: &Path) -> anyhow::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_directory(&entry.path(), &target)?;
        } else {
            fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}

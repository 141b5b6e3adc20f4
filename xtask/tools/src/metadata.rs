//! Metadata of the workspace's packages, and copying of files.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, ensure};
use serde_json::Value;
use xtask::workspace::Workspace;

/// Name of each library and program of the workspace, and the file of its root.
pub(crate) fn crates(workspace: &Workspace) -> anyhow::Result<Vec<(String, PathBuf)>> {
    Ok(libraries_and_programs(&packages(workspace)?))
}

/// Cargo's description of each package of the workspace.
pub(crate) fn packages(workspace: &Workspace) -> anyhow::Result<Vec<Value>> {
    Ok(list(&of(workspace)?["packages"]))
}

/// Cargo's description of the workspace.
pub(crate) fn of(workspace: &Workspace) -> anyhow::Result<Value> {
    let output = workspace
        .cargo()
        .args(["metadata", "--format-version=1", "--no-deps"])
        .stderr(Stdio::inherit())
        .output()
        .context("cannot run cargo")?;
    ensure!(output.status.success(), "cargo metadata failed");
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// The targets of all packages that are libraries or programs.
fn libraries_and_programs(packages: &[Value]) -> Vec<(String, PathBuf)> {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let mut crates = Vec::new();
    for target in packages
        .iter()
        .flat_map(|package| list(&package["targets"]))
    {
        let kinds = list(&target["kind"]);
        if kinds.iter().any(|kind| kind == "lib" || kind == "bin") {
            crates.push((text(&target["name"]), text(&target["src_path"]).into()));
        }
    }
    crates
}

/// The elements of an array; none if the value is no array.
fn list(value: &Value) -> Vec<Value> {
    value.as_array().cloned().unwrap_or_default()
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

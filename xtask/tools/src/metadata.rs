//! Metadata of the workspace's packages, and copying of files.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Context as _;
use cargo_metadata::{Metadata, MetadataCommand};
use xtask::workspace::Workspace;

/// Name of each library and program of the workspace, and the file of its root.
pub(crate) fn crates(workspace: &Workspace) -> anyhow::Result<Vec<(String, PathBuf)>> {
    let packages = of(workspace)?.packages.into_iter();
    let targets = packages.flat_map(|package| package.targets);
    let crates = targets.filter(|target| target.is_lib() || target.is_bin());
    Ok(crates.map(|it| (it.name, it.src_path.into())).collect())
}

/// Cargo's description of the workspace.
pub(crate) fn of(workspace: &Workspace) -> anyhow::Result<Metadata> {
    let mut metadata = workspace.cargo();
    metadata.args(["metadata", "--format-version=1", "--no-deps"]);
    Ok(MetadataCommand::parse(workspace.output(&mut metadata)?)?)
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

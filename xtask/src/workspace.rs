//! Where the workspace and its build directory are, and how a program is run in it.

use std::env;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, bail, ensure};
use serde_json::Value;

/// The workspace that this program belongs to.
#[derive(Debug)]
pub(crate) struct Workspace {
    root: PathBuf,
    target: PathBuf,
    /// Name of each library and program, and the file of its root.
    crates: Vec<(String, PathBuf)>,
    /// Cargo's description of each package.
    packages: Vec<Value>,
}

impl Workspace {
    /// Asks Cargo where the workspace builds.
    pub(crate) fn find() -> anyhow::Result<Self> {
        let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
        let root = manifest.parent().context("xtask has no parent directory")?;
        let output = cargo_in(root)
            .args(["metadata", "--format-version=1", "--no-deps"])
            .stderr(Stdio::inherit())
            .output()
            .context("cannot run cargo")?;
        ensure!(output.status.success(), "cargo metadata failed");
        let metadata: Value = serde_json::from_slice(&output.stdout)?;
        let target = metadata["target_directory"]
            .as_str()
            .context("cargo metadata names no target directory")?;
        Ok(Self {
            root: root.to_owned(),
            target: target.into(),
            crates: libraries_and_programs(&metadata),
            packages: list(&metadata["packages"]),
        })
    }

    /// Name of each library and program of the workspace, and the file of its root.
    pub(crate) fn crates(&self) -> &[(String, PathBuf)] {
        &self.crates
    }

    /// Cargo's description of each package of the workspace.
    pub(crate) fn packages(&self) -> &[Value] {
        &self.packages
    }

    /// The directory of the root manifest.
    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    /// The build directory.
    pub(crate) fn target(&self) -> &Path {
        &self.target
    }

    /// Cargo, in the root of the workspace.
    pub(crate) fn cargo(&self) -> Command {
        cargo_in(&self.root)
    }

    /// `program`, in the root of the workspace.
    pub(crate) fn program(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.root);
        command
    }

    /// Builds and runs a binary of the tests package, optimised; arguments appended are the
    /// binary's own.
    pub(crate) fn cargo_release_binary(&self, name: &str) -> Command {
        self.cargo_release_binary_with(&[], name)
    }

    /// [`cargo_release_binary`](Self::cargo_release_binary) with features of the tests package.
    pub(crate) fn cargo_release_binary_with(&self, features: &[&str], name: &str) -> Command {
        let mut command = self.cargo();
        command.args(["run", "--release", "--package", "franka-tests"]);
        command.args(["--bin", name, "--features", &features.join(","), "--"]);
        command
    }

    /// Shows the command, runs it to its end and fails if it does.
    pub(crate) fn run(&self, command: &mut Command) -> anyhow::Result<()> {
        let line = line(command);
        println!("$ {line}");
        let status = command
            .status()
            .with_context(|| format!("cannot run `{line}`"))?;
        if !status.success() {
            bail!("`{line}` failed: {status}");
        }
        Ok(())
    }
}

/// The targets of all packages that are libraries or programs, from Cargo's description.
fn libraries_and_programs(metadata: &Value) -> Vec<(String, PathBuf)> {
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let mut crates = Vec::new();
    for target in list(&metadata["packages"])
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

/// The elements of an array; none of what is no array.
fn list(value: &Value) -> Vec<Value> {
    value.as_array().cloned().unwrap_or_default()
}

/// The command as one would type it: variables that differ from this program's, program, arguments.
fn line(command: &Command) -> String {
    let mut words = Vec::new();
    for (name, value) in command.get_envs() {
        let value = value.unwrap_or_default();
        words.push(format!("{}={value:?}", name.display()));
    }
    words.push(
        Path::new(command.get_program())
            .file_name()
            .unwrap_or(command.get_program())
            .display()
            .to_string(),
    );
    words.extend(
        command
            .get_args()
            .map(|argument| argument.display().to_string()),
    );
    words.join(" ")
}

/// The Cargo that runs this program, so that a toolchain chosen by `cargo +name` or by a variable
/// stays chosen.
fn cargo_in(root: &Path) -> Command {
    let cargo = env::var_os("CARGO").unwrap_or("cargo".into());
    let mut command = Command::new(cargo);
    command.current_dir(root);
    if crate::step::is_ci() {
        // What makes the next build faster, and one crate on many processors, makes a build from
        // nothing on two slower.
        command.env("CARGO_INCREMENTAL", "0");
        command.env("CARGO_PROFILE_DEV_CODEGEN_UNITS", "1");
    }
    command
}

/// Copies a directory and all that is in it.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_shows_variables_program_and_arguments() {
        let mut command = Command::new("/usr/bin/cargo");
        command
            .env("RUSTFLAGS", "-Dwarnings")
            .args(["test", "--test", "live"]);
        assert_eq!(
            line(&command),
            "RUSTFLAGS=\"-Dwarnings\" cargo test --test live"
        );
    }
}

//! The directories of the workspace and of its build, and running programs in it.

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, bail};

/// The workspace of this program.
#[derive(Debug)]
pub struct Workspace {
    root: PathBuf,
    target: PathBuf,
}

impl Workspace {
    /// Finds the build directory by the path of this program, which Cargo has built there.
    ///
    /// # Errors
    /// If this program was moved.
    pub fn find() -> anyhow::Result<Self> {
        let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
        let root = manifest.parent().context("xtask has no parent directory")?;
        let program = env::current_exe().context("this program has no path")?;
        let target = program.ancestors().nth(2); // target/debug/xtask
        let target = target.context("this program is in no build directory")?;
        Ok(Self {
            root: root.to_owned(),
            target: target.to_owned(),
        })
    }

    /// The directory of the root manifest.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// The build directory.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Cargo, in the root of the workspace.
    pub fn cargo(&self) -> Command {
        cargo_in(&self.root)
    }

    /// `program`, in the root of the workspace.
    pub fn program(&self, program: impl AsRef<OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.root);
        command
    }

    /// Prints the command, runs it to its end and fails if it fails.
    ///
    /// # Errors
    /// If the command cannot be started or fails.
    pub fn run(&self, command: &mut Command) -> anyhow::Result<()> {
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

/// The command as typed by a user: changed variables, program, arguments.
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

/// The Cargo that runs this program, so that the toolchain of `cargo +name` or of a variable stays
/// in use.
fn cargo_in(root: &Path) -> Command {
    let cargo = env::var_os("CARGO").unwrap_or("cargo".into());
    let mut command = Command::new(cargo);
    command.current_dir(root);
    if crate::step::is_ci() {
        // Incremental data makes the next build faster and the first one slower.
        command.env("CARGO_INCREMENTAL", "0");
    }
    command
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

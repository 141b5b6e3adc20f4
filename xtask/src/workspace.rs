//! The directories of the workspace and of its build, and running programs in it.

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

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

    /// The output of a command.
    ///
    /// # Errors
    /// If the command cannot be started or fails, or if the output is no text.
    pub fn output(&self, command: &mut Command) -> anyhow::Result<String> {
        let output = command.stderr(Stdio::inherit()).output();
        let output = output.with_context(|| format!("cannot run `{}`", line(command)))?;
        if !output.status.success() {
            bail!("`{}` failed: {}", line(command), output.status);
        }
        Ok(String::from_utf8(output.stdout)?)
    }

    /// The output of git, without the blanks around it.
    ///
    /// # Errors
    /// The errors of [`Self::output`].
    pub fn git(&self, arguments: &[&str]) -> anyhow::Result<String> {
        let output = self.output(self.program("git").args(arguments))?;
        Ok(output.trim().to_owned())
    }

    /// The files that match a pattern of git, unless git ignores them or they were deleted.
    ///
    /// # Errors
    /// The errors of [`Self::output`].
    pub fn files(&self, patterns: &[&str]) -> anyhow::Result<Vec<PathBuf>> {
        let list = [
            "ls-files",
            "-co",
            "--deduplicate",
            "--exclude-standard",
            "--",
        ];
        let files = self.git(&[&list, patterns].concat())?;
        let files = files.lines().map(PathBuf::from);
        Ok(files
            .filter(|file| self.root.join(file).is_file())
            .collect())
    }
}

/// True if nothing that can be checked may be left out: the variable `CI` is set, as services set
/// it.
pub fn is_ci() -> bool {
    env::var("CI").is_ok_and(|value| value == "true" || value == "1")
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
    if is_ci() {
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

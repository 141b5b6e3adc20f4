//! Virtual environments of Python, kept inside the tree, made by uv.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::bail;

use crate::realtime::succeeds;
use crate::step::Missing;
use crate::workspace::Workspace;

/// The Python versions that the wheel and the tools of the steps support.
pub const ANY: &str = ">=3.10";

/// uv, in its pinned version.
#[derive(Debug)]
pub struct Uv {
    program: PathBuf,
}

impl Uv {
    /// Installs uv into the build directory by the pip of `python3`, once.
    ///
    /// # Errors
    /// If the installation fails, or if its requirements are missing.
    pub fn find(workspace: &Workspace) -> anyhow::Result<Self> {
        let requirements = workspace.root().join("xtask/uv.txt");
        let wanted = fs::read_to_string(&requirements)?;
        let directory = workspace.target().join("uv");
        let installed = directory.join("installed.txt");
        if !fs::read_to_string(&installed).is_ok_and(|text| text == wanted) {
            if !succeeds(&["python3", "-c", "import ensurepip, venv"]) {
                let why = "Python 3 with the modules venv and ensurepip is needed";
                bail!(Missing(why.to_owned()));
            }
            let mut create = workspace.program("python3");
            create.args(["-m", "venv", "--clear"]).arg(&directory);
            workspace.run(&mut create)?;
            let mut install = workspace.program(directory.join("bin/python"));
            install.args(["-m", "pip", "install", "--quiet", "--require-hashes"]);
            install.args(["--disable-pip-version-check", "--only-binary=:all:"]);
            workspace.run(install.arg("--requirement").arg(&requirements))?;
            // Written last, so that an interrupted installation is repeated.
            fs::write(&installed, wanted)?;
        }
        let program = directory.join("bin/uv");
        Ok(Self { program })
    }

    /// Makes the virtual environment `name` in the build directory, of a Python of these versions
    /// and with exactly these requirements, and returns its interpreter.
    ///
    /// # Errors
    /// If the requirements cannot be read or installed, or if there is no such Python.
    pub fn environment(
        &self,
        workspace: &Workspace,
        name: &str,
        versions: &str,
        requirements: &Path,
    ) -> anyhow::Result<PathBuf> {
        let directory = workspace.target().join(name);
        if !self.has(versions) {
            bail!(Missing(format!("no Python {versions} was found")));
        }
        let interpreter = self.create(workspace, &directory, versions)?;
        let mut sync = self.pip(workspace, "sync", &interpreter);
        sync.args(["--require-hashes", "--only-binary=:all:"]);
        workspace.run(sync.arg(requirements))?;
        Ok(interpreter)
    }

    /// Makes a virtual environment in `directory`, which may have an earlier one, and returns its
    /// interpreter.
    ///
    /// # Errors
    /// If there is no Python of these versions.
    pub fn create(
        &self,
        workspace: &Workspace,
        directory: &Path,
        versions: &str,
    ) -> anyhow::Result<PathBuf> {
        let mut create = self.command(workspace, "venv");
        create.args(["--allow-existing", "--python", versions]);
        workspace.run(create.arg(directory))?;
        Ok(directory.join("bin/python"))
    }

    /// `uv pip TASK` for the environment of an interpreter.
    pub fn pip(&self, workspace: &Workspace, task: &str, interpreter: &Path) -> Command {
        let mut command = self.command(workspace, "pip");
        command.arg(task).arg("--python").arg(interpreter);
        command
    }

    /// True if this machine has a Python of these versions.
    pub fn has(&self, versions: &str) -> bool {
        let mut find = Command::new(&self.program);
        find.args(["python", "find", "--system", "--no-python-downloads"]);
        find.arg(versions).stdout(Stdio::null());
        find.stderr(Stdio::null());
        find.status().is_ok_and(|status| status.success())
    }

    fn command(&self, workspace: &Workspace, task: &str) -> Command {
        let mut command = workspace.program(&self.program);
        command.args([task, "--quiet", "--no-python-downloads"]);
        command
    }
}

/// Makes the virtual environment `name` of any supported Python by [`Uv::environment`].
///
/// # Errors
/// If something cannot be installed, or if a requirement is missing.
pub fn environment(
    workspace: &Workspace,
    name: &str,
    requirements: &str,
) -> anyhow::Result<PathBuf> {
    let requirements = workspace.root().join(requirements);
    Uv::find(workspace)?.environment(workspace, name, ANY, &requirements)
}

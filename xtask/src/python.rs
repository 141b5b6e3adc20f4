//! The virtual environment of the Python scripts, kept inside the build directory.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::workspace::Workspace;

/// A Python that can run the scripts: its interpreter knows the modules that make virtual environments.
#[derive(Debug)]
pub(crate) struct Python {
    program: &'static str,
    version: Version,
}

/// Major and minor number.
type Version = (u32, u32);

impl Python {
    /// The first interpreter of this machine that will do, or why there is none.
    pub(crate) fn find() -> Result<Self, String> {
        let mut unfit = Vec::new();
        for program in PROGRAMS {
            match probe(program) {
                None => {}
                Some(version) if SUPPORTED.contains(&version) => {
                    return Ok(Self { program, version });
                }
                Some((major, minor)) => unfit.push(format!("{program} is {major}.{minor}")),
            }
        }
        let found = match unfit.as_slice() {
            [] => "none was found".to_owned(),
            _ => unfit.join(", "),
        };
        Err(format!(
            "Python 3.9 to 3.12 with the modules venv and ensurepip is needed: {found}"
        ))
    }

    /// Makes the virtual environment, installs `requirements` in it and returns its interpreter. Does nothing but
    /// the last if both are as before.
    pub(crate) fn environment(
        &self,
        workspace: &Workspace,
        requirements: &Path,
    ) -> anyhow::Result<PathBuf> {
        let directory = workspace.target().join("python");
        let interpreter = directory.join("bin").join("python");
        let installed = directory.join("installed.txt");
        let wanted = format!(
            "{} {:?}\n{}",
            self.program,
            self.version,
            fs::read_to_string(requirements)?
        );
        if fs::read_to_string(&installed).is_ok_and(|text| text == wanted) {
            println!("{} is up to date", directory.display());
            return Ok(interpreter);
        }
        let mut create = workspace.program(self.program);
        create.args(["-m", "venv", "--clear"]).arg(&directory);
        workspace.run(&mut create)?;
        let mut install = workspace.program(&interpreter);
        install
            .args(["-m", "pip", "install", "--quiet", "--require-hashes"])
            .args(["--disable-pip-version-check", "--only-binary=:all:"])
            .arg("--requirement")
            .arg(requirements);
        workspace.run(&mut install)?;
        // Written last: an installation that broke off is made anew.
        fs::write(&installed, wanted)?;
        Ok(interpreter)
    }
}

/// Version of an interpreter that is there and can make virtual environments.
fn probe(program: &str) -> Option<Version> {
    let output = Command::new(program)
        .args(["-c", PROBE])
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .output()
        .ok()?;
    if !output.status.success() {
        return None;
    }
    parse_version(&String::from_utf8_lossy(&output.stdout))
}

fn parse_version(text: &str) -> Option<Version> {
    let (major, minor) = text.trim().split_once('.')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}

const PROBE: &str =
    "import ensurepip, sys, venv; print(f'{sys.version_info[0]}.{sys.version_info[1]}')";

/// Interpreters to try: the one that `python3` names first, then older ones beside it.
const PROGRAMS: &[&str] = &[
    "python3",
    "python3.12",
    "python3.11",
    "python3.10",
    "python3.9",
    "python",
];

/// Versions that the vendor builds wheels for.
const SUPPORTED: &[Version] = &[(3, 9), (3, 10), (3, 11), (3, 12)];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_compare_as_numbers() {
        assert_eq!(parse_version("3.9\n"), Some((3, 9)));
        assert!(parse_version("3.10") > parse_version("3.9"));
        assert_eq!(parse_version("Python 3"), None);
    }

    #[test]
    fn an_absent_interpreter_has_no_version() {
        assert_eq!(probe("no-such-python"), None);
    }
}

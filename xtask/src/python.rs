//! Virtual environments of Python, kept inside the tree.

use std::collections::BTreeMap;
use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::workspace::Workspace;

/// An interpreter with the modules that make virtual environments.
#[derive(Debug)]
pub struct Python {
    program: &'static str,
    version: Version,
}

/// Major and minor number.
pub type Version = (u32, u32);

impl Python {
    /// The first suitable interpreter of this machine with one of these versions, or the reason why
    /// none is available.
    ///
    /// # Errors
    /// The reason why no interpreter is suitable.
    pub fn find(versions: RangeInclusive<Version>) -> Result<Self, String> {
        let mut unfit = Vec::new();
        for program in PROGRAMS {
            match probe(program) {
                None => {}
                Some(version) if versions.contains(&version) => {
                    return Ok(Self { program, version });
                }
                Some((major, minor)) => unfit.push(format!("{program} is {major}.{minor}")),
            }
        }
        let found = match unfit.as_slice() {
            [] => "no Python was found".to_owned(),
            _ => unfit.join(", "),
        };
        let range = text(&versions);
        Err(format!(
            "got {found}, expected Python {range} with the modules venv and ensurepip"
        ))
    }

    /// One interpreter of each of these versions that is on this machine, the oldest first.
    pub fn all(versions: RangeInclusive<Version>) -> Vec<Self> {
        let mut found = BTreeMap::new();
        for program in PROGRAMS {
            if let Some(version) = probe(program).filter(|version| versions.contains(version)) {
                found.entry(version).or_insert(Self { program, version });
            }
        }
        found.into_values().collect()
    }

    /// Its version.
    pub fn version(&self) -> Version {
        self.version
    }

    /// Makes the virtual environment `name` in the build directory, installs `requirements` in it
    /// and returns its interpreter. Only returns the interpreter if both are unchanged.
    ///
    /// # Errors
    /// If the requirements cannot be read or installed.
    pub fn environment(
        &self,
        workspace: &Workspace,
        name: &str,
        requirements: &Path,
    ) -> anyhow::Result<PathBuf> {
        let directory = workspace.target().join(name);
        let installed = directory.join("installed.txt");
        let wanted = format!(
            "{} {:?}\n{}",
            self.program,
            self.version,
            fs::read_to_string(requirements)?
        );
        if fs::read_to_string(&installed).is_ok_and(|text| text == wanted) {
            println!("{} is up to date", directory.display());
            return Ok(interpreter_of(&directory));
        }
        let interpreter = self.make_environment(workspace, &directory)?;
        let mut install = workspace.program(&interpreter);
        install
            .args(["-m", "pip", "install", "--quiet", "--require-hashes"])
            .args(["--disable-pip-version-check", "--only-binary=:all:"])
            .arg("--requirement")
            .arg(requirements);
        workspace.run(&mut install)?;
        // Written last, so that an interrupted installation is repeated.
        fs::write(&installed, wanted)?;
        Ok(interpreter)
    }

    /// Makes an empty virtual environment in `directory`, in place of an earlier one, and returns
    /// its interpreter.
    ///
    /// # Errors
    /// If it cannot be made.
    pub fn make_environment(
        &self,
        workspace: &Workspace,
        directory: &Path,
    ) -> anyhow::Result<PathBuf> {
        let mut create = workspace.program(self.program);
        create.args(["-m", "venv", "--clear"]).arg(directory);
        workspace.run(&mut create)?;
        Ok(interpreter_of(directory))
    }
}

/// The interpreter of a virtual environment.
fn interpreter_of(directory: &Path) -> PathBuf {
    directory.join("bin").join("python")
}

/// Text of a range; a range up to [`NEWEST`] has no end.
fn text(versions: &RangeInclusive<Version>) -> String {
    let ((major, minor), newest) = (*versions.start(), *versions.end());
    match newest {
        NEWEST => format!("{major}.{minor} or newer"),
        (last, least) => format!("{major}.{minor} to {last}.{least}"),
    }
}

/// The oldest Python that the wheel and the tools of the steps support.
pub const OLDEST: Version = (3, 10);

/// Newer than any Python 3.
pub const NEWEST: Version = (3, u32::MAX);

/// Version of an interpreter that exists and can make virtual environments.
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

/// Interpreters to try: `python3` first, then older ones.
const PROGRAMS: &[&str] = &[
    "python3",
    "python3.14",
    "python3.13",
    "python3.12",
    "python3.11",
    "python3.10",
    "python3.9",
    "python",
];

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
    fn ranges_are_said_with_their_end_if_they_have_one() {
        assert_eq!(text(&((3, 9)..=(3, 12))), "3.9 to 3.12");
        assert_eq!(text(&((3, 9)..=NEWEST)), "3.9 or newer");
    }

    #[test]
    fn an_absent_interpreter_has_no_version() {
        assert_eq!(probe("no-such-python"), None);
    }
}

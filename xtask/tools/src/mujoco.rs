//! `cargo xtask mujoco`: the native library of the simulator's MuJoCo plant, kept inside the tree.
//!
//! ```text
//! pkg-config mujoco, if it is exactly the version ─────────┐
//! PyPI wheel, pinned by hash ── pip download ── unpack ──> .mujoco/by-cargo-xtask-mujoco/libmujoco.so
//!                                                               ^
//! .cargo/config.toml: MUJOCO_DYNAMIC_LINK_DIR, unless set ──────┘
//! ```
//!
//! The directory is not below the build directory, because Cargo adds only the output directories
//! of build scripts to the search path of programs. The build script of `franka-sim` copies the
//! library into its output directory.

use std::env;
use std::ffi::OsStr;
use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, bail};

use xtask::python::{NEWEST, Python, Version};
use xtask::workspace::Workspace;

/// Makes the library available, and prints its source.
pub(crate) fn provide(workspace: &Workspace) -> anyhow::Result<()> {
    match fetch(workspace)? {
        Ok(()) => Ok(()),
        Err(why) => bail!("{why}"),
    }
}

/// Makes the library available for builds. The inner error names the missing requirement of this
/// machine.
pub(crate) fn prepare(workspace: &Workspace) -> anyhow::Result<Result<(), String>> {
    match rust() {
        Some(version) if version < RUST => Ok(Err(format!(
            "the MuJoCo plant needs Rust {}.{}, this is {}.{}",
            RUST.0, RUST.1, version.0, version.1
        ))),
        _ => fetch(workspace),
    }
}

/// Does nothing if the user names another library or the right one exists. The inner error gives
/// the reason why this machine cannot have one.
fn fetch(workspace: &Workspace) -> anyhow::Result<Result<(), String>> {
    if let Some(variable) = named_by_user(workspace) {
        println!("using the library of {variable}");
        return Ok(Ok(()));
    }
    let directory = directory(workspace);
    let stamp = directory.join("installed.txt");
    let (origin, source) = match pkg_config() {
        Some(library) => (format!("{}\n", library.display()), Source::Own(library)),
        None => match Wheel::of(env::consts::OS, env::consts::ARCH) {
            Some(wheel) => (format!("{}\n", wheel.hash), Source::Wheel(wheel)),
            None => {
                return Ok(Err(format!(
                    "MuJoCo {VERSION} is fetched for Linux on x86-64 and aarch64 only; install it, so that pkg-config \
                     finds it, or set MUJOCO_DYNAMIC_LINK_DIR to the absolute path of its libraries"
                )));
            }
        },
    };
    let library = directory.join(LIBRARIES).join(LIBRARY);
    if library.exists() && fs::read_to_string(&stamp).is_ok_and(|text| text == origin) {
        println!("{} is up to date", library.display());
        return Ok(Ok(()));
    }
    if directory.exists() {
        fs::remove_dir_all(&directory)?;
    }
    fs::create_dir_all(directory.join(LIBRARIES))?;
    match source {
        Source::Own(own) => link(&own, &library)?,
        Source::Wheel(wheel) => {
            let python = match Python::find(FETCHING) {
                Ok(python) => python,
                Err(why) => return Ok(Err(format!("MuJoCo is fetched with pip: {why}"))),
            };
            wheel.unpack(workspace, &python, &directory)?;
            // Linkers look for the plain name, programs for the name with the version.
            link(Path::new(VERSIONED), &library)?;
        }
    }
    // Written last, so that an interrupted installation is repeated.
    fs::write(&stamp, origin)?;
    println!("{} exists", library.display());
    Ok(Ok(()))
}

/// Source of the library.
enum Source {
    /// Installed on this machine.
    Own(PathBuf),
    /// Published by the vendor.
    Wheel(&'static Wheel),
}

/// A wheel that carries the library, pinned.
struct Wheel {
    system: &'static str,
    machine: &'static str,
    /// SHA-256 of the file for [`PYTHON`].
    hash: &'static str,
}

impl Wheel {
    fn of(system: &str, machine: &str) -> Option<&'static Self> {
        WHEELS
            .iter()
            .find(|wheel| wheel.system == system && wheel.machine == machine)
    }

    /// Puts the library below `directory`.
    fn unpack(
        &self,
        workspace: &Workspace,
        python: &Python,
        directory: &Path,
    ) -> anyhow::Result<()> {
        let scratch = directory.join("scratch");
        let interpreter = python.make_environment(workspace, &scratch.join("python"))?;
        let requirement = scratch.join("requirements.txt");
        fs::write(
            &requirement,
            format!("mujoco=={VERSION} --hash=sha256:{}\n", self.hash),
        )?;
        let mut download = workspace.program(&interpreter);
        download
            .args(["-m", "pip", "download", "--quiet", "--no-deps"])
            .args(["--disable-pip-version-check", "--only-binary=:all:"])
            .args(["--require-hashes", "--implementation", "cp"])
            .args(["--python-version", PYTHON.0, "--abi", PYTHON.1])
            .arg("--platform")
            .arg(format!("manylinux_2_28_{}", self.machine))
            .arg("--dest")
            .arg(&scratch)
            .arg("--requirement")
            .arg(&requirement);
        workspace.run(&mut download)?;
        let wheel = fs::read_dir(&scratch)?
            .filter_map(|entry| Some(entry.ok()?.path()))
            .find(|path| path.extension().is_some_and(|ending| ending == "whl"))
            .context("pip has downloaded no wheel")?;
        let mut unpack = workspace.program(&interpreter);
        unpack.args(["-m", "zipfile", "--extract"]);
        workspace.run(unpack.arg(&wheel).arg(&scratch))?;
        fs::rename(
            scratch.join("mujoco").join(VERSIONED),
            directory.join(LIBRARIES).join(VERSIONED),
        )?;
        fs::remove_dir_all(&scratch)?;
        Ok(())
    }
}

/// Directory of the library, as in `.cargo/config.toml`.
fn directory(workspace: &Workspace) -> PathBuf {
    workspace.root().join(".mujoco")
}

/// The variable with which the user names a library. Cargo sets one of them itself, from its
/// configuration.
fn named_by_user(workspace: &Workspace) -> Option<&'static str> {
    ["MUJOCO_STATIC_LINK_DIR", "MUJOCO_DYNAMIC_LINK_DIR"]
        .into_iter()
        .find(|name| env::var_os(name).is_some_and(|value| !is_in(workspace.root(), &value)))
}

/// True if the configuration in `root` sets this value.
fn is_in(root: &Path, value: &OsStr) -> bool {
    let real = |path: &Path| fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let same = |own: &Path| real(own) == real(root);
    let path = Path::new(value);
    path.ends_with(Path::new(".mujoco").join(LIBRARIES))
        && path.ancestors().nth(2).is_some_and(same)
}

/// Major and minor number of the compiler; `None` if unknown.
fn rust() -> Option<(u32, u32)> {
    let output = Command::new("rustc").arg("--version").output().ok()?;
    parse_rust(&String::from_utf8_lossy(&output.stdout))
}

fn parse_rust(text: &str) -> Option<(u32, u32)> {
    let mut numbers = text.strip_prefix("rustc ")?.split('.');
    Some((numbers.next()?.parse().ok()?, numbers.next()?.parse().ok()?))
}

/// The library of exactly this version, if pkg-config finds one.
fn pkg_config() -> Option<PathBuf> {
    let output = Command::new("pkg-config")
        .arg(format!("mujoco = {VERSION}"))
        .arg("--variable=libdir")
        .stderr(Stdio::null())
        .output()
        .ok()?;
    let directory = String::from_utf8_lossy(&output.stdout);
    let library = Path::new(directory.trim()).join(LIBRARY);
    (output.status.success() && library.exists()).then_some(library)
}

#[cfg(unix)]
fn link(target: &Path, link: &Path) -> std::io::Result<()> {
    std::os::unix::fs::symlink(target, link)
}

/// Other systems fetch nothing.
#[cfg(not(unix))]
fn link(target: &Path, link: &Path) -> std::io::Result<()> {
    fs::copy(target, link).map(|_| ())
}

/// The oldest compiler of the crate `mujoco-rs`.
const RUST: (u32, u32) = (1, 95);

/// The MuJoCo version for the crate `mujoco-rs`.
const VERSION: &str = "3.17.0";

/// The directory of the library. If it does not exist, the build script of `mujoco-rs` fails with
/// its path, which names the remedy.
const LIBRARIES: &str = "by-cargo-xtask-mujoco";

/// File name for linkers, and for the loader of programs.
const LIBRARY: &str = "libmujoco.so";
const VERSIONED: &str = "libmujoco.so.3.17.0";

/// Version and ABI of the Python for which the wheels are made. The Python that fetches them may be
/// another: all wheels contain the same library.
const PYTHON: (&str, &str) = ("3.12", "cp312");

/// Versions of the Python that fetches: all versions whose pip has the options used here.
const FETCHING: RangeInclusive<Version> = (3, 9)..=NEWEST;

/// The wheels on PyPI.
const WHEELS: &[Wheel] = &[
    Wheel {
        system: "linux",
        machine: "x86_64",
        hash: "42371356efe53a5f5f73ed03fcb967bdf04048017f80e2fca01e71a360e42da2",
    },
    Wheel {
        system: "linux",
        machine: "aarch64",
        hash: "525e09a00ecd964f06582773d9eeb03bb0e5a1675edf296a6868024759b3b235",
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_configured_directory_is_not_the_users_own() {
        let root = Path::new("/project");
        assert!(is_in(
            root,
            "/project/.mujoco/by-cargo-xtask-mujoco".as_ref()
        ));
        assert!(!is_in(
            root,
            "/home/someone/.mujoco/by-cargo-xtask-mujoco".as_ref()
        ));
        assert!(!is_in(root, "/opt/mujoco-3.17.0/lib".as_ref()));
    }

    #[test]
    fn the_configuration_of_cargo_names_the_directory() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"))
            .ancestors()
            .nth(2)
            .unwrap();
        let text = fs::read_to_string(root.join(".cargo/config.toml")).unwrap();
        assert!(
            text.contains("MUJOCO_DYNAMIC_LINK_DIR = { value = \".mujoco/by-cargo-xtask-mujoco\", relative = true }"),
            "{text}"
        );
    }

    #[test]
    fn the_version_of_the_compiler_is_read() {
        let text = "rustc 1.95.0 (59807616e 2026-04-14)";
        assert_eq!(parse_rust(text), Some((1, 95)));
        assert!(parse_rust("rustc 1.89.0").is_some_and(|version| version < RUST));
        assert_eq!(parse_rust("gcc 12"), None);
    }

    #[test]
    fn the_library_has_the_version_of_the_wheel() {
        assert_eq!(VERSIONED, format!("{LIBRARY}.{VERSION}"));
        assert!(Wheel::of("linux", "x86_64").is_some());
        assert!(Wheel::of("plan9", "mips").is_none());
    }
}

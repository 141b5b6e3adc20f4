//! `cargo xtask mujoco`: the native library of the simulator's MuJoCo plant, kept inside the tree.
//!
//! ```text
//! PyPI wheel, pinned by hash ── uv pip install ──> .mujoco/by-cargo-xtask-mujoco/libmujoco.so
//!                                                               ^
//! .cargo/config.toml: MUJOCO_DYNAMIC_LINK_DIR, unless set ──────┘
//! ```
//!
//! The directory is not below the build directory, because Cargo adds only the output directories
//! of build scripts to the search path of programs. The build script of `franka-sim` copies the
//! library into its output directory.

use std::env;
use std::fs;
use std::path::Path;

use anyhow::bail;
use xtask::python::Uv;
use xtask::step::Missing;
use xtask::workspace::Workspace;

/// Makes the library available, unless it is there or the user names another one.
pub(crate) fn provide(workspace: &Workspace) -> anyhow::Result<()> {
    if let Some(variable) = named_by_user() {
        println!("using the library of {variable}");
        return Ok(());
    }
    if env::consts::OS != "linux" || !["x86_64", "aarch64"].contains(&env::consts::ARCH) {
        bail!(Missing(format!(
            "MuJoCo {VERSION} is fetched for Linux on x86-64 and aarch64 only; install it, and set \
             MUJOCO_DYNAMIC_LINK_DIR to the absolute path of its libraries"
        )));
    }
    let directory = workspace.root().join(".mujoco");
    let stamp = directory.join("installed.txt");
    let library = directory.join(LIBRARIES).join(LIBRARY);
    if library.exists() && fs::read_to_string(&stamp).is_ok_and(|text| text == WHEELS) {
        println!("{} is up to date", library.display());
        return Ok(());
    }
    let uv = Uv::find(workspace)?;
    if directory.exists() {
        fs::remove_dir_all(&directory)?;
    }
    fs::create_dir_all(directory.join(LIBRARIES))?;
    let scratch = directory.join("scratch");
    fs::create_dir(&scratch)?;
    let requirement = scratch.join("requirements.txt");
    fs::write(&requirement, WHEELS)?;
    let interpreter = uv.create(workspace, &scratch.join("python"), ">=3.9")?;
    let mut install = uv.pip(workspace, "install", &interpreter);
    install.args(["--no-deps", "--require-hashes", "--only-binary=:all:"]);
    install.args(["--python-version", PYTHON, "--python-platform"]);
    install.arg(format!("{}-manylinux_2_28", env::consts::ARCH));
    install.arg("--target").arg(&scratch);
    workspace.run(install.arg("--requirement").arg(&requirement))?;
    fs::rename(
        scratch.join("mujoco").join(VERSIONED),
        directory.join(LIBRARIES).join(VERSIONED),
    )?;
    fs::remove_dir_all(&scratch)?;
    // Linkers look for the plain name, programs for the name with the version.
    #[cfg(unix)]
    std::os::unix::fs::symlink(VERSIONED, &library)?;
    // Written last, so that an interrupted installation is repeated.
    fs::write(&stamp, WHEELS)?;
    println!("{} exists", library.display());
    Ok(())
}

/// The variable with which the user names a library. Cargo sets one of them itself, from its
/// configuration.
fn named_by_user() -> Option<&'static str> {
    let is_of_user = |name: &&str| {
        let directory = env::var_os(name);
        directory.is_some_and(|it| !Path::new(&it).ends_with(LIBRARIES))
    };
    let names = ["MUJOCO_STATIC_LINK_DIR", "MUJOCO_DYNAMIC_LINK_DIR"];
    names.into_iter().find(is_of_user)
}

/// The MuJoCo version for the crate `mujoco-rs`.
const VERSION: &str = "3.17.0";

/// The directory of the library. If it does not exist, the build script of `mujoco-rs` fails with
/// its path, which names the remedy.
const LIBRARIES: &str = "by-cargo-xtask-mujoco";

/// File name for linkers, and for the loader of programs.
const LIBRARY: &str = "libmujoco.so";
const VERSIONED: &str = "libmujoco.so.3.17.0";

/// Version of the Python for which the wheels are made. The Python that fetches them may be
/// another: all wheels contain the same library.
const PYTHON: &str = "3.12";

/// The wheels on PyPI for [`PYTHON`], pinned: x86-64, then aarch64.
const WHEELS: &str = "mujoco==3.17.0 \
    --hash=sha256:42371356efe53a5f5f73ed03fcb967bdf04048017f80e2fca01e71a360e42da2 \
    --hash=sha256:525e09a00ecd964f06582773d9eeb03bb0e5a1675edf296a6868024759b3b235\n";

#[cfg(test)]
mod tests {
    use super::*;

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
    fn the_library_has_the_version_of_the_wheel() {
        assert_eq!(VERSIONED, format!("{LIBRARY}.{VERSION}"));
        assert!(WHEELS.starts_with(&format!("mujoco=={VERSION} ")));
    }
}

//! Makes the native library available at run time to programs with the feature `mujoco`.
//!
//! `mujoco-rs` links the library. Cargo adds the output directories of build scripts to the
//! loader's search path of the programs that Cargo runs. Programs, tests and documentation examples
//! of every dependent crate therefore find the link in the output directory of this script. The
//! binary `franka-sim` also contains this path, but it looks in its own directory first.

use std::env;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    for variable in [DOCS, STATIC, DYNAMIC] {
        println!("cargo::rerun-if-env-changed={variable}");
    }
    let is_wanted = env::var_os("CARGO_FEATURE_MUJOCO").is_some() && env::var_os(DOCS).is_none();
    let is_linux = env::var("CARGO_CFG_TARGET_OS")? == "linux";
    if !is_wanted || !is_linux || env::var_os(STATIC).is_some() {
        return Ok(());
    }
    // If no directory is set, `mujoco-rs` uses pkg-config, whose libraries the loader finds.
    let Some(directory) = env::var_os(DYNAMIC).map(PathBuf::from) else {
        return Ok(());
    };
    let library = directory.join("libmujoco.so");
    println!("cargo::rerun-if-changed={}", library.display());
    // `mujoco-rs` also reports this error, but with another text.
    let library = fs::canonicalize(&library).map_err(|error| {
        format!(
            "no library of MuJoCo: {}: {error}; run `cargo xtask mujoco`, or set {DYNAMIC} to the absolute path of a \
             directory that has the right version",
            library.display()
        )
    })?;
    let output = PathBuf::from(env::var_os("OUT_DIR").ok_or("Cargo sets OUT_DIR")?);
    let name = library.file_name().ok_or("a library has a name")?;
    put(&library, &output.join(name))?;
    println!("cargo::rustc-link-search=native={}", output.display());
    let home = library.parent().ok_or("a library is in a directory")?;
    println!("cargo::rustc-link-arg-bins=-Wl,-rpath,$ORIGIN");
    println!("cargo::rustc-link-arg-bins=-Wl,-rpath,{}", home.display());
    Ok(())
}

/// Creates a link to the file, or a copy if both paths are on different file systems.
fn put(file: &Path, name: &Path) -> std::io::Result<()> {
    if name.exists() {
        fs::remove_file(name)?;
    }
    fs::hard_link(file, name).or_else(|_| fs::copy(file, name).map(|_| ()))
}

/// Environment variables that `mujoco-rs` reads. They are set if documentation is built without
/// native libraries.
const DOCS: &str = "DOCS_RS";
const STATIC: &str = "MUJOCO_STATIC_LINK_DIR";
const DYNAMIC: &str = "MUJOCO_DYNAMIC_LINK_DIR";

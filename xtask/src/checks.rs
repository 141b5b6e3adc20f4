//! The steps of `cargo xtask test`, in the order in which they are likely to fail.

use std::fs;
use std::process::{Command, Stdio};

use clap::ValueEnum;

use crate::step::{Outcome, Steps};
use crate::workspace::Workspace;
use crate::{circles, fuzz, mujoco, peers, tidy};

/// A step that can be chosen with `--only`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Check {
    /// Formatting, and comments as wide as code.
    Fmt,
    /// No imports in a circle between the modules of a crate.
    Circles,
    /// Lints, warnings denied.
    Clippy,
    /// Documentation, warnings denied.
    Doc,
    /// All tests and documentation examples; those of the cycle once more with its phases timed.
    Test,
    /// The simulator with its MuJoCo plant.
    Mujoco,
    /// Interleavings of what crosses threads.
    Loom,
    /// Protocol and model without the standard library.
    NoStd,
    /// Any bytes for the protocol.
    Fuzz,
    /// Other clients against the simulator.
    Peers,
}

/// Runs the chosen steps, or all if none is chosen, up to the first failure.
pub(crate) fn run(workspace: &Workspace, only: &[Check]) -> anyhow::Result<()> {
    let mut steps = Steps::default();
    for check in Check::value_variants() {
        if only.is_empty() || only.contains(check) {
            let (name, about) = check.describe();
            steps.take(name, about, || check.run(workspace))?;
        }
    }
    println!("\n{}", steps.summary());
    Ok(())
}

impl Check {
    fn describe(self) -> (&'static str, &'static str) {
        match self {
            Self::Fmt => ("fmt", "formatting, and comments as wide as code"),
            Self::Circles => ("circles", "imports between the modules of a crate"),
            Self::Clippy => ("clippy", "lints of every target, warnings denied"),
            Self::Doc => ("doc", "documentation, warnings denied"),
            Self::Test => ("test", "all tests and documentation examples"),
            Self::Mujoco => (
                "mujoco",
                "lints, documentation and tests of the MuJoCo plant",
            ),
            Self::Loom => ("loom", "interleavings of what crosses threads"),
            Self::NoStd => (
                "no-std",
                "protocol, model and generator without the standard library",
            ),
            Self::Fuzz => ("fuzz", "any bytes for the protocol"),
            Self::Peers => ("peers", "other clients against the simulator"),
        }
    }

    fn run(self, workspace: &Workspace) -> anyhow::Result<Outcome> {
        match self {
            Self::Fmt => {
                for manifest in MANIFESTS {
                    let mut command = workspace.cargo();
                    command.args(["fmt", "--all", "--check", "--manifest-path", manifest]);
                    workspace.run(&mut command)?;
                }
                tidy::check(workspace)?;
            }
            Self::Circles => circles::check(workspace)?,
            Self::Clippy => {
                let mut command = workspace.cargo();
                command.args(["clippy", "--workspace", "--all-targets", "--", "-Dwarnings"]);
                workspace.run(&mut command)?;
                let mut command = workspace.cargo();
                command.args(["clippy", "--package", "franka-async"]);
                workspace.run(command.args(["--no-default-features", "--", "-Dwarnings"]))?;
            }
            Self::Doc => {
                let mut command = workspace.cargo();
                command.args(["doc", "--workspace", "--no-deps"]);
                workspace.run(command.env("RUSTDOCFLAGS", "-Dwarnings"))?;
            }
            Self::Test => {
                workspace.run(workspace.cargo().args(["test", "--workspace"]))?;
                let mut command = workspace.cargo();
                command.args([
                    "test",
                    "--package",
                    "franka-rt",
                    "--package",
                    "franka-tests",
                ]);
                command.args(["--features", "cycle-phases", "--lib"]);
                command.args(["--test", "thread", "--test", "no_alloc"]);
                workspace.run(&mut command)?;
            }
            Self::Mujoco => return mujoco::check(workspace),
            Self::Loom => loom(workspace)?,
            Self::NoStd => return no_std(workspace),
            Self::Fuzz => return fuzz::check(workspace),
            Self::Peers => return peers::run(workspace),
        }
        Ok(Outcome::Passed)
    }
}

/// Loom replaces the atomics of the whole build, which therefore has a directory of its own.
fn loom(workspace: &Workspace) -> anyhow::Result<()> {
    let mut command = workspace.cargo();
    command
        .args(["test", "--release", "--package", "franka-rt"])
        .args(["--test", "loom", "--target-dir"])
        .arg(workspace.target().join("loom"))
        .env("RUSTFLAGS", "--cfg loom");
    workspace.run(&mut command)
}

/// Builds for this machine, where the standard library exists and must not be used, and for one
/// where it does not.
fn no_std(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let package = workspace.root().join("tests").join("no_std");
    // The package resolves by itself, to the versions that the workspace has.
    fs::copy(
        workspace.root().join("Cargo.lock"),
        package.join("Cargo.lock"),
    )?;
    let bare = BARE_TARGETS.iter().find(|target| installed(target));
    let host = None;
    for target in [Some(host), bare.map(Some)].into_iter().flatten() {
        let mut command = workspace.cargo();
        command.arg("build").arg("--manifest-path");
        command.arg(package.join("Cargo.toml")).arg("--target-dir");
        command.arg(workspace.target().join("no-std"));
        command.args(target.map(|target| format!("--target={target}")));
        workspace.run(&mut command)?;
    }
    if bare.is_none() {
        println!(
            "NOT BUILT FOR A BARE TARGET: none is installed; `rustup target add {}` installs one",
            BARE_TARGETS[0]
        );
    }
    Ok(Outcome::Passed)
}

/// Whether the toolchain has the `core` of a target.
fn installed(target: &str) -> bool {
    let output = Command::new("rustc")
        .args(["--print", "target-libdir", "--target", target])
        .stderr(Stdio::null())
        .output();
    output.is_ok_and(|output| {
        let libraries = String::from_utf8_lossy(&output.stdout);
        output.status.success() && std::path::Path::new(libraries.trim()).is_dir()
    })
}

/// The workspace, and the packages that are workspaces of their own.
const MANIFESTS: [&str; 3] = ["Cargo.toml", "fuzz/Cargo.toml", "tests/no_std/Cargo.toml"];

/// Targets without a standard library, the preferred one first.
const BARE_TARGETS: &[&str] = &[
    "thumbv7em-none-eabihf",
    "x86_64-unknown-none",
    "aarch64-unknown-none",
    "riscv64gc-unknown-none-elf",
];

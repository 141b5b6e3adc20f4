//! The steps of `cargo xtask check` and `cargo xtask nightly`, each list in the order in which they
//! are likely to fail.

use std::ffi::OsStr;
use std::fs;
use std::process::{Command, Stdio};

use anyhow::Context as _;
use clap::ValueEnum;
use xtask::peers;
use xtask::selection::{self, LIVE, PACKAGES, packages};
use xtask::step::{Outcome, Steps};
use xtask::suite;
use xtask::workspace::Workspace;

use crate::others::OTHERS;
use crate::{
    book, circles, commands, cross, dashboard, mujoco, names, package, peer_pages, playground,
    prose, recordings, reference_pages, release, schemas, texts, tidy,
};

/// A step that can be chosen with `--only`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Check {
    /// Formatting, and the width of comments.
    Fmt,
    /// No imports in a circle between the modules of a crate.
    Circles,
    /// Public names, and their rows in the book.
    Names,
    /// Spelling, and the workflows.
    Texts,
    /// Plain English in comments, texts and the book.
    Prose,
    /// Licences and sources of the dependencies.
    Dependencies,
    /// Crates that can be published, one version everywhere, the form of the change log.
    Release,
    /// The code of recordings matches its definitions.
    Schemas,
    /// The book: its pages, programs and links.
    Book,
    /// The files of the dashboard's page match its sources.
    Assets,
    /// Lints, warnings denied.
    Clippy,
    /// Documentation, warnings denied.
    Doc,
    /// The README's first command.
    Quickstart,
    /// The tests that `cargo xtask test` leaves out.
    Rest,
    /// The parts without features, and without the standard library.
    Bare,
    /// The other clients against the simulator.
    Peers,
    /// The Python package: its tests and types.
    Python,
    /// Recordings, read by the standard reader in Python.
    Recordings,
}

/// A step of the nightly run that can be chosen with `--only`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Nightly {
    /// The simulator's MuJoCo plant: lints and tests.
    Mujoco,
    /// All tests with every phase of a cycle timed.
    Phases,
    /// The dashboard's page in a real browser.
    Dashboard,
    /// The book's playground in a real browser.
    Playground,
    /// The portable parts, for other systems and machines.
    Targets,
}

/// The steps of a command, for `--only`.
pub(crate) trait StepOf: ValueEnum + PartialEq {
    fn run(&self, workspace: &Workspace) -> anyhow::Result<Outcome>;
}

/// Runs the chosen steps, or all if none is chosen, up to the first failure.
pub(crate) fn run<S: StepOf>(workspace: &Workspace, only: &[S]) -> anyhow::Result<()> {
    let mut steps = Steps::default();
    for step in S::value_variants() {
        if only.is_empty() || only.contains(step) {
            let value = step.to_possible_value().context("a step has a name")?;
            let about = value.get_help().map(ToString::to_string);
            let about = about.unwrap_or_default();
            steps.take(value.get_name(), &about, || step.run(workspace))?;
        }
    }
    println!("\n{}", steps.summary());
    Ok(())
}

impl StepOf for Nightly {
    fn run(&self, workspace: &Workspace) -> anyhow::Result<Outcome> {
        match self {
            Self::Mujoco => {
                if let Err(why) = mujoco::provide(workspace)? {
                    return Outcome::without(why);
                }
                let mut arguments = packages(&MUJOCO);
                arguments.push("--all-targets".to_owned());
                arguments.push(format!("--features={MUJOCO_FEATURES}"));
                clippy(workspace, &arguments)?;
                let features = format!("--features={MUJOCO_FEATURES}");
                selection::tests(workspace, &MUJOCO, &[&features], "all()")
            }
            Self::Phases => {
                let targets = ["--features=franka-tests/cycle-phases"];
                selection::tests(workspace, &PACKAGES, &targets, "all()")
            }
            Self::Dashboard => dashboard::run(workspace),
            Self::Playground => playground::check(workspace),
            Self::Targets => cross::check(workspace),
        }
    }
}

impl StepOf for Check {
    fn run(&self, workspace: &Workspace) -> anyhow::Result<Outcome> {
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
            Self::Names => {
                let ours = names::check(workspace)?;
                peer_pages::check(workspace, &ours)?;
                reference_pages::check(workspace, &ours)?;
                let steps = suite::Step::ALL.map(|step| step.name().to_owned());
                let mut steps = steps.to_vec();
                steps.extend(Check::value_variants().iter().map(name_of));
                steps.extend(Nightly::value_variants().iter().map(name_of));
                commands::check(workspace, &crate::tasks(), &steps)?;
            }
            Self::Texts => return texts::check(workspace),
            Self::Prose => return prose::check(workspace),
            Self::Dependencies => return texts::dependencies(workspace),
            Self::Release => return release::check(workspace, release::Depth::default()),
            Self::Book => return book::check(workspace),
            Self::Schemas => schemas::check(workspace)?,
            Self::Clippy => {
                let features = format!("--features={FEATURES}");
                clippy(workspace, &["--workspace", "--all-targets", &features])?;
            }
            Self::Doc => {
                let mut command = workspace.cargo();
                command.args(["doc", "--workspace", "--no-deps", "--features"]);
                command.arg(format!("{FEATURES},franka-diagnosis/serde"));
                workspace.run(command.env("RUSTDOCFLAGS", "-Dwarnings"))?;
            }
            Self::Quickstart => {
                let mut command = workspace.cargo();
                command.args(["run", "--release", "--example", "quickstart"]);
                workspace.run(&mut command)?;
            }
            Self::Rest => return rest(workspace),
            Self::Bare => {
                without_features(workspace)?;
                return no_std(workspace);
            }
            Self::Peers => return peers::run(workspace, peers::Set::Rest),
            Self::Python => return package::run(workspace),
            Self::Recordings => return recordings::run(workspace),
            Self::Assets => return dashboard::check_assets(workspace),
        }
        Ok(Outcome::Passed)
    }
}

/// The tests that `cargo xtask test` leaves out: first of the same packages, whose libraries are
/// already built, then of the others.
fn rest(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let filter = format!("not ({})", LIVE);
    let outcome = selection::tests(workspace, &PACKAGES, &TARGETS, &filter)?;
    selection::tests(
        workspace,
        &OTHERS,
        &["--features=franka-cli/full,franka-examples/all"],
        "all()",
    )?;
    let mut book = workspace.cargo();
    book.args(["test", "--quiet", "--doc", "--package=franka-tests"]);
    workspace.run(book.arg("--features=franka-tests/book"))?;
    let mut doctests = workspace.cargo();
    doctests.args(["test", "--quiet", "--doc"]);
    doctests.args(packages(&["franka-record", "franka-doctor", "franka-dash"]));
    workspace.run(&mut doctests)?;
    Ok(outcome)
}

fn name_of(step: &impl StepOf) -> String {
    let value = step.to_possible_value();
    value.map_or(String::new(), |value| value.get_name().to_owned())
}

/// Lints, warnings denied.
fn clippy(workspace: &Workspace, arguments: &[impl AsRef<OsStr>]) -> anyhow::Result<()> {
    let mut command = workspace.cargo();
    command.arg("clippy").args(arguments);
    workspace.run(command.args(["--", "-Dwarnings"]))
}

/// Lints driver, simulator, recorder and command line without features.
fn without_features(workspace: &Workspace) -> anyhow::Result<()> {
    let packages = ["franka-async", "franka-sim", "franka-record", "franka-cli"];
    let mut arguments = packages.map(|name| format!("--package={name}")).to_vec();
    arguments.push("--no-default-features".to_owned());
    clippy(workspace, &arguments)
}

/// Checks protocol, model and generator without the standard library, for this machine and for one
/// that has no standard library.
fn no_std(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let package = workspace.root().join("tests").join("no_std");
    // The package resolves alone, to the versions that the workspace has.
    fs::copy(
        workspace.root().join("Cargo.lock"),
        package.join("Cargo.lock"),
    )?;
    let bare = BARE_TARGETS.iter().find(|target| installed(target));
    let host = None;
    for target in [Some(host), bare.map(Some)].into_iter().flatten() {
        let mut command = workspace.cargo();
        command.arg("check").arg("--manifest-path");
        command.arg(package.join("Cargo.toml")).arg("--target-dir");
        command.arg(workspace.target().join("no_std"));
        command.args(target.map(|target| format!("--target={target}")));
        workspace.run(&mut command)?;
    }
    Ok(match bare {
        Some(_) => Outcome::Passed,
        None => Outcome::Partly(format!(
            "no bare target is installed; `rustup target add {}` installs one",
            BARE_TARGETS[0]
        )),
    })
}

/// True if the toolchain has the `core` of a target.
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

/// Test binaries of the driver's packages that `cargo xtask test` runs in part or not at all.
const TARGETS: [&str; 6] = [
    "--test=cassettes",
    "--test=live",
    "--test=lock_memory",
    "--test=serde",
    "--test=sockets",
    "--test=syscalls",
];

/// Features for lints and documentation besides the default ones.
const FEATURES: &str =
    "franka-cli/full,franka-tests/book,franka-tests/cycle-phases,franka-examples/all";

/// Packages with code for the MuJoCo plant.
const MUJOCO: [&str; 4] = [
    "franka-bench",
    "franka-examples",
    "franka-sim",
    "franka-tests",
];

const MUJOCO_FEATURES: &str =
    "franka-bench/mujoco,franka-examples/all,franka-examples/mujoco,franka-tests/mujoco";

/// The workspace, and the packages that are separate workspaces.
const MANIFESTS: [&str; 3] = ["Cargo.toml", "fuzz/Cargo.toml", "tests/no_std/Cargo.toml"];

/// Targets without a standard library, the preferred one first.
const BARE_TARGETS: &[&str] = &[
    "thumbv7em-none-eabihf",
    "x86_64-unknown-none",
    "aarch64-unknown-none",
    "riscv64gc-unknown-none-elf",
];

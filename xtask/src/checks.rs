//! The steps of `cargo xtask test`, in the order in which they are likely to fail.

use std::ffi::OsStr;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::thread;

use clap::ValueEnum;

use crate::ours::Ours;
use crate::step::{Outcome, Steps};
use crate::workspace::Workspace;
use crate::{
    book, circles, commands, cross, dashboard, mujoco, names, package, peer_pages, peers,
    playground, realtime, recordings, reference_pages, release, texts, tidy,
};

/// A step that can be chosen with `--only`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Check {
    /// Formatting, and comments as wide as code.
    Fmt,
    /// No imports in a circle between the modules of a crate.
    Circles,
    /// Few names at the root of the driver, none of them in two places.
    Names,
    /// Spelling, and the workflows.
    Texts,
    /// Licences and sources of the dependencies.
    Dependencies,
    /// Crates that can be published, one version everywhere, the form of the change log.
    Release,
    /// The book: its pages, programs and links.
    Book,
    /// The native library of the simulator's MuJoCo plant, which the next three steps build with.
    Mujoco,
    /// Lints, warnings denied.
    Clippy,
    /// Documentation, warnings denied.
    Doc,
    /// All tests and documentation examples.
    Test,
    /// What the next three steps need.
    Builds,
    /// What is there without features, and without the standard library.
    Bare,
    /// Other clients against the simulator.
    Peers,
    /// The Python package: its tests and types.
    Python,
    /// Recordings, read by the standard reader in Python.
    Recordings,
    /// The files of the dashboard's page are those that its sources make.
    Assets,
    /// The dashboard's page in a real browser.
    Dashboard,
    /// The book's playground in a real browser.
    Playground,
    /// What is portable, for other systems and machines.
    Targets,
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
            Self::Names => ("names", "what programs name, and where it is"),
            Self::Texts => ("texts", "spelling, and the workflows"),
            Self::Dependencies => ("dependencies", "their licences and sources"),
            Self::Release => ("release", "crates, version and change log"),
            Self::Book => ("book", "pages, programs and links of the book"),
            Self::Mujoco => ("mujoco", "the native library of the MuJoCo plant"),
            Self::Clippy => ("clippy", "lints of every target, warnings denied"),
            Self::Doc => ("doc", "documentation, warnings denied"),
            Self::Test => ("test", "all tests and documentation examples"),
            Self::Builds => ("builds", "what the next three steps need, side by side"),
            Self::Bare => ("bare", "without features, and without the standard library"),
            Self::Targets => (
                "targets",
                "what is portable, for other systems and machines",
            ),
            Self::Peers => ("peers", "other clients against the simulator"),
            Self::Python => ("python", "the Python package: its tests and types"),
            Self::Recordings => ("recordings", "recordings read by the standard reader"),
            Self::Assets => ("assets", "the dashboard's files are what its sources make"),
            Self::Dashboard => ("dashboard", "the dashboard's page in a real browser"),
            Self::Playground => ("playground", "the book's playground in a real browser"),
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
            Self::Names => {
                names::check(workspace)?;
                let ours = Ours::read(workspace)?;
                peer_pages::check(workspace, &ours)?;
                reference_pages::check(workspace, &ours)?;
                let steps = Self::value_variants()
                    .iter()
                    .filter_map(Self::to_possible_value);
                let steps: Vec<String> = steps.map(|step| step.get_name().to_owned()).collect();
                commands::check(workspace, &crate::tasks(), &steps)?;
            }
            Self::Texts => return texts::check(workspace),
            Self::Dependencies => return texts::dependencies(workspace),
            Self::Release => return release::check(workspace, release::Depth::default()),
            Self::Book => return book::check(workspace),
            Self::Mujoco => {
                if let Err(why) = mujoco::prepare(workspace)? {
                    return Outcome::without(why);
                }
            }
            Self::Clippy => {
                let features = mujoco::features(workspace)?;
                let all = ["--workspace", "--all-targets", "--features", &features];
                clippy(workspace, &all)?;
            }
            Self::Doc => {
                let mut command = workspace.cargo();
                command.args(["doc", "--workspace", "--no-deps", "--features"]);
                // Those that the tests have as well: what clippy has checked is used again.
                command.arg(
                    mujoco::features(workspace)?
                        + ",franka-async/model-library,franka-diagnosis/serde",
                );
                workspace.run(command.env("RUSTDOCFLAGS", "-Dwarnings"))?;
            }
            Self::Test => return test(workspace),
            Self::Builds => builds(workspace)?,
            Self::Bare => {
                without_features(workspace)?;
                return no_std(workspace);
            }
            Self::Targets => return cross::check(workspace),
            Self::Peers => return peers::run(workspace),
            Self::Python => return package::run(workspace),
            Self::Recordings => return recordings::run(workspace),
            Self::Assets => return dashboard::check_assets(workspace),
            Self::Dashboard => return dashboard::run(workspace),
            Self::Playground => return playground::check(workspace),
        }
        Ok(Outcome::Passed)
    }
}

/// All tests, by cargo-nextest where it is installed: test binaries then run side by side. Then the
/// examples of the documentation, which it does not run.
fn test(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let features = mujoco::features(workspace)?;
    let realtime = realtime::obtain();
    let run = |arguments: &[&str]| {
        let mut command = workspace.cargo();
        command
            .args(arguments)
            .args(["--workspace", "--features", &features]);
        if realtime.is_ok() {
            command.env(realtime::GRANTED, "1");
        }
        workspace.run(&mut command)
    };
    let mut nextest = workspace.cargo();
    nextest.args(["nextest", "--version"]);
    nextest.stdout(Stdio::null()).stderr(Stdio::null());
    if nextest.status().is_ok_and(|status| status.success()) {
        run(&["nextest", "run"])?;
    } else {
        println!("without cargo-nextest, one test binary after the other:");
        run(&["test", "--lib", "--bins", "--tests", "--examples"])?;
    }
    run(&["test", "--doc"])?;
    Ok(match realtime {
        Ok(()) => Outcome::Passed,
        Err(why) => Outcome::Partly(why),
    })
}

/// Builds what the next three steps use. One after the other, each build would leave processors
/// idle. A step says itself what it lacks on this machine.
fn builds(workspace: &Workspace) -> anyhow::Result<()> {
    thread::scope(|scope| {
        let builds = [
            scope.spawn(|| {
                no_std(workspace)?;
                without_features(workspace)
            }),
            scope.spawn(|| peers::prepare(workspace)),
            scope.spawn(|| package::prepare(workspace).map(drop)),
        ];
        let ended = builds.map(|build| build.join().expect("no panic"));
        ended.into_iter().collect()
    })
}

/// Lints, warnings denied.
fn clippy(workspace: &Workspace, arguments: &[impl AsRef<OsStr>]) -> anyhow::Result<()> {
    let mut command = workspace.cargo();
    command.arg("clippy").args(arguments);
    workspace.run(command.args(["--", "-Dwarnings"]))
}

/// Lints driver, simulator and recorder without features.
fn without_features(workspace: &Workspace) -> anyhow::Result<()> {
    let packages = ["franka-async", "franka-sim", "franka-record"];
    let mut arguments = packages.map(|name| format!("--package={name}")).to_vec();
    arguments.push("--no-default-features".to_owned());
    // Other features, other dependencies: what the tests have built is of no use here.
    arguments.push(format!("--target-dir={}", bare_folder(workspace).display()));
    clippy(workspace, &arguments)
}

/// Checks protocol, model and generator for this machine, where the standard library exists and
/// must not be used, and for one where it does not.
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
        command.arg("check").arg("--manifest-path");
        command.arg(package.join("Cargo.toml")).arg("--target-dir");
        command.arg(bare_folder(workspace));
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

/// Where what is built without features goes, beside all else and at the same time: cargo builds
/// one thing at a time in a folder.
fn bare_folder(workspace: &Workspace) -> PathBuf {
    workspace.target().join("bare")
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

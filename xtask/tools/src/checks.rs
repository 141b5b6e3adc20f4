//! The steps of `cargo xtask check` and `cargo xtask nightly`, each list in the order in which they
//! are likely to fail.

use std::ffi::OsStr;
use std::fs;

use xtask::peers;
use xtask::selection::{self, LIVE, PACKAGES, packages};
use xtask::step::{Outcome, Step, step};
use xtask::workspace::Workspace;

use crate::cross::lacks;
use crate::others::OTHERS;
use crate::{
    book, circles, commands, cross, dashboard, mujoco, names, package, playground, prose,
    recordings, reference_pages, release, schemas, texts, tidy,
};

/// The steps of `cargo xtask check`.
pub(crate) const CHECK: &[Step] = &[
    step("fmt", "Formatting, and the width of comments", fmt),
    step(
        "circles",
        "No imports in a circle between the modules of a crate",
        |workspace| passed(circles::check(workspace)),
    ),
    step("texts", "Spelling, and the workflows", texts::check),
    step(
        "prose",
        "Plain English in comments, texts and the book",
        prose::check,
    ),
    step(
        "dependencies",
        "Licences and sources of the dependencies",
        texts::dependencies,
    ),
    step(
        "release",
        "Crates that can be published, one version everywhere",
        |workspace| release::check(workspace, release::Depth::default()),
    ),
    step(
        "schemas",
        "The code of recordings matches its definitions",
        |workspace| passed(schemas::check(workspace)),
    ),
    step(
        "book",
        "The book: its pages, programs and links",
        book::check,
    ),
    step(
        "assets",
        "The files of the dashboard's page match its sources",
        dashboard::check_assets,
    ),
    step("clippy", "Lints, warnings denied", |workspace| {
        let features = format!("--features={FEATURES}");
        passed(clippy(
            workspace,
            &["--workspace", "--all-targets", &features],
        ))
    }),
    step("doc", "Documentation, warnings denied", doc),
    step("names", "Public names, and their rows in the book", |it| {
        doc(it)?;
        let ours = names::check(it)?;
        reference_pages::check(it, &ours)?;
        passed(commands::check(it))
    }),
    step("quickstart", "The README's first command", |workspace| {
        let mut command = workspace.cargo();
        command.args(["run", "--release", "--example", "quickstart"]);
        passed(workspace.run(&mut command))
    }),
    step("rest", "The tests that `cargo xtask test` leaves out", rest),
    step(
        "bare",
        "The parts without features, and without the standard library",
        |workspace| {
            without_features(workspace)?;
            no_std(workspace)
        },
    ),
    step(
        "peers",
        "The other clients against the simulator",
        |workspace| peers::run(workspace, peers::Set::Rest),
    ),
    step(
        "python",
        "The Python package: its tests and types",
        package::run,
    ),
    step(
        "recordings",
        "Recordings, read by the standard reader in Python",
        recordings::run,
    ),
];

/// The steps of `cargo xtask nightly`.
pub(crate) const NIGHTLY: &[Step] = &[
    step(
        "mujoco",
        "The simulator's MuJoCo plant: lints and tests",
        |workspace| {
            mujoco::provide(workspace)?;
            let features = format!("--features={MUJOCO_FEATURES}");
            let mut arguments = packages(&MUJOCO);
            arguments.extend(["--all-targets".to_owned(), features.clone()]);
            clippy(workspace, &arguments)?;
            selection::tests(workspace, &MUJOCO, &[&features], "all()")
        },
    ),
    step(
        "phases",
        "All tests with every phase of a cycle timed",
        |workspace| {
            let targets = ["--features=franka-tests/cycle-phases"];
            selection::tests(workspace, &PACKAGES, &targets, "all()")
        },
    ),
    step(
        "dashboard",
        "The dashboard's page in a real browser",
        dashboard::run,
    ),
    step(
        "playground",
        "The book's playground in a real browser",
        playground::check,
    ),
    step(
        "targets",
        "The portable parts, for other systems and machines",
        cross::check,
    ),
];

/// The outcome of work that checks everything or fails.
fn passed(result: anyhow::Result<()>) -> anyhow::Result<Outcome> {
    result.map(|()| Outcome::Passed)
}

fn fmt(workspace: &Workspace) -> anyhow::Result<Outcome> {
    for manifest in MANIFESTS {
        let mut command = workspace.cargo();
        command.args(["fmt", "--all", "--check", "--manifest-path", manifest]);
        workspace.run(&mut command)?;
    }
    passed(tidy::check(workspace))
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

/// Builds the documentation of all features, which also shows the public names.
fn doc(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let mut command = workspace.cargo();
    command.args(["doc", "--workspace", "--no-deps", "--features"]);
    command.arg(format!(
        "{FEATURES},franka-async/model-library,franka-diagnosis/serde"
    ));
    passed(workspace.run(command.env("RUSTDOCFLAGS", "-Dwarnings")))
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
    let has_core = |target: &&&str| lacks(target, "libcore-").is_none();
    let bare = BARE_TARGETS.iter().find(has_core);
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

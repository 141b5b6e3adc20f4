//! What is not Rust: the spelling of everything, the workflows, what dependencies may be.

use crate::cross::is_installed;
use xtask::python::{NEWEST, OLDEST, Python};
use xtask::realtime::succeeds;
use xtask::step::Outcome;
use xtask::workspace::Workspace;

/// Of the step `texts`: spelling by typos, and workflows by zizmor and, where it is installed,
/// actionlint.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let python = match Python::find(OLDEST..=NEWEST) {
        Ok(python) => python,
        Err(why) => return Outcome::without(why),
    };
    let requirements = workspace.root().join("xtask/tools/texts/tools.txt");
    let interpreter = python.environment(workspace, "python-texts", &requirements)?;
    let tool = |name| workspace.program(interpreter.with_file_name(name));
    workspace.run(tool("typos").args(["--format", "brief"]))?;
    // Without the network: what it would ask for there are the hashes behind tags.
    let mut workflows = tool("zizmor");
    workflows.args(["--offline", "--quiet", "--no-progress", ".github"]);
    workspace.run(&mut workflows)?;
    if !is_installed("actionlint") {
        let what = "the workflows by actionlint, which is not installed";
        return Ok(Outcome::Partly(what.to_owned()));
    }
    workspace.run(&mut workspace.program("actionlint"))?;
    Ok(Outcome::Passed)
}

/// Of the step `dependencies`: licences, sources and bans by cargo-deny, where it is installed. It
/// is built from many crates, for longer than this step may take, so it is not installed here.
pub(crate) fn dependencies(workspace: &Workspace) -> anyhow::Result<Outcome> {
    if !succeeds(&["cargo", "deny", "--version"]) {
        let why = "cargo-deny is not installed; `cargo install --locked cargo-deny` does it";
        return Ok(Outcome::Skipped(why.to_owned()));
    }
    let mut deny = workspace.cargo();
    workspace.run(deny.args(["deny", "--locked", "check", "bans", "licenses", "sources"]))?;
    Ok(Outcome::Passed)
}

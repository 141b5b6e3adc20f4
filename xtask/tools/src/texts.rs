//! Checks of files other than Rust: the spelling of everything, the workflows, and the rules for
//! dependencies.

use std::collections::BTreeMap;

use anyhow::bail;

use crate::cross::is_installed;
use xtask::python;
use xtask::realtime::succeeds;
use xtask::step::Outcome;
use xtask::workspace::Workspace;

/// The step `texts`: names of files, spelling by typos, and workflows by zizmor and, if it is
/// installed, actionlint.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<Outcome> {
    check_paths(&workspace.git(&["ls-files", "-z"])?)?;
    let tools = "xtask/tools/texts/tools.txt";
    let interpreter = python::environment(workspace, "python-texts", tools)?;
    let tool = |name| workspace.program(interpreter.with_file_name(name));
    workspace.run(tool("typos").args(["--format", "brief"]))?;
    // Without the network, in which it would only look up the hashes behind tags.
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

/// Fails for paths, each with a NUL after it, that a checkout on Windows cannot have.
fn check_paths(paths: &str) -> anyhow::Result<()> {
    let mut spellings = BTreeMap::new();
    let mut wrong = Vec::new();
    for path in paths.split_terminator('\0') {
        if let Some(part) = path.split('/').find(|part| is_forbidden(part)) {
            wrong.push(format!("{path}: Windows has no {part:?}"));
        }
        if let Some(other) = spellings.insert(path.to_lowercase(), path) {
            wrong.push(format!("{path}: Windows takes it for {other}"));
        }
    }
    if !wrong.is_empty() {
        bail!("names of files:\n{}", wrong.join("\n"));
    }
    Ok(())
}

/// True for the name of a file or folder that Windows refuses: by its characters, by its end, or
/// because it names a device. Source: Microsoft, "Naming Files, Paths, and Namespaces".
fn is_forbidden(name: &str) -> bool {
    let stem = name.split('.').next().unwrap_or(name).to_lowercase();
    let numbered = stem.strip_suffix(|it: char| it.is_ascii_digit());
    let is_device = ["con", "prn", "aux", "nul"].contains(&&*stem)
        || numbered.is_some_and(|stem| ["com", "lpt"].contains(&stem));
    is_device
        || name.ends_with(['.', ' '])
        || name.contains(|it: char| it.is_control() || "<>:\"|?*\\".contains(it))
}

/// The step `dependencies`: licences, sources and bans by cargo-deny, if it is installed. Its build
/// takes longer than this step may take, so it is not installed here.
pub(crate) fn dependencies(workspace: &Workspace) -> anyhow::Result<Outcome> {
    if !succeeds(&["cargo", "deny", "--version"]) {
        let why = "cargo-deny is not installed; `cargo install --locked cargo-deny` does it";
        return Ok(Outcome::Skipped(why.to_owned()));
    }
    let mut deny = workspace.cargo();
    workspace.run(deny.args(["deny", "--locked", "check", "bans", "licenses", "sources"]))?;
    Ok(Outcome::Passed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_windows_cannot_have_are_found() {
        for path in [
            "sys/pci0000:00/net",
            "docs/why?.md",
            "src/aux.rs",
            "COM1",
            "a\\b",
            "folder./file",
            "end ",
        ] {
            assert!(
                check_paths(&format!("fine.rs\0{path}\0")).is_err(),
                "{path}"
            );
        }
        check_paths("sys/pci0000-00/1f.6\0auxiliary.rs\0.github/a b.yml\0com10\0").expect("fine");
    }

    #[test]
    fn names_that_differ_in_case_only_are_found() {
        let error = check_paths("docs/Page.md\0docs/page.md\0").expect_err("one file");
        assert!(error.to_string().contains("docs/Page.md"), "{error}");
    }
}

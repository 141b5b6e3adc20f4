//! Requirements of a release: publishable crates, one version everywhere, a change log.
//!
//! ```text
//! cargo xtask version X.Y.Z ──> manifests, lock file, CITATION.cff, CHANGELOG.md
//! cargo xtask release-check ──> crates: what their manifests say, packed in order, what is in the packages
//!                               texts: one version and one date in all of them
//!               --final ──> repository, date, clean tree, tag: all that is left to do
//! ```
//!
//! | module | content |
//! |---|---|
//! | this | the check, and the order in which crates are published |
//! | `changelog` | the form of the change log |
//! | `crates` | manifests and packages |
//! | `version` | setting the version, and finding it in every file |

pub(crate) mod changelog;
mod crates;
pub(crate) mod version;

use std::path::PathBuf;
use std::process::Stdio;

use anyhow::{Context as _, bail, ensure};

use changelog::Changelog;
use crates::Manifest;
use xtask::realtime::succeeds;
use xtask::step::Outcome;
use xtask::workspace::Workspace;

/// Checks besides the form.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Depth {
    /// Build each crate from its package; takes minutes.
    pub(crate) verify: bool,
    /// Check everything that must exist before a version is published.
    pub(crate) last: bool,
}

/// Checks crates and texts; fails with all defects.
pub(crate) fn check(workspace: &Workspace, depth: Depth) -> anyhow::Result<Outcome> {
    let manifests = Manifest::all(workspace)?;
    let published = crates::order(&manifests)?;
    let names: Vec<&str> = published.iter().map(|it| it.name.as_str()).collect();
    println!("published, in this order: {}", names.join(", "));
    let mut found: Vec<String> = published.iter().flat_map(|it| it.faults()).collect();
    found.extend(crates::pack(workspace, &published, depth.verify)?);
    let version = version::of(workspace)?;
    found.extend(version::faults(workspace, &version)?);
    let changelog = changelog::read(workspace)?;
    found.extend(changelog.faults());
    if depth.last {
        found.extend(last_faults(workspace, &published, &version, &changelog)?);
    }
    if !found.is_empty() {
        bail!("missing for a release:\n{}", found.join("\n"));
    }
    compare_with_last_release(workspace)
}

/// Packs the published crates, and returns the paths of the packages.
pub(crate) fn packages(workspace: &Workspace) -> anyhow::Result<Vec<PathBuf>> {
    let manifests = Manifest::all(workspace)?;
    let published = crates::order(&manifests)?;
    let found = crates::pack(workspace, &published, false)?;
    ensure!(found.is_empty(), "{}", found.join("\n"));
    let packages = published.iter().map(|it| it.package(workspace));
    Ok(packages.collect())
}

/// Missing requirements for publishing this version now.
fn last_faults(
    workspace: &Workspace,
    published: &[&Manifest],
    version: &str,
    changelog: &Changelog,
) -> anyhow::Result<Vec<String>> {
    let mut found = Vec::new();
    if published.iter().any(|it| !it.repository.contains("://")) {
        found.push("Cargo.toml: `repository` is not set".to_owned());
    }
    if version::maintainer(workspace)?.is_empty() {
        found.push("Cargo.toml: `maintainer` of the package for Debian is not set".to_owned());
    }
    let date = version::citation_date(workspace)?;
    match changelog.date_of(version) {
        None => found.push(format!(
            "CHANGELOG.md: no section [{version}]; `cargo xtask version {version}` makes it"
        )),
        Some(logged) if date.as_deref() != Some(logged) => found.push(format!(
            "CITATION.cff: got the release date {date:?}, expected {logged} as in CHANGELOG.md"
        )),
        Some(_) => {}
    }
    if !changelog.unreleased.trim().is_empty() {
        found.push(format!(
            "CHANGELOG.md: the unreleased part must move to {version}"
        ));
    }
    if !git(workspace, &["status", "--porcelain"])?.is_empty() {
        found.push("the tree has changes that are not committed".to_owned());
    }
    let tag = format!("v{version}");
    let tagged = git(workspace, &["tag", "--points-at", "HEAD"])?;
    let exists = git(workspace, &["tag", "--list", &tag])?;
    if !exists.is_empty() && !tagged.lines().any(|line| line == tag) {
        found.push(format!("the tag {tag} belongs to another commit"));
    }
    Ok(found)
}

/// Compares the public names with the last release, if any.
fn compare_with_last_release(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let tags = git(workspace, &["tag", "--list", "v*", "--sort=-v:refname"])?;
    let head = git(workspace, &["tag", "--points-at", "HEAD"])?;
    let Some(last) = tags.lines().find(|tag| !head.lines().any(|it| it == *tag)) else {
        println!("no earlier release to compare public names with");
        return Ok(Outcome::Passed);
    };
    if !succeeds(&["cargo", "semver-checks", "--version"]) {
        let missing = "cargo-semver-checks is not installed";
        return Ok(Outcome::Partly(format!(
            "{missing}: not compared with {last}"
        )));
    }
    let mut compare = workspace.cargo();
    compare.args(["semver-checks", "--baseline-rev", last]);
    compare.args(["--package", "franka-async", "--package", "franka-sim"]);
    workspace.run(&mut compare)?;
    Ok(Outcome::Passed)
}

/// Output of git.
pub(crate) fn git(workspace: &Workspace, arguments: &[&str]) -> anyhow::Result<String> {
    let mut git = workspace.program("git");
    let output = git.args(arguments).stderr(Stdio::inherit()).output();
    let output = output.context("cannot run git")?;
    if !output.status.success() {
        bail!("`git {}` failed: {}", arguments.join(" "), output.status);
    }
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}

//! Requirements of a release that neither Cargo nor cargo-release checks: the descriptions of the
//! published crates, the content of their packages, and the texts that name the version.
//!
//! `cargo release X.Y.Z` sets the version and the date in every file (`release.toml`).

use std::fs;
use std::path::PathBuf;

use anyhow::{Context as _, bail};
use cargo_metadata::{Metadata, Package};

use crate::metadata;
use xtask::realtime::succeeds;
use xtask::step::Outcome;
use xtask::workspace::Workspace;

/// The largest permitted package, in bytes. A registry accepts 10 MB, but ours are far smaller; a
/// larger one contains files that no user needs.
const SIZE_MAX: u64 = 1_000_000;

/// Files that every package must have.
const FILES: [&str; 4] = ["Cargo.toml", "LICENSE", "NOTICE", "README.md"];

/// Directories that belong to the workspace.
const LEFT_OUT: [&str; 2] = ["tests/", "target/"];

/// Additional checks.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Depth {
    /// Build each crate from its package; takes minutes.
    pub(crate) verify: bool,
    /// Check everything that must exist before a version is published.
    pub(crate) last: bool,
}

/// Checks crates and texts; fails with all defects.
pub(crate) fn check(workspace: &Workspace, depth: Depth) -> anyhow::Result<Outcome> {
    let metadata = metadata::of(workspace)?;
    let mut found: Vec<String> = published(&metadata).flat_map(description_faults).collect();
    for package in pack(workspace, &metadata, depth.verify)? {
        found.extend(package_faults(workspace, &package)?);
    }
    let read =
        |name: &str| fs::read_to_string(workspace.root().join(name)).context(name.to_owned());
    let (log, citation) = (read("CHANGELOG.md")?, read("CITATION.cff")?);
    let version = version(&metadata);
    if !citation.contains(&format!("\nversion: \"{version}\"\n")) {
        found.push(format!("CITATION.cff: expected version {version}"));
    }
    if depth.last {
        let set = |text: Option<&str>| text.is_some_and(|text| !text.is_empty());
        if !published(&metadata).all(|package| set(package.repository.as_deref())) {
            found.push("Cargo.toml: `repository` is not set".to_owned());
        }
        if !set(metadata.workspace_metadata["maintainer"].as_str()) {
            found.push("Cargo.toml: `maintainer` of the package for Debian is not set".to_owned());
        }
        let date = citation.lines().find_map(|line| {
            let date = line.strip_prefix("date-released: \"")?;
            date.strip_suffix('"')
        });
        let title = format!(
            "[{version}] - {}",
            date.unwrap_or("its date in CITATION.cff")
        );
        if !log.contains(&format!("\n## [Unreleased]\n\n## {title}\n")) {
            found.push(format!(
                "CHANGELOG.md: expected nothing unreleased, and then {title}"
            ));
        }
    }
    if !found.is_empty() {
        bail!("a release is not possible:\n{}", found.join("\n"));
    }
    compare_with_last_release(workspace)
}

/// Packs the published crates, and returns the paths of the packages.
pub(crate) fn packages(workspace: &Workspace) -> anyhow::Result<Vec<PathBuf>> {
    pack(workspace, &metadata::of(workspace)?, false)
}

/// The version of the workspace.
pub(crate) fn version(metadata: &Metadata) -> String {
    let package = published(metadata).next();
    package.map_or(String::new(), |package| package.version.to_string())
}

/// The packages that `cargo publish` publishes.
fn published(metadata: &Metadata) -> impl Iterator<Item = &Package> {
    metadata
        .packages
        .iter()
        .filter(|package| package.publish.is_none())
}

/// Defects that a registry would refuse after it took other crates, or that readers would miss.
fn description_faults(package: &Package) -> Vec<String> {
    let is_missing = |text: &Option<String>| text.as_deref().is_none_or(str::is_empty);
    let missing = [
        ("description", is_missing(&package.description)),
        ("license", is_missing(&package.license)),
        ("rust_version", package.rust_version.is_none()),
        ("readme", package.readme.is_none()),
    ];
    let missing = missing.iter().filter(|(_, is_missing)| *is_missing);
    let mut found: Vec<_> = missing.map(|(name, _)| format!("no {name}")).collect();
    let (keywords, categories) = (&package.keywords, &package.categories);
    for (name, words, max) in [("keywords", keywords, 20), ("categories", categories, 200)] {
        let allowed = |it: char| it.is_ascii_alphanumeric() || "_-+:".contains(it);
        let is_good = |word: &String| word.chars().all(allowed) && word.len() <= max;
        if !(1..=5).contains(&words.len()) || !words.iter().all(is_good) {
            found.push(format!("the {name} {words:?} would be refused"));
        }
    }
    let name = &package.name;
    found
        .iter()
        .map(|fault| format!("{name}: {fault}"))
        .collect()
}

/// Packs the published crates as `cargo publish` does, with `verify` also builds each from its
/// package, and returns the paths of the packages.
fn pack(workspace: &Workspace, metadata: &Metadata, verify: bool) -> anyhow::Result<Vec<PathBuf>> {
    let mut pack = workspace.cargo();
    pack.args(["package", "--locked", "--allow-dirty", "--quiet"]);
    pack.args((!verify).then_some("--no-verify"));
    let mut packages = Vec::new();
    for package in published(metadata) {
        let name = package.name.as_str();
        pack.args(["--package", name]);
        let file = format!("package/{name}-{}.crate", version(metadata));
        packages.push(workspace.target().join(file));
    }
    workspace.run(&mut pack)?;
    Ok(packages)
}

/// Missing files of a package, and files that should not be in it.
fn package_faults(workspace: &Workspace, package: &PathBuf) -> anyhow::Result<Vec<String>> {
    let name = package.file_stem().unwrap_or_default().to_string_lossy();
    let size = fs::metadata(package).with_context(|| name.to_string())?;
    let files = workspace.output(workspace.program("tar").arg("-tzf").arg(package))?;
    let prefix = format!("{name}/");
    let files: Vec<&str> = files
        .lines()
        .filter_map(|it| it.strip_prefix(&prefix))
        .collect();
    println!("{name}: {} files, {} kB", files.len(), size.len() / 1000);
    let missing = FILES.into_iter().filter(|name| !files.contains(name));
    let mut found: Vec<String> = missing.map(|it| format!("{name}: no {it}")).collect();
    let is_left_out = |it: &&&str| LEFT_OUT.iter().any(|folder| it.starts_with(folder));
    let strange = files.iter().filter(is_left_out);
    found.extend(strange.map(|it| format!("{name}: {it} should not be in it")));
    if size.len() > SIZE_MAX {
        found.push(format!("{name}: expected at most {SIZE_MAX} bytes"));
    }
    Ok(found)
}

/// Compares the public names with the last release, if any.
fn compare_with_last_release(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let tags = workspace.git(&["tag", "--list", "v*", "--sort=-v:refname"])?;
    let head = workspace.git(&["tag", "--points-at", "HEAD"])?;
    let Some(last) = tags.lines().find(|tag| !head.lines().any(|it| it == *tag)) else {
        println!("nothing was released yet that public names could be compared with");
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

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    #[test]
    fn a_manifest_has_all_that_a_reader_looks_for() {
        let package = json!({"name": "face", "description": "A crate", "license": "Apache-2.0",
            "rust_version": "1.89", "readme": "README.md", "keywords": ["robotics"],
            "categories": ["science::robotics"], "version": "1.0.0", "id": "face", "features": {},
            "dependencies": [], "targets": [], "manifest_path": "Cargo.toml"});
        let faults = |it: &Value| {
            let package = serde_json::from_value(it.clone()).expect("a package");
            description_faults(&package)
        };
        assert_eq!(faults(&package), Vec::<String>::new());
        for (name, value) in [
            ("description", json!("")),
            ("readme", json!(null)),
            ("keywords", json!(["a", "b", "c", "d", "e", "f"])),
            ("keywords", json!(["two words"])),
            ("keywords", json!(["a-word-of-21-letters-x"])),
            ("categories", json!([])),
        ] {
            let mut changed = package.clone();
            changed[name] = value;
            assert_eq!(faults(&changed).len(), 1, "{changed}");
        }
    }
}

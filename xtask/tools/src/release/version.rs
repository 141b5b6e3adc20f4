//! The version: one for all crates, the Python package (which takes it from its crate) and the
//! citation.

use std::fs;

use anyhow::{Context as _, ensure};
use jiff::Timestamp;
use semver::Version;
use toml_edit::{DocumentMut, Item, value};

use crate::metadata;
use crate::release::changelog;
use xtask::workspace::Workspace;

const MANIFEST: &str = "Cargo.toml";
/// The workspaces whose lock files name the version.
const LOCKED: [&str; 2] = [MANIFEST, "fuzz/Cargo.toml"];
const CITATION: &str = "CITATION.cff";

/// The version of the workspace.
pub(crate) fn of(workspace: &Workspace) -> anyhow::Result<String> {
    let manifest = read(workspace, MANIFEST)?.parse::<DocumentMut>()?;
    let version = manifest["workspace"]["package"]["version"].as_str();
    Ok(version.context("the workspace has no version")?.to_owned())
}

/// Maintainer of the package for Debian; empty if undecided.
pub(crate) fn maintainer(workspace: &Workspace) -> anyhow::Result<String> {
    let manifest = read(workspace, MANIFEST)?.parse::<DocumentMut>()?;
    let maintainer = manifest["workspace"]["metadata"]["maintainer"].as_str();
    Ok(maintainer
        .context("no maintainer, not even an empty one")?
        .to_owned())
}

/// Places with another version than the workspace.
pub(crate) fn faults(workspace: &Workspace, version: &str) -> anyhow::Result<Vec<String>> {
    let mut found = Vec::new();
    let manifest = read(workspace, MANIFEST)?.parse::<DocumentMut>()?;
    let expected = format!("={version}");
    for (name, got) in own(&manifest)? {
        if got != expected {
            found.push(format!(
                "{MANIFEST}: {name}: got {got}, expected {expected}"
            ));
        }
    }
    for package in metadata::packages(workspace)? {
        let (name, got) = (&package["name"], &package["version"]);
        if got.as_str() != Some(version) {
            found.push(format!("{name}: got version {got}, expected {version}"));
        }
    }
    let citation = read(workspace, CITATION)?;
    let got = field(&citation, "version");
    if got != Some(version) {
        found.push(format!(
            "{CITATION}: got version {got:?}, expected {version}"
        ));
    }
    Ok(found)
}

/// Release date of the version in the citation, if present: `YYYY-MM-DD`.
pub(crate) fn citation_date(workspace: &Workspace) -> anyhow::Result<Option<String>> {
    Ok(field(&read(workspace, CITATION)?, "date-released").map(str::to_owned))
}

/// Sets the version everywhere, and moves the unreleased changes of the change log to it.
pub(crate) fn set(
    workspace: &Workspace,
    version: &str,
    date: Option<String>,
) -> anyhow::Result<()> {
    let new =
        Version::parse(version).with_context(|| format!("got {version:?}, expected X.Y.Z"))?;
    let old = Version::parse(&of(workspace)?)?;
    ensure!(new >= old, "got {new}, expected {old} or newer");
    let date = date.unwrap_or_else(|| Timestamp::now().strftime("%F").to_string());
    ensure!(
        changelog::is_date(&date),
        "got {date:?}, expected YYYY-MM-DD"
    );
    let log = changelog::read(workspace)?;
    ensure!(
        log.date_of(version).is_none(),
        "CHANGELOG.md: {version} is already released"
    );
    ensure!(
        !log.unreleased.trim().is_empty(),
        "CHANGELOG.md: nothing is unreleased"
    );
    let mut manifest = read(workspace, MANIFEST)?.parse::<DocumentMut>()?;
    let names: Vec<String> = own(&manifest)?.into_iter().map(|(name, _)| name).collect();
    let tables = &mut manifest["workspace"];
    replace(&mut tables["package"]["version"], version);
    for name in names {
        replace(
            &mut tables["dependencies"][&name]["version"],
            &format!("={version}"),
        );
    }
    write(workspace, MANIFEST, &manifest.to_string())?;
    let citation = with_field(&read(workspace, CITATION)?, "version", version);
    write(
        workspace,
        CITATION,
        &with_field(&citation, "date-released", &date),
    )?;
    let text = changelog::released(&read(workspace, changelog::FILE)?, version, &date);
    write(workspace, changelog::FILE, &text)?;
    for manifest in LOCKED {
        let mut lock = workspace.cargo();
        workspace.run(lock.args(["update", "--workspace", "--manifest-path", manifest]))?;
    }
    println!("{version}, {date}: look at the difference, commit it, tag it v{version}");
    Ok(())
}

/// Replaces a text and keeps the blanks and comments around it.
fn replace(item: &mut Item, text: &str) {
    let decor = item.as_value().map(|it| it.decor().clone());
    *item = value(text);
    if let (Some(new), Some(decor)) = (item.as_value_mut(), decor) {
        *new.decor_mut() = decor;
    }
}

/// The workspace's crates that others depend on by version, with the required version.
fn own(manifest: &DocumentMut) -> anyhow::Result<Vec<(String, String)>> {
    let dependencies = manifest["workspace"]["dependencies"].as_table_like();
    let dependencies = dependencies.context("no dependencies of the workspace")?;
    let own = dependencies.iter().filter_map(|(name, it)| {
        it.get("path")?;
        Some((name.to_owned(), it.get("version")?.as_str()?.to_owned()))
    });
    let own: Vec<_> = own.collect();
    ensure!(
        !own.is_empty(),
        "no crate of the workspace is taken by its version"
    );
    Ok(own)
}

/// The value of a field at the top of a file of YAML.
fn field<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let prefix = format!("{name}:");
    let line = text.lines().find_map(|line| line.strip_prefix(&prefix))?;
    Some(line.trim().trim_matches('"'))
}

/// The file with another value of the field, which is appended if it is missing.
fn with_field(text: &str, name: &str, value: &str) -> String {
    let prefix = format!("{name}:");
    let new = format!("{name}: \"{value}\"");
    let mut lines: Vec<&str> = text.lines().collect();
    match lines.iter().position(|line| line.starts_with(&prefix)) {
        Some(at) => lines[at] = &new,
        None => lines.push(&new),
    }
    lines.join("\n") + "\n"
}

fn read(workspace: &Workspace, name: &str) -> anyhow::Result<String> {
    let text = fs::read_to_string(workspace.root().join(name));
    text.with_context(|| format!("cannot read {name}"))
}

fn write(workspace: &Workspace, name: &str, text: &str) -> anyhow::Result<()> {
    fs::write(workspace.root().join(name), text).with_context(|| format!("cannot write {name}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_is_replaced_or_added() {
        let text = "cff-version: 1.2.0\nversion: \"0.1.0\"\n";
        assert_eq!(field(text, "version"), Some("0.1.0"));
        assert_eq!(field(text, "date-released"), None);
        let text = with_field(
            &with_field(text, "version", "0.2.0"),
            "date-released",
            "2026-12-24",
        );
        assert_eq!(
            text,
            "cff-version: 1.2.0\nversion: \"0.2.0\"\ndate-released: \"2026-12-24\"\n"
        );
    }

    #[test]
    fn only_crates_with_path_and_version_are_the_workspaces_own() {
        let text = "[workspace.dependencies]\na = { version = \"=0.1.0\", path = \"a\" }\n\
            t = { path = \"tests\" }\nserde = \"1\"\nfutures = { version = \"0.3\" }\n";
        let own = own(&text.parse().unwrap()).unwrap();
        assert_eq!(own, [("a".to_owned(), "=0.1.0".to_owned())]);
    }

    #[test]
    fn a_replaced_value_keeps_what_stands_around_it() {
        let mut manifest: DocumentMut = "a = { version = \"=0.1.0\", path = \"a\" } # a\n"
            .parse()
            .unwrap();
        replace(&mut manifest["a"]["version"], "=0.2.0");
        assert_eq!(
            manifest.to_string(),
            "a = { version = \"=0.2.0\", path = \"a\" } # a\n"
        );
    }
}

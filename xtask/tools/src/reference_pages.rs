//! Required content of the reference chapters: every field of a state, every error of the robot,
//! every variant of the errors of `franka-async`, and a target for each link of an error.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, bail};

use crate::members::Members;
use crate::names::Ours;
use crate::page::{anchors, tables};
use xtask::workspace::Workspace;

/// Fails with every name that a chapter lacks, or that does not exist.
pub(crate) fn check(workspace: &Workspace, ours: &Ours) -> anyhow::Result<()> {
    let page = |name: &str| {
        let path = workspace.root().join("docs/src").join(name);
        fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))
    };
    let errors = page("errors.md")?;
    let mut state = Members::default();
    state.read(&workspace.root().join("franka-proto/src/robot/state"))?;
    let mut found = states(&page("states.md")?, &state);
    found.extend(variants(&errors, ours));
    let sources = ["franka-proto/src", "franka-rt/src", "franka-async/src"]
        .map(|path| workspace.root().join(path));
    let entries = entries(&sources)?;
    found.extend(robot_errors(&errors, workspace)?);
    let anchors = anchors(&errors);
    let lost = entries.iter().filter(|entry| !anchors.contains(*entry));
    found.extend(lost.map(|entry| format!("errors.md: no place {entry}")));
    if !found.is_empty() {
        bail!("reference chapters:\n{}", found.join("\n"));
    }
    println!("{} places for errors to lead to", entries.len());
    Ok(())
}

/// The fields of the robot's state, and of values computed from it.
fn states(page: &str, state: &Members) -> Vec<String> {
    let tables = tables(page);
    let of_robot = tables.iter().filter(|table| table.first() == "field");
    let named: BTreeSet<&str> = of_robot
        .flat_map(|table| table.rows.iter().flat_map(|row| row.spans(0)))
        .collect();
    let mut fields = state.parts("struct RobotState");
    fields.extend(state.parts("struct TotalLoad"));
    differences("states.md", &named, &fields)
}

/// The variants of each error that has a table, and a table for each error of the module `error`.
fn variants(page: &str, ours: &Ours) -> Vec<String> {
    let mut found = Vec::new();
    let mut told = BTreeSet::new();
    for table in tables(page) {
        let header = table.spans(0);
        let [name] = header[..] else { continue };
        let named: BTreeSet<&str> = table.rows.iter().flat_map(|row| row.spans(0)).collect();
        let variants = ours.members.parts(&format!("enum {name}"));
        found.extend(differences(
            &format!("errors.md: {name}"),
            &named,
            &variants,
        ));
        told.insert(name.to_owned());
    }
    let wanted = ours
        .errors()
        .into_iter()
        .filter(|name| !told.contains(name));
    found.extend(wanted.map(|name| format!("errors.md: no table of {name}")));
    found
}

/// The errors that a state can carry, each with an anchor.
fn robot_errors(page: &str, workspace: &Workspace) -> anyhow::Result<Vec<String>> {
    let source = workspace
        .root()
        .join("franka-proto/src/robot/robot_error.rs");
    let source = fs::read_to_string(&source).context("robot_error.rs")?;
    // `Variant = "name",`, a line each.
    let names = source.lines().filter_map(|line| {
        let (_, name) = line.strip_suffix("\",")?.split_once(" = \"")?;
        Some(name.to_owned())
    });
    let names: Vec<String> = names.collect();
    if names.len() != 41 {
        bail!("robot_error.rs: {} errors, expected 41", names.len());
    }
    let anchors = anchors(page);
    let lost = names.into_iter().filter(|name| !anchors.contains(name));
    Ok(lost
        .map(|name| format!("errors.md: no place {name}"))
        .collect())
}

/// Appends all Rust files below a directory.
fn read_all(directory: &Path, texts: &mut String) -> anyhow::Result<()> {
    for entry in fs::read_dir(directory)? {
        let path = entry?.path();
        if path.is_dir() {
            read_all(&path, texts)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            texts.push_str(&fs::read_to_string(&path)?);
        }
    }
    Ok(())
}

/// The names that methods `entry` return: all texts in functions called `entry` or `row`.
fn entries(directories: &[impl AsRef<Path>]) -> anyhow::Result<BTreeSet<String>> {
    let mut texts = String::new();
    for directory in directories {
        read_all(directory.as_ref(), &mut texts)?;
    }
    Ok(texts_of_entries(&texts).into_iter().collect())
}

/// The texts in the bodies of functions called `entry` or `row`, which rustfmt has laid out.
fn texts_of_entries(source: &str) -> Vec<String> {
    let mut texts = Vec::new();
    let mut end = None;
    for line in source.lines() {
        if line.contains("fn entry(") || line.contains("fn row(&self)") {
            let indent = line.len() - line.trim_start().len();
            end = Some(format!("{}}}", " ".repeat(indent)));
        } else if end.as_deref() == Some(line) {
            end = None;
        } else if end.is_some() && !line.trim_start().starts_with('#') {
            texts.extend(line.split('"').skip(1).step_by(2).map(str::to_owned));
        }
    }
    texts
}

/// A line for each name that is in one set only.
fn differences(place: &str, named: &BTreeSet<&str>, there: &BTreeSet<&str>) -> Vec<String> {
    let lacks = there
        .difference(named)
        .map(|name| format!("{place} lacks {name}"));
    let strange = named
        .difference(there)
        .map(|name| format!("{place} has {name}, which does not exist"));
    lacks.chain(strange).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_the_texts_of_their_functions() {
        let source = "impl A {\n    fn text() { \"no\" }\n    pub fn entry(&self) -> &'static str {\n        \
                      match self {\n            A => \"a-b\",\n            B => \"c\",\n        }\n    }\n    \
                      fn row(&self) -> Row {\n        match self {\n            A => (\"d\", B),\n        }\n    }\n    \
                      fn other() { \"no\" }\n}\n";
        assert_eq!(texts_of_entries(source), ["a-b", "c", "d"]);
    }

    #[test]
    fn names_of_one_side_are_told() {
        let set = |names: [&'static str; 2]| BTreeSet::from(names);
        let found = differences("x", &set(["a", "b"]), &set(["b", "c"]));
        assert_eq!(found, ["x lacks c", "x has a, which does not exist"]);
    }
}

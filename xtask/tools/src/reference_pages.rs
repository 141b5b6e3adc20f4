//! Required content of the reference chapters: every field of a state, every error of the robot,
//! every variant of the errors of `franka-async`, and a target for each link of an error. The names
//! in the chapters for users of other Rust and C++ packages exist.

use std::collections::BTreeSet;
use std::fs;

use anyhow::{Context as _, ensure};

use crate::names::Ours;
use crate::page::{Page, Table};
use xtask::workspace::Workspace;

/// Fails with every name that a chapter lacks, or that does not exist.
pub(crate) fn check(workspace: &Workspace, ours: &Ours) -> anyhow::Result<()> {
    let read = |path: &str| {
        let text = fs::read_to_string(workspace.root().join(path));
        text.with_context(|| format!("cannot read {path}"))
    };
    let errors = read("docs/src/errors.md")?;
    let mut found = states(&read("docs/src/states.md")?, ours);
    found.extend(variants(&errors, ours));
    let mut entries = robot_errors(&read("franka-proto/src/robot/robot_error.rs")?);
    ensure!(
        entries.len() == 41,
        "robot_error.rs: {} errors",
        entries.len()
    );
    let sources = [
        "franka-proto/src/*.rs",
        "franka-rt/src/*.rs",
        "franka-async/src/*.rs",
    ];
    for source in workspace.files(&sources)? {
        let text = fs::read_to_string(workspace.root().join(source))?;
        entries.extend(texts_of_entries(&text));
    }
    let is_lost = |entry: &&String| !errors.contains(&format!("id=\"{entry}\""));
    let lost = entries.iter().filter(is_lost);
    found.extend(lost.map(|entry| format!("errors.md: no place {entry}")));
    for (chapter, list) in [
        ("from-libfranka.md", "libfranka.txt"),
        ("from-franka-rs.md", "franka_rs.txt"),
    ] {
        let page = read(&format!("docs/src/{chapter}"))?;
        let names = read(&format!("tests/peers/names/{list}"))?;
        let tables = Page::parse(&page).tables;
        let strange = tables
            .iter()
            .flat_map(|table| ours_in(table, &tables, &names));
        let strange = strange.filter(|name| !name.starts_with("std::") && !ours.has(name));
        found.extend(strange.map(|name| format!("{chapter}: {name} is not a name of ours")));
    }
    ensure!(
        found.is_empty(),
        "reference chapters:\n{}",
        found.join("\n")
    );
    println!("{} places for errors to lead to", entries.len());
    Ok(())
}

/// The names of ours in the column `Rust`. A cell that begins with `same: ` names a type of ours
/// with members of the names in its row; `*` stands for those in the list of `names` without a row.
/// The tests of the Python package check the column `Python`, and that every name has a row.
fn ours_in(table: &Table, tables: &[Table], names: &str) -> Vec<String> {
    let Some(column) = table.column("Rust") else {
        return Vec::new();
    };
    let mut found = Vec::new();
    let of = &table.header[0].spans;
    for row in &table.rows {
        let (cell, mut members) = (&row[column], row[0].spans.clone());
        if members == ["*"] {
            let members_of = names
                .lines()
                .filter_map(|name| name.strip_prefix(&(of.concat() + "::")));
            let same = tables.iter().filter(|it| it.header[0].spans == *of);
            let rows: Vec<&str> = same.flat_map(Table::names).collect();
            let left = members_of.filter(|name| !rows.contains(name));
            members = left.map(str::to_owned).collect();
        }
        if cell.text.starts_with("same: ") {
            for of in &cell.spans {
                found.extend(members.iter().map(|member| format!("{of}::{member}")));
            }
        }
        found.extend(cell.spans.clone());
    }
    found
}

/// The fields of the robot's state, and of values computed from it.
fn states(page: &str, ours: &Ours) -> Vec<String> {
    let tables = Page::parse(page).tables;
    let of_robot = tables.iter().filter(|it| it.column("field") == Some(0));
    let named: BTreeSet<&str> = of_robot.flat_map(Table::names).collect();
    let mut fields = ours.members("structfield", "RobotState");
    fields.extend(ours.members("structfield", "TotalLoad"));
    differences("states.md", &named, &fields)
}

/// The variants of each error that has a table, and a table for each error of the module `error`.
fn variants(page: &str, ours: &Ours) -> Vec<String> {
    let mut found = Vec::new();
    let mut told = BTreeSet::new();
    for table in Page::parse(page).tables {
        let [name] = &table.header[0].spans[..] else {
            continue;
        };
        let named: BTreeSet<&str> = table.names().collect();
        let variants = ours.members("variant", name);
        let place = format!("errors.md: {name}");
        found.extend(differences(&place, &named, &variants));
        told.insert(name.to_owned());
    }
    let errors = ours.errors().into_iter();
    let wanted = errors.filter(|name| !told.contains(*name));
    found.extend(wanted.map(|name| format!("errors.md: no table of {name}")));
    found
}

/// The errors that a state can carry: `Variant = "name",`, a line each.
fn robot_errors(source: &str) -> BTreeSet<String> {
    let names = source.lines().filter_map(|line| {
        let (_, name) = line.strip_suffix("\",")?.split_once(" = \"")?;
        Some(name.to_owned())
    });
    names.collect()
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

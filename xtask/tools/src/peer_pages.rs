//! The chapters for users of other packages. Every public name of a package has a row, no row names
//! an item that does not exist, and our items in a row exist.
//!
//! ```text
//! tests/peers/names/x.txt ── the names of the package ──┐
//! docs/src/from-x.md ── tables: its name, ours ─────────┴─ the same ── ours: the face's sources
//! ```
//!
//! A table counts if its header has a column `Rust` or `Python`. If its first header cell has names
//! in code, the names below are members of each of them. `*`, or `Type.*`, stands for the members
//! that have no row. A cell that begins with `same: ` names a type of ours that has members of the
//! same names. Names in the column `Python` are checked by the package's own tests
//! (`franka-py/tests/test_names.py`).

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};

use crate::names::Ours;
use crate::page::{Table, tables};
use xtask::workspace::Workspace;

/// The list of a package's names, its chapter, and what separates a type from its member.
const PEERS: [(&str, &str, &str); 6] = [
    ("libfranka.txt", "from-libfranka.md", "::"),
    ("pylibfranka.txt", "from-pylibfranka.md", "."),
    ("franky.txt", "from-franky.md", "."),
    ("panda_py.txt", "from-panda-py.md", "."),
    ("franka_rs.txt", "from-franka-rs.md", "::"),
    ("franka.txt", "from-franka-rs-python.md", "."),
];

/// Fails with every missing row, and every name that does not exist.
pub(crate) fn check(workspace: &Workspace, ours: &Ours) -> anyhow::Result<()> {
    let mut found = Vec::new();
    let mut rows = 0;
    let read = |path: PathBuf| {
        let text = fs::read_to_string(workspace.root().join(&path));
        text.with_context(|| format!("cannot read {}", path.display()))
    };
    for (list, chapter, separator) in PEERS {
        let names = read(Path::new("tests/peers/names").join(list))?;
        let names = names_of(&names);
        let page = read(Path::new("docs/src").join(chapter))?;
        let maps: Vec<Table<'_>> = tables(&page).into_iter().filter(is_map).collect();
        let strange = maps
            .iter()
            .flat_map(|table| strange(table, &maps, &names, separator, ours));
        let faults = differences(&names, &maps, separator);
        let faults = faults.into_iter().chain(strange);
        found.extend(faults.map(|fault| format!("{chapter}: {fault}")));
        rows += maps.iter().map(|table| table.rows.len()).sum::<usize>();
    }
    if !found.is_empty() {
        bail!(
            "chapters for users of other packages:\n{}",
            found.join("\n")
        );
    }
    println!(
        "{rows} rows for the names of {} other packages",
        PEERS.len()
    );
    Ok(())
}

/// True if a table maps names to ours.
fn is_map(table: &Table<'_>) -> bool {
    ["Rust", "Python"]
        .iter()
        .any(|name| table.column(name).is_some())
}

/// The names of a list: a line each, without comments.
fn names_of(list: &str) -> BTreeSet<String> {
    let lines = list.lines().map(str::trim);
    let names = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    names.map(str::to_owned).collect()
}

/// The names before the members of a table: one for each type in its header, or an empty one.
fn prefixes(table: &Table<'_>, separator: &str) -> Vec<String> {
    let of = table.spans(0);
    if of.is_empty() {
        return vec![String::new()];
    }
    of.iter().map(|of| format!("{of}{separator}")).collect()
}

/// The names of a table's rows, with their types; a name that ends with `*` stands for others.
fn named(table: &Table<'_>, separator: &str) -> Vec<String> {
    let prefixes = prefixes(table, separator);
    let spans = table.rows.iter().flat_map(|row| row.spans(0));
    let names = spans.flat_map(|span| prefixes.iter().map(move |of| format!("{of}{span}")));
    names.collect()
}

/// The members of a type without a row on the page; `star` is the type, and `*`.
fn others<'a>(
    names: &'a BTreeSet<String>,
    maps: &[Table<'_>],
    star: &str,
    separator: &str,
) -> Vec<&'a str> {
    let spelled = maps.iter().flat_map(|table| named(table, separator));
    let spelled: BTreeSet<String> = spelled.collect();
    let of = star.strip_suffix(ALL_OTHERS).unwrap_or(star);
    let is_member = |name: &str| {
        let member = name.strip_prefix(of).filter(|_| !of.is_empty());
        member.is_some_and(|member| !member.contains(separator))
    };
    let names = names.iter().map(String::as_str);
    names
        .filter(|&name| is_member(name) && !spelled.contains(name))
        .collect()
}

/// A line for each name without a row, for each row without a name, and for each second row.
fn differences(names: &BTreeSet<String>, maps: &[Table<'_>], separator: &str) -> Vec<String> {
    let mut rows = BTreeSet::new();
    let mut faults = Vec::new();
    for table in maps {
        for row in &table.rows {
            if row.spans(0).is_empty() {
                faults.push(format!("a row without a name: {}", row.text()));
            }
        }
        for name in named(table, separator) {
            if name.ends_with(ALL_OTHERS) {
                let others = others(names, maps, &name, separator);
                if others.is_empty() {
                    faults.push(format!("{name} stands for nothing"));
                }
                rows.extend(others.into_iter().map(str::to_owned));
                continue;
            }
            if !names.contains(&name) {
                faults.push(format!("{name} is not in the list of its names"));
            }
            if !rows.insert(name.clone()) {
                faults.push(format!("{name} has two rows"));
            }
        }
    }
    let missing = names.difference(&rows);
    faults.extend(missing.map(|name| format!("{name} has no row")));
    faults
}

/// A line for each name in the column `Rust` that is not ours. After `same: ` a type follows whose
/// members have the names of the row.
fn strange(
    table: &Table<'_>,
    maps: &[Table<'_>],
    names: &BTreeSet<String>,
    separator: &str,
    ours: &Ours,
) -> Vec<String> {
    let Some(column) = table.column("Rust") else {
        return Vec::new();
    };
    let prefixes = prefixes(table, separator);
    let mut strange = Vec::new();
    for row in &table.rows {
        let spans = row.spans(column);
        strange.extend(spans.iter().map(|&span| span.to_owned()));
        if row.cell(column).starts_with(SAME) {
            let members = row.spans(0).into_iter().flat_map(|name| match name {
                ALL_OTHERS => {
                    let stars = prefixes.iter().map(|of| format!("{of}{ALL_OTHERS}"));
                    let others = stars.flat_map(|star| others(names, maps, &star, separator));
                    let member = |name: &'_ str| name.rsplit(separator).next().map(str::to_owned);
                    others.filter_map(member).collect()
                }
                name => vec![name.to_owned()],
            });
            let members: BTreeSet<String> = members.collect();
            for of in spans {
                strange.extend(members.iter().map(|member| format!("{of}::{member}")));
            }
        }
    }
    strange.retain(|name| !name.starts_with("std::") && !ours.has(name));
    strange
        .iter()
        .map(|name| format!("{name} is not a name of ours"))
        .collect()
}

/// The name of a row for all members without a separate row.
const ALL_OTHERS: &str = "*";

/// Prefix of a cell whose type has members with the names of the row.
const SAME: &str = "same: ";

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "\
text

| name | Rust | Python |
|---|---|---|
| `A`, `b` | `A` | |

| `A` | Rust | what differs |
|---|---|---|
| `c` | `A::c` | |

| other | table |
|---|---|
| `d` | |
";

    fn faults(names: &str, page: &str) -> Vec<String> {
        let maps: Vec<_> = tables(page).into_iter().filter(is_map).collect();
        differences(&names_of(names), &maps, "::")
    }

    #[test]
    fn a_name_has_one_row_and_a_row_a_name() {
        assert_eq!(faults("# x\nA\nb\nA::c\n", PAGE), Vec::<String>::new());
        assert_eq!(faults("A\nb\nA::c\nA::e", PAGE), ["A::e has no row"]);
        assert_eq!(
            faults("A\nb", PAGE),
            ["A::c is not in the list of its names"]
        );
        let twice = PAGE.replace("`A`, `b`", "`A`, `b`, `A`");
        assert_eq!(faults("A\nb\nA::c", &twice), ["A has two rows"]);
        let nameless = PAGE.replace("| `c` |", "| c |");
        assert_eq!(
            faults("A\nb", &nameless),
            ["a row without a name: c | `A::c` |"]
        );
    }
    #[test]
    fn a_header_of_two_names_has_the_members_of_both() {
        let page = PAGE.replace("| `A` | Rust", "| `A`, `b` | Rust");
        assert_eq!(faults("A\nb\nA::c\nb::c", &page), Vec::<String>::new());
        assert_eq!(
            faults("A\nb\nA::c", &page),
            ["b::c is not in the list of its names"]
        );
    }

    #[test]
    fn a_star_stands_for_the_members_without_a_row() {
        let page = format!("{PAGE}\n| `A` | Rust |\n|---|---|\n| `*` | `A` |\n");
        let all = "A\nb\nA::c\nA::d\nA::e";
        assert_eq!(faults(all, &page), Vec::<String>::new());
        let typed = PAGE.replace("`A`, `b` |", "`A`, `b`, `A::*` |");
        assert_eq!(faults(all, &typed), Vec::<String>::new());
        assert_eq!(
            faults(&format!("{all}\nA::d::f"), &page),
            ["A::d::f has no row"]
        );
        let none = "A\nb\nA::c";
        assert_eq!(faults(none, &page), ["A::* stands for nothing"]);
        let maps: Vec<_> = tables(&page).into_iter().filter(is_map).collect();
        assert_eq!(
            others(&names_of(all), &maps, "A::*", "::"),
            ["A::d", "A::e"]
        );
    }
}

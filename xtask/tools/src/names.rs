//! The public names of `franka-async`: few at the root, and each with its name in Python or the
//! reason why it has none. Programs of the book and the examples name no other crate of ours.
//!
//! ```text
//! cargo doc ──> all.html: items ──> page of each: fields, variants, methods, constants
//! ```

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};

use xtask::workspace::Workspace;

/// Number of public names at the root must be below this.
const ROOT_MAX: usize = 40;

/// The module whose names are also in other modules.
const PRELUDE: &str = "prelude";

/// Python name of each name: `name = franka_async.Name`, or `name: reason for its absence`. A line
/// about a module is about all of its names. The tests of the package look the names up.
const IN_PYTHON: &str = "franka-py/tests/rust_names.txt";

/// Crates that programs use, and the module of their names.
const CRATES: [(&str, &str); 2] = [("franka_async", ""), ("franka_sim", "franka_sim")];

/// Public names, as rustdoc shows them.
#[derive(Debug, Default)]
pub(crate) struct Ours {
    /// Members of each item by its path, as rustdoc writes them: `variant.Stopped`, `method.new`.
    items: BTreeMap<String, BTreeSet<String>>,
    modules: BTreeSet<String>,
}

/// Fails with every name that breaks a rule; returns the names.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<Ours> {
    let mut ours = Ours::default();
    for (library, prefix) in CRATES {
        ours.read(&workspace.target().join("doc").join(library), prefix)?;
    }
    let at_root = ours.names().filter(|name| !name.contains("::")).count();
    let table = workspace.root().join(IN_PYTHON);
    let table = fs::read_to_string(&table).with_context(|| format!("cannot read {IN_PYTHON}"))?;
    let mut found = ours.untold(&table);
    if at_root >= ROOT_MAX {
        found.push(format!("{at_root} names at the root, of {ROOT_MAX}"));
    }
    for page in pages(workspace)? {
        let text = fs::read_to_string(workspace.root().join(&page))?;
        let lines = text.lines().filter(|line| names_another_crate(line));
        found.extend(lines.map(|line| format!("{}: {line}", page.display())));
    }
    if !found.is_empty() {
        bail!("names of franka-async:\n{}", found.join("\n"));
    }
    println!("{at_root} names at the root of franka-async");
    Ok(ours)
}

/// True if a line of a program imports from a crate of ours that programs must not need.
fn names_another_crate(line: &str) -> bool {
    let ours = line.trim_start().strip_prefix("use franka_");
    let of_programs = ["async", "sim", "lockstep", "examples"];
    ours.is_some_and(|it| !of_programs.iter().any(|name| it.starts_with(name)))
}

impl Ours {
    /// Reads the pages of a crate.
    fn read(&mut self, pages: &Path, prefix: &str) -> anyhow::Result<()> {
        let read = |page: &Path| {
            let path = pages.join(page);
            fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))
        };
        let list = read("all.html".as_ref())?;
        let links = texts(&list, "<li><a href=\"");
        for page in links.filter(|page| page.ends_with(".html")) {
            self.insert(prefix, &page, &read(page.as_ref())?);
        }
        for module in self.modules.clone().into_iter().chain([prefix.to_owned()]) {
            let path = module.replace("::", "/");
            let path = Path::new(&path).strip_prefix(prefix);
            let Ok(path) = path else { continue };
            let html = read(&path.join("index.html"))?;
            let exported = texts(&html, "id=\"reexport.");
            let exported = exported.map(|name| (join(&module, &name), BTreeSet::new()));
            self.items.extend(exported);
        }
        Ok(())
    }

    /// Adds the item that this page describes, such as `goal/struct.Gains.html`.
    fn insert(&mut self, prefix: &str, page: &str, html: &str) {
        let (module, file) = page.rsplit_once('/').unwrap_or(("", page));
        let module = module.replace('/', "::");
        let module = match prefix {
            "" => module,
            prefix => join(prefix, &module).trim_end_matches("::").to_owned(),
        };
        let mut path = module.as_str();
        while !path.is_empty() && self.modules.insert(path.to_owned()) {
            path = path.rsplit_once("::").map_or("", |(outer, _)| outer);
        }
        let (kind, name) = file.split_once('.').unwrap_or_default();
        let name = name.trim_end_matches(".html");
        // The page of an alias repeats the members of the type.
        let is_alias = kind == "type";
        let members = texts(html, " id=\"").filter(|_| !is_alias).collect();
        self.items.insert(join(&module, name), members);
    }

    /// The names of `franka-async`, modules included.
    fn names(&self) -> impl Iterator<Item = &String> {
        let of_driver = |name: &&String| !name.starts_with("franka_sim");
        self.items.keys().chain(&self.modules).filter(of_driver)
    }

    /// The members of this kind (`variant`, `structfield`) of the items called `name`.
    pub(crate) fn members(&self, kind: &str, name: &str) -> BTreeSet<&str> {
        let of = |path: &str| path.rsplit("::").next() == Some(name);
        let items = self.items.iter().filter(|(path, _)| of(path));
        let members = items.flat_map(|(_, members)| members);
        let members = members.filter_map(|it| it.strip_prefix(kind)?.strip_prefix('.'));
        members.filter(|member| !member.contains('.')).collect()
    }

    /// The enumerations of errors: `MotionError`, and the enumerations of the module `error`.
    pub(crate) fn errors(&self) -> Vec<&str> {
        const ENDINGS: [&str; 5] = ["Error", "Fault", "Lapse", "Reason", "Unready"];
        let names = self.items.keys();
        let names = names.filter_map(|path| match path.as_str() {
            "MotionError" => Some("MotionError"),
            path => path.strip_prefix("error::"),
        });
        let is_error = |name: &&str| ENDINGS.iter().any(|ending| name.ends_with(ending));
        let errors = names.filter(is_error);
        errors
            .filter(|it| !self.members("variant", it).is_empty())
            .collect()
    }

    /// True if a program can write this: `module::Type::method`, `Type`, `module::function(..)`,
    /// `.method(..)` of any type, `franka_sim::Sim::fr3`.
    pub(crate) fn has(&self, span: &str) -> bool {
        let path = span.split(['(', '<', ' ']).next().unwrap_or_default();
        let path = path.strip_prefix("franka_async::").unwrap_or(path);
        let is_in = |members: &BTreeSet<String>, member: &str| {
            let ids = members.iter().filter_map(|id| id.split('.').nth(1));
            ids.into_iter()
                .any(|it| it.split('-').next() == Some(member))
        };
        if let Some(member) = path.strip_prefix('.') {
            return self.items.values().any(|members| is_in(members, member));
        }
        if self.items.contains_key(path) || self.modules.contains(path) {
            return true;
        }
        path.rsplit_once("::").is_some_and(|(item, member)| {
            let members = self.items.get(item);
            members.is_some_and(|members| is_in(members, member))
        })
    }

    /// A line for each name that is missing in the table, and for each name in the table that does
    /// not exist.
    fn untold(&self, table: &str) -> Vec<String> {
        let told = |line: &str| {
            let end = line.find(" = ").or_else(|| line.find(": "))?;
            Some(line[..end].to_owned())
        };
        let lines = table.lines().filter(|line| !line.starts_with('#'));
        let told: BTreeSet<String> = lines.filter_map(told).collect();
        let names: BTreeSet<&String> = self.names().collect();
        let is_told = |name: &str| {
            let outer = name.match_indices("::").map(|(end, _)| &name[..end]);
            outer
                .chain([name])
                .any(|it| told.contains(it) || it == PRELUDE)
        };
        let items = names.iter().filter(|name| !self.modules.contains(**name));
        let missing = items.filter(|name| !is_told(name)).map(|name| {
            format!("{IN_PYTHON} lacks {name} (`{name} = franka_async.X` or `{name}: why not`)")
        });
        let gone = told.iter().filter(|name| !names.contains(name));
        let gone = gone.map(|name| format!("{IN_PYTHON} has {name}, which franka-async lacks"));
        missing.chain(gone).collect()
    }
}

/// Each text between `begin` and the next quotation mark.
fn texts<'a>(html: &'a str, begin: &'a str) -> impl Iterator<Item = String> + 'a {
    let parts = html.split(begin).skip(1);
    parts.filter_map(|part| Some(part.split('"').next()?.to_owned()))
}

/// The path of a name of a module.
fn join(module: &str, name: &str) -> String {
    match module {
        "" => name.to_owned(),
        module => format!("{module}::{name}"),
    }
}

/// The pages of the book, in order.
pub(crate) fn pages(workspace: &Workspace) -> anyhow::Result<Vec<PathBuf>> {
    let mut pages = workspace.files(&["docs/src/*.md"])?;
    pages.sort();
    Ok(pages)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_name_has_one_in_python_or_a_reason() {
        let mut ours = Ours::default();
        for page in [
            "struct.C.html",
            "d/e/enum.E.html",
            "m/fn.f.html",
            "prelude/struct.C.html",
        ] {
            ours.insert("", page, "");
        }
        ours.insert("franka_sim", "struct.Sim.html", "");
        let told = "C = franka_async.C\nd: a module\nm::f: a generic function\n";
        assert_eq!(ours.untold(told), Vec::<String>::new());
        let found = ours.untold("# see: above\nC = franka_async.C\nd::e: x\nm::g: gone\n");
        assert!(found[0].contains(" lacks m::f "), "{found:?}");
        assert!(
            found[1].ends_with("has m::g, which franka-async lacks"),
            "{found:?}"
        );
        assert_eq!(found.len(), 2);
    }

    #[test]
    fn methods_fields_variants_and_constants_are_members() {
        let mut ours = Ours::default();
        let ids = [
            "variant.A",
            "variant.B.field.x",
            "method.new",
            "method.new-1",
            "structfield.q",
        ];
        let html = ids
            .map(|id| format!("<section id=\"{id}\" class=\"x\">"))
            .concat();
        ours.insert("", "error/enum.SomeError.html", &html);
        ours.insert("franka_sim", "struct.Sim.html", &html);
        assert_eq!(ours.members("variant", "SomeError"), BTreeSet::from(["A"]));
        assert_eq!(ours.members("structfield", "Sim"), BTreeSet::from(["q"]));
        assert_eq!(ours.errors(), ["SomeError"]);
        for span in [
            "error",
            "error::SomeError::new(1)",
            "franka_sim::Sim::q",
            ".new",
            ".q(..)",
        ] {
            assert!(ours.has(span), "{span}");
        }
        for span in [
            "SomeError",
            "error::SomeError::x",
            ".x",
            "franka_sim::Sim::z",
            "B",
        ] {
            assert!(!ours.has(span), "{span}");
        }
    }

    #[test]
    fn crates_that_programs_must_not_name_are_found() {
        assert!(names_another_crate("    use franka_model::READY;"));
        assert!(!names_another_crate("use franka_async::Robot;"));
        assert!(!names_another_crate("`franka_rt` runs the loop"));
    }
}

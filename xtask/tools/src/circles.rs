//! Imports that run in a circle between the top-level modules of a crate.
//!
//! A module that cannot be read without another one, which cannot be read without the first, is one
//! module in two places. An export at the root of a crate counts as the module where it is
//! declared. Unit tests do not count: they may use any module.
//!
//! `cargo modules dependencies --acyclic` (0.27) cannot replace this module. It checks all nested
//! modules and items, so a child that uses its parent counts as a circle.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context as _, bail};
use syn::visit::{self, Visit};
use syn::{Attribute, Item, UseTree};

use crate::metadata;
use xtask::workspace::Workspace;

/// Fails with the imports of each circle.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<()> {
    let crates = metadata::crates(workspace)?;
    let mut found = Vec::new();
    for (name, root) in &crates {
        let mut imports = Imports::default();
        let items = parse(root)?.items;
        let directory = root.parent().context("a file is in a directory")?;
        for item in &items {
            match item {
                Item::Mod(item) if item.content.is_none() && !is_for_tests(&item.attrs) => {
                    let module = item.ident.to_string();
                    imports.read(&module, &directory.join(&module).with_extension("rs"), 1)?;
                    imports.read(&module, &directory.join(&module), 1)?;
                }
                Item::Use(item) => imports.export(&item.tree, None),
                _ => {}
            }
        }
        found.extend(
            imports
                .circles()
                .into_iter()
                .map(|it| format!("{name}: {it}")),
        );
    }
    if !found.is_empty() {
        bail!("imports in a circle between modules:\n{}", found.join("\n"));
    }
    println!("{} crates, no circle", crates.len());
    Ok(())
}

fn parse(file: &Path) -> anyhow::Result<syn::File> {
    let text = fs::read_to_string(file).with_context(|| file.display().to_string())?;
    syn::parse_file(&text).with_context(|| file.display().to_string())
}

/// True for a Rust file, except one with unit tests.
fn is_source(path: &Path) -> bool {
    path.extension().is_some_and(|it| it == "rs") && !path.ends_with("tests.rs")
}

/// Imports of a crate's modules.
#[derive(Debug, Default)]
struct Imports {
    /// Names at the root of the crate, and their top-level modules.
    exported: BTreeMap<String, String>,
    /// Imports of each top-level module from the root of the crate, with one file each.
    found: BTreeMap<String, BTreeMap<String, String>>,
    /// The file that is read, its top-level module, and its number of modules below the root.
    file: String,
    module: String,
    depth: usize,
}

impl Imports {
    /// Reads a file, or all files below a directory, of a top-level module. `depth` is the number
    /// of modules in its path.
    fn read(&mut self, module: &str, path: &Path, depth: usize) -> anyhow::Result<()> {
        if path.is_dir() {
            for entry in fs::read_dir(path)? {
                let path = entry?.path();
                let is_same = path.ends_with("mod.rs");
                self.read(module, &path, depth + usize::from(!is_same))?;
            }
        } else if path.exists() && is_source(path) {
            self.file = path.display().to_string();
            self.module = module.to_owned();
            self.depth = depth;
            self.found.entry(module.to_owned()).or_default();
            self.visit_file(&parse(path)?);
        }
        Ok(())
    }

    /// Records a path, by its words, if it begins at the root of the crate.
    fn note(&mut self, words: &[String]) {
        let up = words.iter().take_while(|word| *word == "super").count();
        let name = match words {
            [first, name, ..] if first == "crate" => name,
            _ if up > 0 && up == self.depth => match words.get(up) {
                Some(name) => name,
                None => return,
            },
            _ => return,
        };
        let of = self.found.entry(self.module.clone()).or_default();
        of.entry(name.clone()).or_insert_with(|| self.file.clone());
    }

    /// Records the names that a `use` at the root of the crate imports. `module` is the first
    /// top-level module of the path, once it is known.
    fn export(&mut self, tree: &UseTree, module: Option<&str>) {
        each_path(tree, Vec::new(), &mut |path| {
            let path: Vec<&String> = path.iter().filter(|word| *word != "crate").collect();
            if let [first, .., last] = path[..] {
                let module = module.unwrap_or(first);
                self.exported.insert(last.clone(), module.to_owned());
            }
        });
    }

    /// A line for each import between modules that import each other, directly or through others.
    fn circles(&self) -> Vec<String> {
        let mut edges: BTreeMap<&str, BTreeMap<&str, &str>> = BTreeMap::new();
        for (from, names) in &self.found {
            for (name, file) in names {
                let module = self
                    .exported
                    .get(name)
                    .filter(|_| !self.found.contains_key(name));
                let to = module.unwrap_or(name);
                if to != from && self.found.contains_key(to) {
                    edges.entry(from).or_default().insert(to, file);
                }
            }
        }
        // A module that imports nothing left, or that nothing left imports, is in no circle.
        loop {
            let before = edges.len();
            let left: Vec<&str> = edges.keys().copied().collect();
            edges.retain(|_, to| to.keys().any(|to| left.contains(to)));
            let used: Vec<&str> = edges.values().flat_map(|to| to.keys().copied()).collect();
            edges.retain(|from, _| used.contains(from));
            if edges.len() == before {
                break;
            }
        }
        let left: Vec<&str> = edges.keys().copied().collect();
        let lines = edges.iter().flat_map(|(from, to)| {
            let to = to.iter().filter(|(to, _)| left.contains(to));
            to.map(move |(to, file)| format!("{from} imports {to} in {file}"))
        });
        lines.collect()
    }
}

impl<'a> Visit<'a> for Imports {
    fn visit_item_mod(&mut self, item: &'a syn::ItemMod) {
        if !is_for_tests(&item.attrs) {
            self.depth += 1;
            visit::visit_item_mod(self, item);
            self.depth -= 1;
        }
    }

    fn visit_item_use(&mut self, item: &'a syn::ItemUse) {
        if !is_for_tests(&item.attrs) {
            each_path(&item.tree, Vec::new(), &mut |path| self.note(path));
        }
    }

    fn visit_item_fn(&mut self, item: &'a syn::ItemFn) {
        if !is_for_tests(&item.attrs) {
            visit::visit_item_fn(self, item);
        }
    }

    fn visit_item_impl(&mut self, item: &'a syn::ItemImpl) {
        if !is_for_tests(&item.attrs) {
            visit::visit_item_impl(self, item);
        }
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        let words = path
            .segments
            .iter()
            .map(|segment| segment.ident.to_string());
        self.note(&words.collect::<Vec<_>>());
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &'a syn::Macro) {
        let text = item.tokens.to_string();
        for rest in text.split("crate :: ").skip(1) {
            let name = rest.split(' ').next().unwrap_or_default();
            self.note(&["crate".to_owned(), name.to_owned()]);
        }
    }
}

/// Calls `each` with every path of a `use`.
fn each_path(tree: &UseTree, mut path: Vec<String>, each: &mut impl FnMut(&[String])) {
    match tree {
        UseTree::Path(inner) => {
            path.push(inner.ident.to_string());
            each_path(&inner.tree, path, each);
        }
        UseTree::Group(group) => {
            for tree in &group.items {
                each_path(tree, path.clone(), each);
            }
        }
        UseTree::Name(name) if name.ident == "self" => each(&path),
        UseTree::Name(name) => {
            path.push(name.ident.to_string());
            each(&path);
        }
        UseTree::Rename(rename) => {
            let name = if path.is_empty() {
                &rename.ident
            } else {
                &rename.rename
            };
            path.push(name.to_string());
            each(&path);
        }
        UseTree::Glob(_) => each(&path),
    }
}

/// True if an attribute keeps its item for tests.
fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let is_test = |path: &syn::Path| path.is_ident("test") || path.is_ident("doctest");
        let condition = attribute.parse_args::<syn::Path>();
        attribute.path().is_ident("cfg") && condition.is_ok_and(|path| is_test(&path))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The circles of a crate with this root and these top-level modules.
    fn circles(root: &str, modules: &[(&str, &str)]) -> Vec<String> {
        let mut imports = Imports::default();
        for item in syn::parse_file(root).expect("it is Rust").items {
            if let Item::Use(item) = item {
                imports.export(&item.tree, None);
            }
        }
        for (module, text) in modules {
            imports.module = (*module).to_owned();
            imports.file = format!("{module}.rs");
            imports.depth = 1;
            imports.found.entry(imports.module.clone()).or_default();
            imports.visit_file(&syn::parse_file(text).expect("it is Rust"));
        }
        imports.circles()
    }

    #[test]
    fn modules_that_import_each_other_are_a_circle() {
        let (one, other) = (
            "use crate::b::{C, D};",
            "fn f() { super::a::g(); } use std::fmt;",
        );
        let expected = ["a imports b in a.rs", "b imports a in b.rs"];
        assert_eq!(circles("", &[("a", one), ("b", other)]), expected);
        assert_eq!(circles("", &[("a", one), ("b", "")]), Vec::<String>::new());
        let outside = ("c", "use crate::a;");
        assert_eq!(circles("", &[("a", one), ("b", other), outside]), expected);
        let macros = "m!(crate::a::X);";
        assert_eq!(circles("", &[("a", one), ("b", macros)]), expected);
    }

    #[test]
    fn an_export_of_the_root_is_in_its_module() {
        let modules = [("a", "use crate::b::C;"), ("b", "use crate::{D, std::E};")];
        let found = circles("pub use a::{x::D, F as G};", &modules);
        assert_eq!(found, ["a imports b in a.rs", "b imports a in b.rs"]);
    }

    #[test]
    fn tests_may_import_anything() {
        let tests = "#[cfg(test)] mod tests { use crate::a::X; } #[cfg(test)] use crate::a;";
        let found = circles("", &[("a", "use crate::b;"), ("b", tests)]);
        assert_eq!(found, Vec::<String>::new());
        let both = "#[cfg(any(test, feature = \"f\"))] use crate::a;";
        assert_eq!(circles("", &[("a", "use crate::b;"), ("b", both)]).len(), 2);
    }

    #[test]
    fn a_nested_module_goes_up_through_its_parents() {
        let nested = "mod m { use super::super::a::X; use super::a::Y; }";
        assert_eq!(
            circles("", &[("a", "use crate::b;"), ("b", nested)]).len(),
            2
        );
        let own = "mod m { use super::a::Y; }";
        let found = circles("", &[("a", "use crate::b;"), ("b", own)]);
        assert_eq!(found, Vec::<String>::new());
    }
}

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

use anyhow::{Context as _, anyhow, ensure};
use proc_macro2::{TokenStream, TokenTree};

use crate::metadata;
use xtask::workspace::Workspace;

/// Fails with the imports of each circle.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<()> {
    let crates = metadata::crates(workspace)?;
    let mut found = Vec::new();
    for (name, root) in &crates {
        let mut imports = Imports::default();
        let directory = root.parent().context("a file is in a directory")?;
        for module in imports.read_root(parse(root)?) {
            imports.read(&module, &directory.join(&module).with_extension("rs"), 1)?;
            imports.read(&module, &directory.join(&module), 1)?;
        }
        let circles = imports.circles().into_iter();
        found.extend(circles.map(|it| format!("{name}: {it}")));
    }
    let list = found.join("\n");
    ensure!(
        found.is_empty(),
        "imports in a circle between modules:\n{list}"
    );
    println!("{} crates, no circle", crates.len());
    Ok(())
}

fn parse(file: &Path) -> anyhow::Result<TokenStream> {
    let text = fs::read_to_string(file).with_context(|| file.display().to_string())?;
    let tokens = text.parse();
    tokens.map_err(|error| anyhow!("{}: {error}", file.display()))
}

/// Imports of a crate's modules.
#[derive(Debug, Default)]
struct Imports {
    /// Names at the root of the crate, and their top-level modules.
    exported: BTreeMap<String, String>,
    /// Imports of each top-level module from the root of the crate, with one file each.
    found: BTreeMap<String, BTreeMap<String, String>>,
    /// The file that is read, and its top-level module.
    file: String,
    module: String,
}

impl Imports {
    /// Reads what the root of the crate exports, and returns its modules in other files.
    fn read_root(&mut self, tokens: TokenStream) -> Vec<String> {
        let tokens = without_tests(tokens);
        let mut modules = Vec::new();
        for item in tokens.split(|token| token.to_string() == ";") {
            let words: Vec<_> = item.iter().map(ToString::to_string).collect();
            let begin = |word: &str| words.iter().position(|it| it == word);
            if let [.., keyword, module] = &words[..]
                && keyword == "mod"
            {
                modules.push(module.clone());
            } else if let Some(at) = begin("use") {
                self.export(&item[at + 1..], None);
            }
        }
        modules
    }

    /// Records the names that a `use` at the root of the crate imports. `module` is the first
    /// top-level module of the path, once it is known.
    fn export(&mut self, tree: &[TokenTree], module: Option<&str>) {
        for path in tree.split(|token| token.to_string() == ",") {
            let names = path.iter().filter_map(|token| match token {
                TokenTree::Ident(name) => Some(name.to_string()),
                _ => None,
            });
            let names: Vec<_> = names.filter(|it| it != "crate" && it != "self").collect();
            let module = module.or(names.first().map(String::as_str));
            match (path.last(), module) {
                (Some(TokenTree::Group(group)), _) => {
                    let inner: Vec<_> = group.stream().into_iter().collect();
                    self.export(&inner, module);
                }
                (Some(TokenTree::Ident(name)), Some(module)) => {
                    self.exported.insert(name.to_string(), module.to_owned());
                }
                _ => {}
            }
        }
    }

    /// Reads a file, or all files below a directory, of a top-level module, except files with unit
    /// tests. `depth` is the number of modules in its path.
    fn read(&mut self, module: &str, path: &Path, depth: usize) -> anyhow::Result<()> {
        if path.is_dir() {
            for entry in fs::read_dir(path)? {
                let path = entry?.path();
                let is_same = path.ends_with("mod.rs");
                self.read(module, &path, depth + usize::from(!is_same))?;
            }
        } else if path.extension().is_some_and(|it| it == "rs")
            && path.exists()
            && !path.ends_with("tests.rs")
        {
            self.file = path.display().to_string();
            module.clone_into(&mut self.module);
            self.found.entry(module.to_owned()).or_default();
            self.walk(parse(path)?, depth);
        }
        Ok(())
    }

    /// Records the paths that begin at the root of the crate, by `crate` or `depth` times `super`.
    fn walk(&mut self, tokens: TokenStream, depth: usize) {
        let tokens = without_tests(tokens);
        let word = |at: usize| tokens.get(at).map(ToString::to_string).unwrap_or_default();
        let is_path = |at: usize| word(at) == ":" && word(at + 1) == ":";
        let mut at = 0;
        while at < tokens.len() {
            let mut up = 0;
            while word(at) == "super" && is_path(at + 1) {
                (up, at) = (up + 1, at + 3);
            }
            if up == 0 && word(at) == "crate" && is_path(at + 1) {
                (up, at) = (depth, at + 3);
            }
            match tokens.get(at) {
                Some(TokenTree::Ident(name)) if up == depth => self.note(name.to_string()),
                Some(TokenTree::Group(group)) if up == depth => {
                    let paths: Vec<_> = group.stream().into_iter().collect();
                    for path in paths.split(|token| token.to_string() == ",") {
                        self.note(path.first().map_or(String::new(), ToString::to_string));
                    }
                }
                Some(TokenTree::Group(group)) => {
                    let is_module = at > 1 && word(at - 2) == "mod";
                    self.walk(group.stream(), depth + usize::from(is_module) - up);
                }
                _ => {}
            }
            at += 1;
        }
    }

    fn note(&mut self, name: String) {
        let of = self.found.entry(self.module.clone()).or_default();
        of.entry(name).or_insert_with(|| self.file.clone());
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

/// The tokens without the items for tests: an attribute, and all up to a semicolon or a block.
fn without_tests(tokens: TokenStream) -> Vec<TokenTree> {
    let mut kept = Vec::new();
    let mut tokens = tokens.into_iter().peekable();
    while let Some(token) = tokens.next() {
        let next = tokens.peek().map(|it| it.to_string().replace(' ', ""));
        let is_test = ["[cfg(test)]", "[cfg(doctest)]"].contains(&&*next.unwrap_or_default());
        if token.to_string() == "#" && is_test {
            let is_end = |token: &TokenTree| {
                let text = token.to_string();
                text == ";" || text.starts_with('{')
            };
            let _ = tokens.find(is_end);
        } else {
            kept.push(token);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The circles of a crate with this root and these top-level modules.
    fn circles(root: &str, modules: &[(&str, &str)]) -> Vec<String> {
        let mut imports = Imports::default();
        imports.read_root(root.parse().expect("it is Rust"));
        for (module, text) in modules {
            imports.module = (*module).to_owned();
            imports.file = format!("{module}.rs");
            imports.found.entry(imports.module.clone()).or_default();
            imports.walk(text.parse().expect("it is Rust"), 1);
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
        let found = circles("mod z; pub use a::{x::D, F as G};", &modules);
        assert_eq!(found, ["a imports b in a.rs", "b imports a in b.rs"]);
        let root = "#[cfg(test)] mod t; mod a; pub mod b;".parse();
        let found = Imports::default().read_root(root.expect("it is Rust"));
        assert_eq!(found, ["a", "b"]);
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
        let nested = "mod m { use super::{super::a::X, Z}; use super::a::Y; }";
        assert_eq!(
            circles("", &[("a", "use crate::b;"), ("b", nested)]).len(),
            2
        );
        let own = "mod m { use super::a::Y; }";
        let found = circles("", &[("a", "use crate::b;"), ("b", own)]);
        assert_eq!(found, Vec::<String>::new());
    }
}

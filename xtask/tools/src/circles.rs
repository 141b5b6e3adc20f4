//! Imports that run in a circle between the top-level modules of a crate.
//!
//! ```text
//! lib.rs, main.rs ── mod x; ──> files ── crate::a, super::a ──> module -> module ──> circles
//! ```
//!
//! A module that cannot be read without another one, which cannot be read without the first, is one
//! module in two places. An export at the root of a crate counts as the module where it is
//! declared. Unit tests do not count: they may use any module.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr as _;

use anyhow::{Context as _, anyhow, bail};
use proc_macro2::{Delimiter, TokenStream, TokenTree};

use crate::metadata;
use xtask::workspace::Workspace;

/// Fails with each circle, and the places of its imports.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<()> {
    let crates = metadata::crates(workspace)?;
    let mut found = Vec::new();
    for (name, root) in &crates {
        for circle in Imports::of(root)?.circles() {
            found.push(format!("{name}: {}", circle.tell(workspace.root())));
        }
    }
    if !found.is_empty() {
        bail!("imports in a circle between modules:\n{}", found.join("\n"));
    }
    println!("{} crates, no circle", crates.len());
    Ok(())
}

/// Position of an import.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Place {
    file: PathBuf,
    line: usize,
}

/// Modules that all import each other, directly or through other modules of the circle.
#[derive(Debug, PartialEq, Eq)]
struct Circle {
    modules: BTreeSet<String>,
    /// The shortest circle: each module imports the next one, the last one the first.
    way: Vec<(String, Place)>,
}

impl Circle {
    /// Its modules, and a line per import of the circle.
    fn tell(&self, root: &Path) -> String {
        let modules: Vec<&str> = self.modules.iter().map(String::as_str).collect();
        let mut text = modules.join(", ");
        for (index, (from, place)) in self.way.iter().enumerate() {
            let (to, _) = &self.way[(index + 1) % self.way.len()];
            let file = place.file.strip_prefix(root).unwrap_or(&place.file);
            text += &format!(
                "\n    {from} imports {to} at {}:{}",
                file.display(),
                place.line
            );
        }
        text
    }
}

/// Imports of a crate's modules, as they are read.
#[derive(Debug, Default)]
struct Imports {
    modules: BTreeSet<String>,
    /// Names at the root of the crate, and their top-level modules.
    exported: BTreeMap<String, String>,
    /// The importing top-level module, the imported name at the root of the crate, and the place.
    found: Vec<(String, String, Place)>,
}

impl Imports {
    /// Reads a crate from the file of its root.
    fn of(root: &Path) -> anyhow::Result<Self> {
        let mut imports = Self::default();
        imports.read(root, &[], true)?;
        Ok(imports)
    }

    /// Reads a file as the module `path`. Modules of a `root`, and of a `mod.rs`, are in the same
    /// directory; modules of another file are in a directory of its name.
    fn read(&mut self, file: &Path, path: &[String], is_root: bool) -> anyhow::Result<()> {
        let text = fs::read_to_string(file)
            .with_context(|| format!("module {} has no {}", path.join("::"), file.display()))?;
        let tokens = TokenStream::from_str(&text)
            .map_err(|error| anyhow!("cannot read {}: {error}", file.display()))?;
        let directory = if is_root || file.ends_with("mod.rs") {
            file.with_file_name("")
        } else {
            file.with_extension("")
        };
        self.scan(tokens, path, file, &directory)
    }

    fn scan(
        &mut self,
        tokens: TokenStream,
        path: &[String],
        file: &Path,
        directory: &Path,
    ) -> anyhow::Result<()> {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut rest = &tokens[..];
        // From an attribute of the next module.
        let mut located = None;
        while let Some((token, after)) = rest.split_first() {
            rest = after;
            match (token, after) {
                (TokenTree::Punct(hash), [TokenTree::Group(attribute), after @ ..])
                    if hash.as_char() == '#' =>
                {
                    rest = after;
                    if is_for_tests(attribute.stream()) {
                        rest = after_item(after);
                    }
                    located = path_of(attribute.stream()).or(located);
                }
                (TokenTree::Ident(word), [TokenTree::Ident(name), after @ ..]) if word == "mod" => {
                    let name = name.to_string();
                    let path = [path, std::slice::from_ref(&name)].concat();
                    if let [name] = &path[..] {
                        self.modules.insert(name.clone());
                    }
                    if let Some(TokenTree::Group(body)) = after.first() {
                        self.scan(body.stream(), &path, file, &directory.join(&name))?;
                        rest = &after[1..];
                    } else {
                        let beside = directory.join(&name).with_extension("rs");
                        let within = directory.join(&name).join("mod.rs");
                        let file = match located.take() {
                            Some(located) => file.with_file_name(located),
                            None if within.exists() => within,
                            None => beside,
                        };
                        self.read(&file, &path, false)?;
                    }
                }
                (TokenTree::Ident(word), after) if word == "use" && path.is_empty() => {
                    // The purpose of the root is to import from everywhere.
                    self.export(after, None);
                    rest = after_item(after);
                }
                (TokenTree::Ident(word), after) if word == "crate" || word == "super" => {
                    let line = word.span().start().line;
                    let place = || Place {
                        file: file.to_owned(),
                        line,
                    };
                    let (up, named) = climb(word == "super", after);
                    let is_at_root = word == "crate" || up == path.len();
                    if let (Some(module), true, Some(named)) = (path.first(), is_at_root, named) {
                        for name in first_names(named) {
                            self.found.push((module.clone(), name, place()));
                        }
                    }
                }
                (TokenTree::Group(group), _) => {
                    self.scan(group.stream(), path, file, directory)?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Records the names that a `use` at the root of the crate imports. `module` is the first
    /// top-level module of the path, once it is known.
    fn export(&mut self, tokens: &[TokenTree], module: Option<&str>) {
        let mut module = module.map(str::to_owned);
        let mut last = None;
        let mut rest = tokens;
        while let Some((token, after)) = rest.split_first() {
            rest = after;
            match token {
                TokenTree::Punct(sign) if [',', ';'].contains(&sign.as_char()) => break,
                TokenTree::Punct(_) => {}
                TokenTree::Ident(word) if word == "as" || word == "self" || word == "crate" => {}
                TokenTree::Ident(word) => {
                    module.get_or_insert_with(|| word.to_string());
                    last = Some(word.to_string());
                }
                TokenTree::Group(group) => {
                    let members: Vec<TokenTree> = group.stream().into_iter().collect();
                    let is_comma = |token: &TokenTree| matches!(token, TokenTree::Punct(sign) if sign.as_char() == ',');
                    for member in members.split(is_comma) {
                        self.export(member, module.as_deref());
                    }
                    last = None;
                }
                TokenTree::Literal(_) => {}
            }
        }
        if let (Some(module), Some(last)) = (module, last) {
            self.exported.insert(last, module);
        }
    }

    /// The imports between different top-level modules, and the first place of each.
    fn edges(&self) -> BTreeMap<&str, BTreeMap<&str, &Place>> {
        let mut edges = BTreeMap::<_, BTreeMap<_, _>>::new();
        for (from, name, place) in &self.found {
            let to = match self.modules.get(name) {
                Some(module) => Some(module),
                None => self
                    .exported
                    .get(name)
                    .and_then(|name| self.modules.get(name)),
            };
            if let Some(to) = to.filter(|to| *to != from) {
                let from = edges.entry(from.as_str()).or_default();
                from.entry(to.as_str()).or_insert(place);
            }
        }
        edges
    }

    /// Every largest set of modules that import each other.
    fn circles(&self) -> Vec<Circle> {
        let edges = self.edges();
        let mut circles: Vec<Circle> = Vec::new();
        for module in edges.keys() {
            if circles
                .iter()
                .any(|circle| circle.modules.contains(*module))
            {
                continue;
            }
            let Some(way) = shortest_way(&edges, module, module) else {
                continue;
            };
            let is_beside = |other: &&&str| {
                shortest_way(&edges, module, other).is_some()
                    && shortest_way(&edges, other, module).is_some()
            };
            let modules = edges.keys().filter(is_beside);
            circles.push(Circle {
                modules: modules.map(|module| (*module).to_owned()).collect(),
                way,
            });
        }
        circles
    }
}

/// The shortest path from one module to another, with at least one import: each module on it except
/// the last, and the place where it imports the next one.
fn shortest_way(
    edges: &BTreeMap<&str, BTreeMap<&str, &Place>>,
    from: &str,
    to: &str,
) -> Option<Vec<(String, Place)>> {
    let mut ways = VecDeque::from([(from, Vec::new())]);
    let mut seen = BTreeSet::new();
    while let Some((module, way)) = ways.pop_front() {
        for (next, place) in edges.get(module).into_iter().flatten() {
            let mut way = way.clone();
            way.push((module.to_owned(), (*place).clone()));
            if *next == to {
                return Some(way);
            }
            if seen.insert(*next) {
                ways.push_back((next, way));
            }
        }
    }
    None
}

/// Number of modules that `super::` goes up, including `from_super`, and the tokens after the last
/// `::`; `None` without any `::`.
fn climb(from_super: bool, mut rest: &[TokenTree]) -> (usize, Option<&[TokenTree]>) {
    let mut up = usize::from(from_super);
    loop {
        let [TokenTree::Punct(a), TokenTree::Punct(b), after @ ..] = rest else {
            return (up, None);
        };
        if (a.as_char(), b.as_char()) != (':', ':') {
            return (up, None);
        }
        match after {
            [TokenTree::Ident(word), more @ ..] if word == "super" => {
                up += 1;
                rest = more;
            }
            _ => return (up, Some(after)),
        }
    }
}

/// The next names of a path: one name, or the names of a list in braces.
fn first_names(tokens: &[TokenTree]) -> Vec<String> {
    match tokens.first() {
        Some(TokenTree::Ident(name)) => vec![name.to_string()],
        Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace => {
            let members: Vec<TokenTree> = group.stream().into_iter().collect();
            members
                .split(|token| matches!(token, TokenTree::Punct(sign) if sign.as_char() == ','))
                .flat_map(first_names)
                .collect()
        }
        _ => Vec::new(),
    }
}

/// True if an attribute keeps its item for tests.
fn is_for_tests(attribute: TokenStream) -> bool {
    let words = words(attribute);
    let has = |name: &str| words.iter().any(|word| word == name);
    words.first().is_some_and(|word| word == "cfg")
        && (has("test") || has("doctest"))
        && !has("not")
        && !has("any")
}

/// The file in an attribute `path`.
fn path_of(attribute: TokenStream) -> Option<String> {
    let tokens: Vec<TokenTree> = attribute.into_iter().collect();
    match &tokens[..] {
        [TokenTree::Ident(word), _, TokenTree::Literal(file)] if word == "path" => {
            Some(file.to_string().trim_matches('"').to_owned())
        }
        _ => None,
    }
}

/// All identifiers, including those in groups.
fn words(tokens: TokenStream) -> Vec<String> {
    let of = |token| match token {
        TokenTree::Ident(word) => vec![word.to_string()],
        TokenTree::Group(group) => words(group.stream()),
        _ => Vec::new(),
    };
    tokens.into_iter().flat_map(of).collect()
}

/// The tokens after the item that begins here: after its semicolon or its braces. `use` has braces
/// before its semicolon.
fn after_item(tokens: &[TokenTree]) -> &[TokenTree] {
    let is_use = tokens
        .iter()
        .take(3)
        .any(|token| token.to_string() == "use");
    let ends = |token: &TokenTree| match token {
        TokenTree::Punct(sign) => sign.as_char() == ';',
        TokenTree::Group(group) => !is_use && group.delimiter() == Delimiter::Brace,
        _ => false,
    };
    match tokens.iter().position(ends) {
        Some(end) => &tokens[end + 1..],
        None => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The circles of a crate of these files, each with its modules and its shortest circle.
    fn circles(files: &[(&str, &str)]) -> Vec<(Vec<String>, Vec<String>)> {
        static NEXT: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let next = NEXT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let name = format!("circles-{}-{next}", std::process::id());
        let directory = std::env::temp_dir().join(name);
        for (file, text) in files {
            let file = directory.join(file);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, text).unwrap();
        }
        let imports = Imports::of(&directory.join("lib.rs")).unwrap();
        fs::remove_dir_all(&directory).unwrap();
        let told = |(module, place): (String, Place)| {
            let file = place
                .file
                .strip_prefix(&directory)
                .unwrap()
                .display()
                .to_string();
            format!("{module} {file}:{}", place.line)
        };
        let circles = imports.circles().into_iter().map(|circle| {
            let way = circle.way.into_iter().map(told).collect();
            (circle.modules.into_iter().collect(), way)
        });
        circles.collect()
    }

    #[test]
    fn a_circle_is_told_with_the_place_of_each_import() {
        let found = circles(&[
            ("lib.rs", "mod a;\nmod b;\nmod c;\n"),
            (
                "a.rs",
                "use crate::c::C;\nuse crate::{b::B, std};\nmod deep;\n",
            ),
            ("a/deep.rs", "use super::super::c::C;\n"),
            (
                "b/mod.rs",
                "//! Text.\nfn f() -> crate::c::C { super::c::make() }\n",
            ),
            ("c.rs", "\nuse crate::b;\n"),
        ]);
        let modules = vec!["b".to_owned(), "c".to_owned()];
        let way = vec!["b b/mod.rs:2".to_owned(), "c c.rs:2".to_owned()];
        assert_eq!(found, [(modules, way)]);
    }

    #[test]
    fn what_the_root_exports_counts_as_its_module() {
        let found = circles(&[
            (
                "lib.rs",
                "mod a;\nmod b;\npub use a::{deep::Thing as Other, More};\n",
            ),
            ("a.rs", "mod deep { use super::super::b::B; }\n"),
            ("b.rs", "use crate::Other;\n"),
        ]);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].1, ["a a.rs:1", "b b.rs:1"]);
    }

    #[test]
    fn neighbours_within_a_module_and_unit_tests_do_not_count() {
        let found = circles(&[
            (
                "lib.rs",
                "mod a;\nmod b;\n#[cfg(test)]\nmod tests;\nfn f() { crate::a::f() }\n",
            ),
            (
                "a.rs",
                "mod x { use super::y::Y; }\nmod y { use super::x::X; use crate::b::B; }\n",
            ),
            (
                "b.rs",
                "#[cfg(test)]\nmod tests { use crate::a::A; }\n#[cfg(test)]\nuse crate::{a::A};\n\
                 pub(crate) fn f() {}\n",
            ),
        ]);
        assert_eq!(found, []);
    }
}

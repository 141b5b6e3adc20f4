//! Rules for the names of `franka-async`: few at the root, and none in two places. Each has its
//! name in Python, or the reason why it has none. Examples, book and README name no other crate of
//! ours.
//!
//! ```text
//! lib.rs ── pub mod x; ──> files ── pub use a::B, pub struct C ──> module, name, path of the item
//! ```
//!
//! An item is identified by the path of a `pub use`, or by the module that declares it. The check
//! cannot see that two paths lead to the same item, so a name for different items in two modules
//! must be in [`NAMESAKES`].

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use anyhow::{Context as _, bail, ensure};
use syn::{Item, UseTree, Visibility};

use crate::metadata;
use xtask::workspace::Workspace;

/// Number of public names at the root must be below this.
const ROOT_MAX: usize = 40;

/// The module whose names are also in other modules.
const PRELUDE: &str = "prelude";

/// Names of different items in different modules.
const NAMESAKES: [&str; 9] = [
    "Axis",
    "Condition",
    "Finding",
    "Grasp",
    "Load",
    "Quantity",
    "State",
    "System",
    "collision",
];

/// Python name of each name: `name = franka_async.Name`, or `name: reason for its absence`. The
/// tests of the package look the names up.
const IN_PYTHON: &str = "franka-py/tests/rust_names.txt";

/// Crates of ours on which programs depend.
const FOR_PROGRAMS: [&str; 4] = [
    "franka-async",
    "franka-sim",
    "franka-lockstep",
    "franka-examples",
];

/// Fails with every name that breaks a rule.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<()> {
    let is_face = |(name, _): &&(String, _)| name == "franka_async";
    let crates = metadata::crates(workspace)?;
    let (_, root) = crates.iter().find(is_face).context("no face")?;
    let names = Names::of(root)?;
    let at_root = names.modules[""].len();
    let mut found = names.faults();
    let table = workspace.root().join(IN_PYTHON);
    let table = fs::read_to_string(&table).with_context(|| format!("cannot read {IN_PYTHON}"))?;
    found.extend(names.untold(&table));
    for text in [workspace.root().join("README.md")]
        .into_iter()
        .chain(pages(&workspace.root().join("docs/src"))?)
    {
        let name = text.strip_prefix(workspace.root()).unwrap_or(&text);
        let programs = programs(&fs::read_to_string(&text)?).replace('_', "-");
        found.extend(others(&programs).map(|other| format!("{}: names {other}", name.display())));
    }
    let manifest = fs::read_to_string(workspace.root().join("examples/Cargo.toml"))?;
    found.extend(others(&manifest).map(|other| format!("examples/Cargo.toml: names {other}")));
    if !found.is_empty() {
        bail!("names of franka-async:\n{}", found.join("\n"));
    }
    println!("{at_root} names at the root of franka-async, none in two places");
    Ok(())
}

/// Names that each public module offers, and the items behind them. The root is the module "".
#[derive(Debug, Default)]
pub(crate) struct Names {
    pub(crate) modules: BTreeMap<String, BTreeMap<String, String>>,
    /// Modules that count as names themselves, without their content.
    opaque: &'static [&'static str],
}

impl Names {
    /// The public names of the crate with this root file.
    pub(crate) fn of(root: &Path) -> anyhow::Result<Self> {
        Self::with_opaque(root, &[])
    }

    /// The same, without the content of some of its modules.
    pub(crate) fn with_opaque(
        root: &Path,
        opaque: &'static [&'static str],
    ) -> anyhow::Result<Self> {
        let mut names = Self {
            opaque,
            ..Self::default()
        };
        names.read(root, "", true)?;
        Ok(names)
    }

    /// Place of declaration of a name of a public module, through public modules only.
    pub(crate) fn declared_at(&self, module: &str, name: &str) -> String {
        let place = join(module, name);
        let Some(path) = self.modules.get(module).and_then(|names| names.get(name)) else {
            return place;
        };
        let relative = join(module, path);
        for target in [&relative, path] {
            let (outer, last) = target.rsplit_once("::").unwrap_or(("", target));
            let is_known = self
                .modules
                .get(outer)
                .is_some_and(|of| of.contains_key(last));
            if is_known && *target != place {
                return self.declared_at(outer, last);
            }
        }
        if *path == place { place } else { relative }
    }

    fn read(&mut self, file: &Path, module: &str, is_root: bool) -> anyhow::Result<()> {
        let text =
            fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?;
        let parsed =
            syn::parse_file(&text).with_context(|| format!("cannot parse {}", file.display()))?;
        let directory = match is_root || file.ends_with("mod.rs") {
            true => file.with_file_name(""),
            false => file.with_extension(""),
        };
        self.scan(&parsed.items, module, &directory)
    }

    fn scan(&mut self, items: &[Item], module: &str, directory: &Path) -> anyhow::Result<()> {
        self.modules.entry(module.to_owned()).or_default();
        for item in items {
            let (visibility, name) = match item {
                Item::Const(item) => (&item.vis, &item.ident),
                Item::Enum(item) => (&item.vis, &item.ident),
                Item::Fn(item) => (&item.vis, &item.sig.ident),
                Item::Mod(item) => (&item.vis, &item.ident),
                Item::Static(item) => (&item.vis, &item.ident),
                Item::Struct(item) => (&item.vis, &item.ident),
                Item::Trait(item) => (&item.vis, &item.ident),
                Item::Type(item) => (&item.vis, &item.ident),
                Item::Union(item) => (&item.vis, &item.ident),
                Item::Use(item) if matches!(item.vis, Visibility::Public(_)) => {
                    self.export(&item.tree, module, Vec::new())?;
                    continue;
                }
                Item::Macro(item) => {
                    let exported =
                        |attribute: &syn::Attribute| attribute.path().is_ident("macro_export");
                    ensure!(!item.attrs.iter().any(exported), "a macro at the root");
                    continue;
                }
                _ => continue,
            };
            if !matches!(visibility, Visibility::Public(_)) {
                continue;
            }
            let name = name.to_string();
            let path = join(module, &name);
            self.insert(module, name.clone(), path.clone());
            let Item::Mod(item) = item else { continue };
            if self.opaque.contains(&&*path) {
                continue;
            }
            match &item.content {
                Some((_, items)) => self.scan(items, &path, &directory.join(&name))?,
                None => {
                    let within = directory.join(&name).join("mod.rs");
                    let beside = directory.join(&name).with_extension("rs");
                    let file = if within.exists() { within } else { beside };
                    self.read(&file, &path, false)?;
                }
            }
        }
        Ok(())
    }

    fn export(&mut self, tree: &UseTree, module: &str, path: Vec<String>) -> anyhow::Result<()> {
        let under = |name: &syn::Ident| {
            let mut path = path.clone();
            // The first segment of a path in this crate.
            if !["crate", "self"].iter().any(|own| name == own) {
                path.push(name.to_string());
            }
            path
        };
        match tree {
            UseTree::Path(inner) => self.export(&inner.tree, module, under(&inner.ident))?,
            UseTree::Name(name) => {
                let path = under(&name.ident);
                let name = path.last().context("a name")?.clone();
                self.insert(module, name, path.join("::"));
            }
            UseTree::Rename(rename) => {
                let path = under(&rename.ident);
                self.insert(module, rename.rename.to_string(), path.join("::"));
            }
            UseTree::Group(group) => {
                for tree in &group.items {
                    self.export(tree, module, path.clone())?;
                }
            }
            UseTree::Glob(_) => bail!("{module}: a glob, whose names cannot be counted"),
        }
        Ok(())
    }

    fn insert(&mut self, module: &str, name: String, path: String) {
        let names = self.modules.entry(module.to_owned()).or_default();
        names.insert(name, path);
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
        let modules = self
            .modules
            .iter()
            .filter(|(module, _)| **module != PRELUDE);
        let names: BTreeSet<String> = modules
            .flat_map(|(module, names)| names.keys().map(|name| join(module, name)))
            .filter(|name| !self.modules.contains_key(name))
            .collect();
        let missing = names.difference(&told);
        let missing = missing.map(|name| {
            format!("{IN_PYTHON} lacks {name} (`{name} = franka_async.X` or `{name}: why not`)")
        });
        let gone = told.difference(&names);
        let gone = gone.map(|name| format!("{IN_PYTHON} has {name}, which franka-async lacks"));
        missing.chain(gone).collect()
    }

    /// A line for each broken rule.
    fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        let root = &self.modules[""];
        if root.len() >= ROOT_MAX {
            let names: Vec<&str> = root.keys().map(String::as_str).collect();
            faults.push(format!(
                "got {} names at the root, expected fewer than {ROOT_MAX}: {}",
                root.len(),
                names.join(" ")
            ));
        }
        let outside = self.modules.iter().filter(|(module, _)| *module != PRELUDE);
        let mut items: Vec<(&str, &str, &str)> = Vec::new();
        for (module, names) in outside {
            let names = names
                .iter()
                .map(|(name, path)| (&**module, &**name, &**path));
            items.extend(names);
        }
        for (index, &(module, name, path)) in items.iter().enumerate() {
            for &(other, namesake, elsewhere) in &items[index + 1..] {
                // The names in a submodule begin with the module's name.
                let is_in = |inner: &str, outer: &str| {
                    inner.starts_with(&format!("{outer}::"))
                        && outer.contains("::")
                        && !self.modules.contains_key(outer)
                };
                let is_same = path == elsewhere || is_in(elsewhere, path) || is_in(path, elsewhere);
                if is_same {
                    faults.push(format!(
                        "{path} is in two places: {} and {}",
                        join(module, name),
                        join(other, namesake)
                    ));
                } else if name == namesake && !NAMESAKES.contains(&name) {
                    let places = [join(module, name), join(other, name)];
                    faults.push(format!("one name, two things: {}", places.join(", ")));
                }
            }
        }
        for name in self
            .modules
            .get(PRELUDE)
            .into_iter()
            .flat_map(BTreeMap::keys)
        {
            if !items.iter().any(|(_, other, _)| other == name) {
                faults.push(format!("{PRELUDE}::{name} is in no other place"));
            }
        }
        faults
    }
}

/// The path of a name of a module.
pub(crate) fn join(module: &str, name: &str) -> String {
    match module {
        "" => name.to_owned(),
        module => format!("{module}::{name}"),
    }
}

/// The pages in a directory and its subdirectories, which also contain pictures.
pub(crate) fn pages(directory: &Path) -> anyhow::Result<Vec<std::path::PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(directory)? {
        let path = entry?.path();
        if path.is_dir() {
            found.extend(pages(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// The Rust programs of a page.
fn programs(page: &str) -> String {
    let mut programs = String::new();
    let mut is_program = false;
    for line in page.lines() {
        if line.starts_with("```") {
            is_program = line.starts_with("```rust");
        } else if is_program {
            programs += line;
            programs += "\n";
        }
    }
    programs
}

/// Crates of ours in a text that programs must not need.
fn others(text: &str) -> impl Iterator<Item = &str> {
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '-');
    let is_other = |word: &&str| word.starts_with("franka-") && !FOR_PROGRAMS.contains(word);
    words.filter(is_other).collect::<BTreeSet<_>>().into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faults(source: &str) -> Vec<String> {
        let mut names = Names::default();
        let items = syn::parse_file(source).expect("it is Rust").items;
        names.scan(&items, "", Path::new("")).expect("it is read");
        names.faults()
    }

    #[test]
    fn what_is_public_at_the_root_is_counted() {
        let names: Vec<String> = (0..ROOT_MAX - 2).map(|i| format!("A{i}")).collect();
        let source = format!(
            "pub use a::{{{}}}; pub struct S; struct P; pub(crate) use a::C; mod m {{}}",
            names.join(", ")
        );
        assert_eq!(faults(&source), Vec::<String>::new());
        let found = faults(&(source + "pub fn f() {}"));
        assert!(found[0].starts_with("40 names at the root"), "{found:?}");
    }

    #[test]
    fn a_name_in_two_places_is_found() {
        let found = faults("pub use a::B; pub mod m { pub use crate::a::B as C; }");
        assert_eq!(found, ["a::B is in two places: B and m::C"]);
        let found = faults("pub mod m { pub use x::a::B; } pub mod n { pub use x::a; }");
        assert_eq!(found, ["x::a::B is in two places: m::B and n::a"]);
        let found = faults("pub mod m { pub mod n { pub struct B; } }");
        assert_eq!(found, Vec::<String>::new());
        let found = faults("pub mod m { pub struct B; } pub mod n { pub use x::y::B; }");
        assert_eq!(found, ["one name, two things: m::B, n::B"]);
    }

    #[test]
    fn each_name_has_one_in_python_or_a_reason() {
        let mut names = Names::default();
        let source = "pub use a::B; pub mod m { pub fn f() {} } pub mod prelude {}";
        let items = syn::parse_file(source).expect("it is Rust").items;
        names.scan(&items, "", Path::new("")).expect("it is read");
        let told = "B = franka_async.B\nm::f: a generic function\n";
        assert_eq!(names.untold(told), Vec::<String>::new());
        let found = names.untold("# see: above\nB = franka_async.B\nm::g: gone\n");
        assert!(found[0].contains(" lacks m::f "), "{found:?}");
        assert!(
            found[1].ends_with("has m::g, which franka-async lacks"),
            "{found:?}"
        );
        assert_eq!(found.len(), 2);
    }

    #[test]
    fn the_prelude_repeats_and_adds_nothing() {
        let found = faults("pub use a::B; pub mod prelude { pub use crate::B; }");
        assert_eq!(found, Vec::<String>::new());
        let found = faults("pub use a::B; pub mod prelude { pub use a::C; }");
        assert_eq!(found, ["prelude::C is in no other place"]);
    }

    #[test]
    fn crates_named_by_programs_are_found_and_those_of_prose_are_not() {
        let page = "`franka_otg` is\n```rust,no_run\nuse franka_model::READY;\n```\nfranka_rt";
        let programs = programs(page).replace('_', "-");
        assert_eq!(others(&programs).collect::<Vec<_>>(), ["franka-model"]);
        let manifest = "franka-async.workspace = true\nfranka-rt = { path = \"x\" }\n";
        assert_eq!(others(manifest).collect::<Vec<_>>(), ["franka-rt"]);
    }
}

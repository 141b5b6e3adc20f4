//! The public names of `franka-async`: few at the root, and each with its name in Python or the
//! reason why it has none. Programs of the book and the examples name no other crate of ours.
//!
//! ```text
//! lib.rs ── pub mod x; ──> files ── pub use a::B, pub struct C ──> module, name, path of the item
//! ```

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::mem;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail, ensure};
use syn::visit::{self, Visit};
use syn::{Ident, Item, UseTree, Visibility};

use crate::metadata;
use xtask::workspace::Workspace;

/// Number of public names at the root must be below this.
const ROOT_MAX: usize = 40;

/// The module whose names are also in other modules.
const PRELUDE: &str = "prelude";

/// Python name of each name: `name = franka_async.Name`, or `name: reason for its absence`. The
/// tests of the package look the names up.
const IN_PYTHON: &str = "franka-py/tests/rust_names.txt";

/// Our public names in Rust.
#[derive(Default)]
pub(crate) struct Ours {
    /// Names that each public module of `franka-async` offers, and the paths of the items behind
    /// them. The root is the module "".
    modules: BTreeMap<String, BTreeMap<String, String>>,
    /// Fields and variants of the types of all our crates.
    pub(crate) parts: Parts,
}

/// Names of declarations: members by `struct S`, `enum E`, or `S` for its functions and constants,
/// and free functions and constants by "". Types of the same name in several modules are merged.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    of: BTreeMap<String, BTreeSet<String>>,
    /// The words in macros, which may write functions of any type.
    in_macros: BTreeSet<String>,
    /// The declaration that is read, a key of `of`.
    owner: String,
}

impl Parts {
    /// Reads the files that match these patterns of git.
    pub(crate) fn read(workspace: &Workspace, files: &[impl AsRef<str>]) -> anyhow::Result<Self> {
        let mut parts = Self::default();
        let files: Vec<_> = files.iter().map(AsRef::as_ref).collect();
        for path in workspace.files(&files)? {
            let text = fs::read_to_string(workspace.root().join(&path))?;
            let file = syn::parse_file(&text).with_context(|| path.display().to_string())?;
            parts.visit_file(&file);
        }
        Ok(parts)
    }

    /// The fields of `struct S`, or the variants of `enum E`.
    pub(crate) fn of(&self, of: &str) -> BTreeSet<&str> {
        let parts = self.of.get(of).into_iter().flatten();
        parts.map(String::as_str).collect()
    }

    /// True if a type of this name may have this member, or if it is a type or free itself.
    fn has(&self, name: &str, member: &str) -> bool {
        let keys = |name: &str| {
            [
                name.into(),
                format!("struct {name}"),
                format!("enum {name}"),
            ]
        };
        let mut of = keys(name).into_iter().filter_map(|key| self.of.get(&key));
        let is_free = self.of("").contains(member)
            || keys(member).iter().any(|key| self.of.contains_key(key));
        is_free || of.any(|members| members.contains(member) || self.in_macros.contains(member))
    }

    /// True if any type may have this member.
    fn any_has(&self, member: &str) -> bool {
        self.in_macros.contains(member) || self.of.values().any(|of| of.contains(member))
    }

    fn insert(&mut self, name: &Ident) {
        let of = self.of.entry(self.owner.clone()).or_default();
        of.insert(name.to_string());
    }

    fn within(&mut self, owner: String, visit: impl FnOnce(&mut Self)) {
        self.of.entry(owner.clone()).or_default();
        let outer = mem::replace(&mut self.owner, owner);
        visit(self);
        self.owner = outer;
    }
}

impl<'a> Visit<'a> for Parts {
    fn visit_item_struct(&mut self, item: &'a syn::ItemStruct) {
        self.within(format!("struct {}", item.ident), |it| {
            visit::visit_item_struct(it, item)
        });
    }

    fn visit_item_enum(&mut self, item: &'a syn::ItemEnum) {
        self.within(format!("enum {}", item.ident), |it| {
            item.variants
                .iter()
                .for_each(|variant| it.insert(&variant.ident));
        });
    }

    fn visit_item_trait(&mut self, item: &'a syn::ItemTrait) {
        self.within(item.ident.to_string(), |it| {
            visit::visit_item_trait(it, item)
        });
    }

    fn visit_item_impl(&mut self, item: &'a syn::ItemImpl) {
        if let (syn::Type::Path(path), None) = (&*item.self_ty, &item.trait_)
            && let Some(of) = path.path.segments.last()
        {
            self.within(of.ident.to_string(), |it| visit::visit_item_impl(it, item));
        }
    }

    fn visit_field(&mut self, field: &'a syn::Field) {
        field.ident.iter().for_each(|name| self.insert(name));
    }

    fn visit_signature(&mut self, function: &'a syn::Signature) {
        self.insert(&function.ident);
    }

    fn visit_impl_item_const(&mut self, item: &'a syn::ImplItemConst) {
        self.insert(&item.ident);
    }

    fn visit_trait_item_const(&mut self, item: &'a syn::TraitItemConst) {
        self.insert(&item.ident);
    }

    fn visit_item_const(&mut self, item: &'a syn::ItemConst) {
        self.insert(&item.ident);
    }

    /// Names in the bodies of functions do not count.
    fn visit_block(&mut self, _: &'a syn::Block) {}

    fn visit_macro(&mut self, item: &'a syn::Macro) {
        let text = item.tokens.to_string();
        let words = text.split(|it: char| !it.is_alphanumeric() && it != '_');
        let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
        for pair in words
            .windows(2)
            .filter(|pair| ["struct", "enum"].contains(&pair[0]))
        {
            self.of.entry(pair.join(" ")).or_default();
        }
        self.in_macros.extend(words.into_iter().map(str::to_owned));
    }
}

/// Fails with every name that breaks a rule; returns the names.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<Ours> {
    let ours = Ours::read(workspace)?;
    let at_root = ours.modules[""].len();
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
    /// Reads the sources of our crates.
    fn read(workspace: &Workspace) -> anyhow::Result<Self> {
        let mut ours = Self::default();
        let mut sources = Vec::new();
        for (name, root) in metadata::crates(workspace)? {
            if name == "franka_async" {
                ours.read_module(&root, "", true)?;
            }
            if name.starts_with("franka_") && root.ends_with(Path::new("src/lib.rs")) {
                let directory = root.parent().context("a file is in a directory")?;
                sources.push(format!("{}/*.rs", directory.display()));
            }
        }
        ours.parts = Parts::read(workspace, &sources)?;
        Ok(ours)
    }

    /// The enumerations of errors: `MotionError`, and the enumerations of the module `error`.
    pub(crate) fn errors(&self) -> Vec<String> {
        const ENDINGS: [&str; 5] = ["Error", "Fault", "Lapse", "Reason", "Unready"];
        let names = self.modules.get("error").into_iter().flatten();
        let is_error = |name: &&String| ENDINGS.iter().any(|ending| name.ends_with(ending));
        let names = names.map(|(name, _)| name).filter(is_error).cloned();
        let is_enumeration = |name: &String| !self.parts.of(&format!("enum {name}")).is_empty();
        let motion = ["MotionError".to_owned()];
        names.chain(motion).filter(is_enumeration).collect()
    }

    /// True if a program can write this: `module::Type::method`, `Type`, `module::function(..)`,
    /// `.method(..)` of any type, `franka_sim::Sim::fr3`.
    pub(crate) fn has(&self, span: &str) -> bool {
        let path = span.split(['(', '<', ' ']).next().unwrap_or_default();
        if let Some(member) = path.strip_prefix('.') {
            return self.parts.any_has(member);
        }
        let path = path.strip_prefix("franka_async::").unwrap_or(path);
        let (outer, last) = path.rsplit_once("::").unwrap_or(("", path));
        let item = |module: &str, name: &str| self.modules.get(module)?.get(name);
        if self.modules.contains_key(path) || item(outer, last).is_some() {
            return true;
        }
        let (module, of) = outer.rsplit_once("::").unwrap_or(("", outer));
        let found = item(module, of);
        // A module of another crate may be exported as a whole.
        let first = outer.split("::").next().unwrap_or_default();
        let is_module = first.starts_with(char::is_lowercase) && item("", first).is_some();
        // The item may have another name where it is declared.
        let of = found.map_or(of, |path| path.rsplit("::").next().unwrap_or(of));
        (found.is_some() || is_module || first == "franka_sim") && self.parts.has(of, last)
    }

    fn read_module(&mut self, file: &Path, module: &str, is_root: bool) -> anyhow::Result<()> {
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
            match &item.content {
                Some((_, items)) => self.scan(items, &path, &directory.join(&name))?,
                None => {
                    let within = directory.join(&name).join("mod.rs");
                    let beside = directory.join(&name).with_extension("rs");
                    let file = if within.exists() { within } else { beside };
                    self.read_module(&file, &path, false)?;
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
        let source = "pub use a::{B as C, d::{self}}; pub mod m { pub fn f() {} } pub mod prelude {} \
                      struct P; pub(crate) use a::Q;";
        let items = syn::parse_file(source).expect("it is Rust").items;
        ours.scan(&items, "", Path::new("")).expect("it is read");
        let told = "C = franka_async.C\nd: a module\nm::f: a generic function\n";
        assert_eq!(ours.untold(told), Vec::<String>::new());
        let found = ours.untold("# see: above\nC = franka_async.C\nd: x\nm::g: gone\n");
        assert!(found[0].contains(" lacks m::f "), "{found:?}");
        assert!(
            found[1].ends_with("has m::g, which franka-async lacks"),
            "{found:?}"
        );
        assert_eq!(found.len(), 2);
    }

    #[test]
    fn methods_fields_variants_and_constants_are_members() {
        let mut parts = Parts::default();
        let source = "pub struct S { pub a: u8 } enum E { C } trait T { fn d(); } \
             impl S { pub fn e() {} pub const G: u8 = 0; } mod m { enum E { H } } \
             impl X for S { fn z() {} } macro_rules! m { ($t:ident) => { impl $t { pub fn i(self) {} } struct M; } }";
        parts.visit_file(&syn::parse_file(source).expect("it is Rust"));
        for member in [
            "S a", "E C", "T d", "S e", "S G", "E H", "S i", "Y M", "Y S",
        ] {
            let (name, member) = member.split_once(' ').expect("two words");
            assert!(parts.has(name, member), "{name}::{member}");
        }
        assert!(
            !parts.has("S", "f")
                && !parts.has("S", "z")
                && !parts.has("E", "a")
                && !parts.has("Y", "i")
        );
        assert!(parts.any_has("i") && !parts.any_has("z"));
        assert_eq!(parts.of("enum E"), BTreeSet::from(["C", "H"]));
        assert_eq!(parts.of("struct S"), BTreeSet::from(["a"]));
    }

    #[test]
    fn crates_that_programs_must_not_name_are_found() {
        assert!(names_another_crate("    use franka_model::READY;"));
        assert!(!names_another_crate("use franka_async::Robot;"));
        assert!(!names_another_crate("`franka_rt` runs the loop"));
    }
}

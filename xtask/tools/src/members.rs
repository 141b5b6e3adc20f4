//! Members of the types in Rust sources: methods, fields, variants and constants, by the name of
//! the type.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use anyhow::Context as _;
use proc_macro2::{TokenStream, TokenTree};
use syn::{ImplItem, Item, TraitItem, Type, Visibility};

/// Members by the name of their type. Types of the same name in several modules are merged.
#[derive(Debug, Default)]
pub(crate) struct Members {
    of: BTreeMap<String, BTreeSet<String>>,
    fields: BTreeMap<String, BTreeSet<String>>,
    variants: BTreeMap<String, BTreeSet<String>>,
    /// Functions that a macro writes; their types are unknown.
    in_macros: BTreeSet<String>,
    /// Functions and constants outside types.
    free: BTreeSet<String>,
}

impl Members {
    /// Reads all Rust files below a directory.
    pub(crate) fn read(&mut self, directory: &Path) -> anyhow::Result<()> {
        let entries = fs::read_dir(directory)
            .with_context(|| format!("cannot read {}", directory.display()))?;
        for entry in entries {
            let path = entry?.path();
            if path.is_dir() {
                self.read(&path)?;
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = fs::read_to_string(&path)?;
                let file = syn::parse_file(&text)
                    .with_context(|| format!("cannot parse {}", path.display()))?;
                self.scan(&file.items);
            }
        }
        Ok(())
    }

    /// The members of the type with this name, if any.
    pub(crate) fn of(&self, name: &str) -> Option<&BTreeSet<String>> {
        self.of.get(name)
    }

    /// The public fields of a structure.
    pub(crate) fn fields(&self, name: &str) -> impl Iterator<Item = &str> {
        self.fields
            .get(name)
            .into_iter()
            .flatten()
            .map(String::as_str)
    }

    /// The variants of an enumeration.
    pub(crate) fn variants(&self, name: &str) -> impl Iterator<Item = &str> {
        self.variants
            .get(name)
            .into_iter()
            .flatten()
            .map(String::as_str)
    }

    /// True if a type of this name may have this member.
    pub(crate) fn has(&self, name: &str, member: &str) -> bool {
        self.of
            .get(name)
            .is_some_and(|members| members.contains(member) || self.in_macros.contains(member))
    }

    /// True if a type, a function or a constant has this name.
    pub(crate) fn declares(&self, name: &str) -> bool {
        self.of.contains_key(name) || self.free.contains(name)
    }

    /// True if any type may have this member.
    pub(crate) fn any_has(&self, member: &str) -> bool {
        self.in_macros.contains(member) || self.of.values().any(|of| of.contains(member))
    }

    fn insert(&mut self, name: &syn::Ident, members: impl IntoIterator<Item = String>) {
        self.of.entry(name.to_string()).or_default().extend(members);
    }

    fn scan(&mut self, items: &[Item]) {
        for item in items {
            match item {
                Item::Struct(item) => {
                    let public = item.fields.iter().filter(|field| is_public(&field.vis));
                    let names = public.filter_map(|field| field.ident.as_ref());
                    let names: BTreeSet<String> = names.map(ToString::to_string).collect();
                    self.insert(&item.ident, names.clone());
                    self.fields
                        .entry(item.ident.to_string())
                        .or_default()
                        .extend(names);
                }
                Item::Enum(item) => {
                    let names = item.variants.iter();
                    let names: BTreeSet<String> =
                        names.map(|variant| variant.ident.to_string()).collect();
                    self.insert(&item.ident, names.clone());
                    self.variants
                        .entry(item.ident.to_string())
                        .or_default()
                        .extend(names);
                }
                Item::Trait(item) => {
                    let names = item.items.iter().filter_map(|item| match item {
                        TraitItem::Fn(function) => Some(function.sig.ident.to_string()),
                        TraitItem::Const(constant) => Some(constant.ident.to_string()),
                        _ => None,
                    });
                    self.insert(&item.ident, names);
                }
                Item::Impl(item) => {
                    let Type::Path(path) = &*item.self_ty else {
                        continue;
                    };
                    let Some(last) = path.path.segments.last() else {
                        continue;
                    };
                    if item.trait_.is_some() {
                        continue;
                    }
                    let names = item.items.iter().filter_map(|item| match item {
                        ImplItem::Fn(function) if is_public(&function.vis) => {
                            Some(function.sig.ident.to_string())
                        }
                        ImplItem::Const(constant) if is_public(&constant.vis) => {
                            Some(constant.ident.to_string())
                        }
                        ImplItem::Macro(inner) => {
                            self.in_macros.extend(functions(inner.mac.tokens.clone()));
                            None
                        }
                        _ => None,
                    });
                    let names: Vec<_> = names.collect();
                    self.insert(&last.ident, names);
                }
                Item::Macro(item) => {
                    self.in_macros.extend(functions(item.mac.tokens.clone()));
                    if let Some(name) = declared(item.mac.tokens.clone()) {
                        self.of.entry(name).or_default();
                    }
                }
                Item::Fn(item) if is_public(&item.vis) => {
                    self.free.insert(item.sig.ident.to_string());
                }
                Item::Const(item) if is_public(&item.vis) => {
                    self.free.insert(item.ident.to_string());
                }
                Item::Mod(item) => {
                    if let Some((_, items)) = &item.content {
                        self.scan(items);
                    }
                }
                _ => {}
            }
        }
    }
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// The names after each `fn` in the tokens of a macro.
fn functions(tokens: TokenStream) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut is_function = false;
    for token in tokens {
        match token {
            TokenTree::Group(group) => found.extend(functions(group.stream())),
            TokenTree::Ident(name) => {
                if is_function {
                    found.insert(name.to_string());
                }
                is_function = name == "fn";
                continue;
            }
            _ => {}
        }
        is_function = false;
    }
    found
}

/// The type that a macro declares, if the tokens name one.
fn declared(tokens: TokenStream) -> Option<String> {
    let mut is_type = false;
    for token in tokens {
        match token {
            TokenTree::Group(group) => {
                let inner = declared(group.stream());
                if inner.is_some() {
                    return inner;
                }
            }
            TokenTree::Ident(name) => {
                if is_type {
                    return Some(name.to_string());
                }
                is_type = name == "struct" || name == "enum";
                continue;
            }
            _ => {}
        }
        is_type = false;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn members(source: &str) -> Members {
        let mut members = Members::default();
        members.scan(&syn::parse_file(source).expect("it is Rust").items);
        members
    }

    #[test]
    fn methods_fields_variants_and_constants_are_members() {
        let members = members(
            "pub struct S { pub a: u8, b: u8 } enum E { C } trait T { fn d(); } \
             impl S { pub fn e() {} fn f() {} pub const G: u8 = 0; } mod m { enum E { H } }",
        );
        for (name, member, is_there) in [
            ("S", "a", true),
            ("S", "b", false),
            ("E", "C", true),
            ("T", "d", true),
            ("S", "e", true),
            ("S", "f", false),
            ("S", "G", true),
            ("E", "H", true),
            ("X", "a", false),
        ] {
            assert_eq!(members.has(name, member), is_there, "{name}::{member}");
        }
    }

    #[test]
    fn what_a_macro_writes_may_be_of_any_type() {
        let members = members(
            "macro_rules! m { ($t:ident) => { impl $t { pub fn a(self) {} } } } struct S; \
             macro_rules! n { () => { pub enum E {} } }",
        );
        assert!(members.has("S", "a") && members.any_has("a"));
        assert!(!members.has("S", "b") && !members.has("T", "a"));
        assert!(members.of("E").is_some());
    }
}

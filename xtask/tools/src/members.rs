//! Members of the types in Rust sources: methods, fields, variants and constants, by the name of
//! the type.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use anyhow::Context as _;
use syn::visit::{self, Visit};
use syn::{Ident, ImplItem, TraitItem, Type};

/// Members by the name of their type. Types of the same name in several modules are merged.
#[derive(Debug, Default)]
pub(crate) struct Members {
    of: BTreeMap<String, BTreeSet<String>>,
    /// Fields and variants, by `struct S` and `enum E`.
    parts: BTreeMap<String, BTreeSet<String>>,
    /// The words in macros, which may write functions of any type.
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
                self.visit_file(&file);
            }
        }
        Ok(())
    }

    /// The fields of `struct S`, or the variants of `enum E`.
    pub(crate) fn parts(&self, of: &str) -> BTreeSet<&str> {
        let parts = self.parts.get(of).into_iter().flatten();
        parts.map(String::as_str).collect()
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

    fn insert_parts<'a>(
        &mut self,
        kind: &str,
        name: &Ident,
        parts: impl Iterator<Item = &'a Ident> + Clone,
    ) {
        self.insert(name, parts.clone());
        let all = self.parts.entry(format!("{kind} {name}")).or_default();
        all.extend(parts.map(ToString::to_string));
    }

    fn insert<'a>(&mut self, name: &Ident, members: impl Iterator<Item = &'a Ident>) {
        let members = members.map(ToString::to_string);
        self.of.entry(name.to_string()).or_default().extend(members);
    }
}

impl<'a> Visit<'a> for Members {
    fn visit_item_struct(&mut self, item: &'a syn::ItemStruct) {
        let fields = item.fields.iter().filter_map(|field| field.ident.as_ref());
        self.insert_parts("struct", &item.ident, fields);
    }

    fn visit_item_enum(&mut self, item: &'a syn::ItemEnum) {
        let variants = item.variants.iter().map(|variant| &variant.ident);
        self.insert_parts("enum", &item.ident, variants);
    }

    fn visit_item_trait(&mut self, item: &'a syn::ItemTrait) {
        let members = item.items.iter().filter_map(|item| match item {
            TraitItem::Fn(function) => Some(&function.sig.ident),
            TraitItem::Const(constant) => Some(&constant.ident),
            _ => None,
        });
        self.insert(&item.ident, members);
    }

    fn visit_item_impl(&mut self, item: &'a syn::ItemImpl) {
        if let (Type::Path(path), None) = (&*item.self_ty, &item.trait_)
            && let Some(of) = path.path.segments.last()
        {
            let members = item.items.iter().filter_map(|item| match item {
                ImplItem::Fn(function) => Some(&function.sig.ident),
                ImplItem::Const(constant) => Some(&constant.ident),
                _ => None,
            });
            self.insert(&of.ident, members);
        }
        visit::visit_item_impl(self, item);
    }

    fn visit_item_fn(&mut self, item: &'a syn::ItemFn) {
        self.free.insert(item.sig.ident.to_string());
    }

    fn visit_item_const(&mut self, item: &'a syn::ItemConst) {
        self.free.insert(item.ident.to_string());
    }

    fn visit_macro(&mut self, item: &'a syn::Macro) {
        let text = item.tokens.to_string();
        let words = text.split(|it: char| !it.is_alphanumeric() && it != '_');
        let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
        for pair in words.windows(2) {
            if ["struct", "enum"].contains(&pair[0]) {
                self.of.entry(pair[1].to_owned()).or_default();
            }
        }
        self.in_macros.extend(words.into_iter().map(str::to_owned));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_fields_variants_and_constants_are_members() {
        let mut members = Members::default();
        let source = "pub struct S { pub a: u8 } enum E { C } trait T { fn d(); } \
             impl S { pub fn e() {} pub const G: u8 = 0; } mod m { enum E { H } } \
             macro_rules! m { ($t:ident) => { impl $t { pub fn i(self) {} } struct M; } }";
        members.visit_file(&syn::parse_file(source).expect("it is Rust"));
        for (name, member, is_there) in [
            ("S", "a", true),
            ("E", "C", true),
            ("T", "d", true),
            ("S", "e", true),
            ("S", "f", false),
            ("S", "G", true),
            ("E", "H", true),
            ("S", "i", true),
            ("X", "a", false),
        ] {
            assert_eq!(members.has(name, member), is_there, "{name}::{member}");
        }
        assert!(members.any_has("i") && members.declares("M"));
        assert_eq!(members.parts("enum E"), BTreeSet::from(["C", "H"]));
    }
}

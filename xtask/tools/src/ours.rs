//! Our public names in Rust, as a program writes them.

use std::path::Path;

use anyhow::Context as _;

use crate::members::Members;
use crate::metadata;
use crate::names::Names;
use xtask::workspace::Workspace;

/// Our public names in Rust.
pub(crate) struct Ours {
    face: Names,
    members: Members,
}

impl Ours {
    /// Reads the sources of our crates.
    pub(crate) fn read(workspace: &Workspace) -> anyhow::Result<Self> {
        let mut members = Members::default();
        let mut face = None;
        for (name, root) in metadata::crates(workspace)? {
            if name == "franka_async" {
                face = Some(Names::of(&root)?);
            }
            let directory = root.parent().context("a file is in a directory")?;
            if name.starts_with("franka_") && root.ends_with(Path::new("src/lib.rs")) {
                members.read(directory)?;
            }
        }
        let face = face.context("no face")?;
        Ok(Self { face, members })
    }

    /// The variants of an enumeration.
    pub(crate) fn variants(&self, name: &str) -> Vec<&str> {
        self.members.variants(name).collect()
    }

    /// The enumerations of errors: `MotionError`, and the enumerations of the module `error`.
    pub(crate) fn errors(&self) -> Vec<String> {
        const ENDINGS: [&str; 5] = ["Error", "Fault", "Lapse", "Reason", "Unready"];
        let names = self.face.modules.get("error").into_iter().flatten();
        let is_error = |name: &&String| ENDINGS.iter().any(|ending| name.ends_with(ending));
        let names = names.map(|(name, _)| name).filter(is_error).cloned();
        let is_enumeration = |name: &String| self.members.variants(name).next().is_some();
        let motion = ["MotionError".to_owned()];
        names.chain(motion).filter(is_enumeration).collect()
    }

    /// True if a program can write this: `module::Type::method`, `Type`, `module::function(..)`,
    /// `.method(..)` of any type, `franka_sim::Sim::fr3`.
    pub(crate) fn has(&self, span: &str) -> bool {
        let path = span.split(['(', '<', ' ']).next().unwrap_or_default();
        if let Some(member) = path.strip_prefix('.') {
            return self.members.any_has(member);
        }
        let path = path.strip_prefix("franka_async::").unwrap_or(path);
        let (outer, last) = path.rsplit_once("::").unwrap_or(("", path));
        if let Some(path) = outer.strip_prefix("franka_sim") {
            let of = path.strip_prefix("::").unwrap_or(last);
            return self.members.has(of, last) || self.members.of(of).is_some();
        }
        let is_item = |module: &str, name: &str| {
            let names = self.face.modules.get(module);
            names.is_some_and(|names| names.contains_key(name))
        };
        if self.face.modules.contains_key(path) || is_item(outer, last) {
            return true;
        }
        let (module, of) = outer.rsplit_once("::").unwrap_or(("", outer));
        let names = self.face.modules.get(module);
        if let Some(item) = names.and_then(|names| names.get(of)) {
            // The item may have another name where it is declared.
            let of = item.rsplit("::").next().unwrap_or(of);
            return self.members.has(of, last) || self.members.declares(last);
        }
        // An item in a module of another crate that is exported as a whole.
        let first = outer.split("::").next().unwrap_or_default();
        let is_module = first.starts_with(char::is_lowercase) && is_item("", first);
        is_module && (self.members.has(of, last) || self.members.declares(last))
    }
}

//! Published crates: their manifests, their order, and the content of their packages.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io;
use std::path::PathBuf;

use anyhow::{Context as _, bail};
use flate2::read::GzDecoder;
use serde_json::Value;

use crate::metadata;
use xtask::workspace::Workspace;

/// The largest permitted package, in bytes. A registry accepts 10 MB, but ours are far smaller; a
/// larger one contains files that no user needs.
const SIZE_MAX: u64 = 1_000_000;

/// Files that every package must have.
const FILES: [&str; 4] = ["Cargo.toml", "LICENSE", "NOTICE", "README.md"];

/// Directories that belong to the workspace.
const LEFT_OUT: [&str; 2] = ["tests/", "target/"];

/// Data of a workspace package's manifest.
#[derive(Debug, Default)]
pub(crate) struct Manifest {
    pub(crate) name: String,
    version: String,
    is_published: bool,
    description: String,
    pub(crate) repository: String,
    license: String,
    rust_version: String,
    has_readme: bool,
    keywords: Vec<String>,
    categories: Vec<String>,
    /// Packages of the workspace that are needed, with the versions: `*` without one.
    needs: Vec<(String, String)>,
}

impl Manifest {
    /// Reads the manifests of all packages of the workspace.
    pub(crate) fn all(workspace: &Workspace) -> anyhow::Result<Vec<Self>> {
        let packages = metadata::packages(workspace)?;
        let all: Vec<_> = packages.iter().map(Self::of).collect();
        let names: BTreeSet<String> = all.iter().map(|it: &Self| it.name.clone()).collect();
        let ours = |mut it: Self| {
            it.needs.retain(|(name, _)| names.contains(name));
            it
        };
        Ok(all.into_iter().map(ours).collect())
    }

    /// From Cargo's description of a package.
    fn of(package: &Value) -> Self {
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let list = |name: &str| package[name].as_array().cloned().unwrap_or_default();
        let texts = |name: &str| list(name).iter().map(text).collect();
        let needs = list("dependencies");
        let needs = needs.iter().map(|it| (text(&it["name"]), text(&it["req"])));
        Self {
            name: text(&package["name"]),
            version: text(&package["version"]),
            is_published: package["publish"].is_null(),
            description: text(&package["description"]),
            repository: text(&package["repository"]),
            license: text(&package["license"]),
            rust_version: text(&package["rust_version"]),
            has_readme: package["readme"].is_string(),
            keywords: texts("keywords"),
            categories: texts("categories"),
            needs: needs.collect(),
        }
    }

    /// The directory that is in its package.
    fn root(&self) -> String {
        format!("{}-{}", self.name, self.version)
    }

    /// Path of its package, once it is packed.
    pub(super) fn package(&self, workspace: &Workspace) -> PathBuf {
        let name = format!("{}.crate", self.root());
        workspace.target().join("package").join(name)
    }

    /// Defects that a registry would refuse, or that readers would miss.
    pub(crate) fn faults(&self) -> Vec<String> {
        let mut found = Vec::new();
        let mut expect = |holds: bool, what: String| {
            if !holds {
                found.push(format!("{}: {what}", self.name));
            }
        };
        let (keywords, categories) = (&self.keywords, &self.categories);
        expect(!self.description.is_empty(), "no description".to_owned());
        expect(!self.license.is_empty(), "no license".to_owned());
        expect(!self.rust_version.is_empty(), "no rust-version".to_owned());
        expect(self.has_readme, "no readme".to_owned());
        expect(
            (1..=5).contains(&keywords.len()),
            format!("got {} keywords, expected 1 to 5", keywords.len()),
        );
        expect(
            (1..=5).contains(&categories.len()),
            format!("got {} categories, expected 1 to 5", categories.len()),
        );
        for keyword in keywords {
            let allowed = |it: char| it.is_ascii_alphanumeric() || "_-+".contains(it);
            let begins = keyword.starts_with(|it: char| it.is_ascii_alphanumeric());
            expect(
                begins && keyword.len() <= 20 && keyword.chars().all(allowed),
                format!("the keyword {keyword:?} would be refused"),
            );
        }
        for (name, version) in &self.needs {
            let same = format!("={}", self.version);
            // Without a version, a dependency of tests is left out of the package.
            expect(
                *version == same || version == "*",
                format!("needs {name} {version}, expected {same}"),
            );
        }
        found
    }
}

/// The published crates, each after its dependencies. Fails if they depend on each other.
pub(crate) fn order(manifests: &[Manifest]) -> anyhow::Result<Vec<&Manifest>> {
    let mut waiting: Vec<&Manifest> = manifests.iter().filter(|it| it.is_published).collect();
    let mut ordered: Vec<&Manifest> = Vec::new();
    while !waiting.is_empty() {
        let is_there = |name: &str| ordered.iter().any(|it| it.name == name);
        let versioned = |it: &Manifest| {
            let needs = it.needs.iter().filter(|(_, version)| version != "*");
            needs.map(|(name, _)| name.clone()).collect::<Vec<_>>()
        };
        let ready = |it: &&Manifest| versioned(it).iter().all(|name| is_there(name));
        let (next, later): (Vec<&Manifest>, Vec<&Manifest>) =
            waiting.iter().partition(|it| ready(it));
        if next.is_empty() {
            let names: Vec<_> = later.iter().map(|it| it.name.as_str()).collect();
            bail!(
                "cannot be published in any order, or need unpublished crates: {}",
                names.join(", ")
            );
        }
        ordered.extend(next);
        waiting = later;
    }
    Ok(ordered)
}

/// Packs the crates, with `verify` also builds each from its package, and returns the defects of
/// the packages.
pub(crate) fn pack(
    workspace: &Workspace,
    published: &[&Manifest],
    verify: bool,
) -> anyhow::Result<Vec<String>> {
    let mut pack = workspace.cargo();
    pack.args(["package", "--locked", "--allow-dirty", "--quiet"]);
    if !verify {
        pack.arg("--no-verify");
    }
    for it in published {
        pack.args(["--package", &it.name]);
    }
    workspace.run(&mut pack)?;
    let mut found = Vec::new();
    for it in published {
        let (root, file) = (it.root(), it.package(workspace));
        let size = fs::metadata(&file).with_context(|| file.display().to_string())?;
        let files = list(&file, &root)?;
        println!("{root}: {} files, {} kB", files.len(), size.len() / 1000);
        let mut expect = |holds: bool, what: String| {
            if !holds {
                found.push(format!("the package of {root}: {what}"));
            }
        };
        expect(
            size.len() <= SIZE_MAX,
            format!("got {} bytes, expected at most {SIZE_MAX}", size.len()),
        );
        for name in FILES {
            expect(files.contains(name), format!("{name} is missing"));
        }
        for name in &files {
            let is_left_out = LEFT_OUT.iter().any(|it| name.starts_with(it));
            expect(!is_left_out, format!("{name} should not be in it"));
        }
    }
    Ok(found)
}

/// The files of a package, by their paths in it.
fn list(file: &PathBuf, root: &str) -> anyhow::Result<BTreeSet<String>> {
    let mut archive = tar::Archive::new(GzDecoder::new(File::open(file)?));
    let paths = archive.entries()?.map(|entry| {
        let path = entry?.path()?.into_owned();
        let path = path.strip_prefix(root).unwrap_or(&path);
        io::Result::Ok(path.display().to_string())
    });
    Ok(paths.collect::<io::Result<_>>()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn manifest(name: &str, needs: &[(&str, &str)]) -> Manifest {
        Manifest {
            name: name.to_owned(),
            version: "0.1.0".to_owned(),
            is_published: true,
            description: "A crate".to_owned(),
            license: "Apache-2.0".to_owned(),
            rust_version: "1.89".to_owned(),
            has_readme: true,
            keywords: vec!["robotics".to_owned()],
            categories: vec!["science::robotics".to_owned()],
            needs: needs
                .iter()
                .map(|(name, v)| ((*name).to_owned(), (*v).to_owned()))
                .collect(),
            ..Manifest::default()
        }
    }

    #[test]
    fn each_crate_comes_after_what_it_needs() {
        let all = [
            manifest("face", &[("core", "=0.1.0"), ("sim", "*")]),
            manifest("sim", &[("core", "=0.1.0"), ("face", "*")]),
            manifest("core", &[]),
        ];
        let names: Vec<_> = order(&all)
            .unwrap()
            .iter()
            .map(|it| it.name.clone())
            .collect();
        assert_eq!(names, ["core", "face", "sim"]);
    }

    #[test]
    fn crates_that_need_each_other_have_no_order() {
        let all = [
            manifest("face", &[("sim", "=0.1.0")]),
            manifest("sim", &[("face", "=0.1.0")]),
        ];
        let error = order(&all).unwrap_err().to_string();
        assert!(error.ends_with("face, sim"), "{error}");
        let private = Manifest {
            is_published: false,
            ..manifest("core", &[])
        };
        assert!(order(&[manifest("face", &[("core", "=0.1.0")]), private]).is_err());
    }

    #[test]
    fn a_manifest_says_all_that_a_reader_looks_for() {
        assert_eq!(
            manifest("face", &[("core", "=0.1.0")]).faults(),
            Vec::<String>::new()
        );
        let faults = |change: fn(&mut Manifest)| {
            let mut it = manifest("face", &[]);
            change(&mut it);
            it.faults().len()
        };
        assert_eq!(faults(|it| it.description.clear()), 1);
        assert_eq!(faults(|it| it.has_readme = false), 1);
        assert_eq!(faults(|it| it.keywords = vec!["a".to_owned(); 6]), 1);
        assert_eq!(faults(|it| it.keywords = vec!["two words".to_owned()]), 1);
        assert_eq!(faults(|it| it.categories.clear()), 1);
        assert_eq!(
            faults(|it| it.needs.push(("core".to_owned(), "=0.2.0".to_owned()))),
            1
        );
        assert_eq!(
            faults(|it| it.needs.push(("core".to_owned(), "^0.1.0".to_owned()))),
            1
        );
    }
}

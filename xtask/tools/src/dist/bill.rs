//! The bill of materials of a program: every crate that is part of it, with version, licence and
//! hash, as CycloneDX 1.5. Also the texts of their licences.
//!
//! cargo-cyclonedx 0.5.9 lists what the whole workspace needs, with the features of all members,
//! writes a file beside each manifest, and knows no packages of npm.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, NodeDep};
use serde_json::{Value, json};

use xtask::workspace::Workspace;

/// The package of the program.
const ROOT: &str = "franka-cli";

/// Name and version.
type Id = (String, String);

/// A crate of the program.
#[derive(Debug)]
struct Part {
    license: String,
    sources: PathBuf,
    /// SHA-256 of the package, for packages of a registry.
    hash: Option<String>,
    needs: BTreeSet<Id>,
}

/// All parts of the program for one target.
#[derive(Debug)]
pub(super) struct Bill {
    parts: BTreeMap<Id, Part>,
    /// Packages that the dashboard's page contains.
    page: Vec<Id>,
    version: String,
}

impl Bill {
    /// Queries Cargo for the parts of the program for `target`.
    pub(super) fn of(workspace: &Workspace, target: &str, version: &str) -> anyhow::Result<Self> {
        let mut tree = workspace.cargo();
        tree.args(["tree", "--locked", "--package", ROOT, "--target", target]);
        tree.args(["--edges", "normal", "--prefix", "none", "--format", "{p}"]);
        let parts = parse_tree(&workspace.output(&mut tree)?);
        ensure!(parts.len() > 1, "cargo tree names no dependencies");
        let mut metadata = workspace.cargo();
        metadata.args(["metadata", "--locked", "--format-version=1"]);
        metadata.args(["--filter-platform", target]);
        let metadata = MetadataCommand::parse(workspace.output(&mut metadata)?)?;
        let lock = fs::read_to_string(workspace.root().join("Cargo.lock"))?;
        let page = fs::read_to_string(workspace.root().join("franka-dash/page/package.json"))?;
        Ok(Self {
            parts: details(&parts, &metadata, &hashes(&lock))?,
            page: of_page(&page)?,
            version: version.to_owned(),
        })
    }

    /// As CycloneDX 1.5, without a time and a random number.
    pub(super) fn to_json(&self) -> anyhow::Result<String> {
        let root = (ROOT.to_owned(), self.version.clone());
        let mut components: Vec<Value> = Vec::new();
        let mut dependencies: Vec<Value> = Vec::new();
        for (id, part) in &self.parts {
            let needs: Vec<String> = part.needs.iter().map(|id| purl("cargo", id)).collect();
            dependencies.push(json!({"ref": purl("cargo", id), "dependsOn": needs}));
            if *id != root {
                components.push(part.component(id));
            }
        }
        components.extend(self.page.iter().map(|id| {
            json!({"type": "library", "bom-ref": purl("npm", id), "name": id.0, "version": id.1,
                "purl": purl("npm", id), "licenses": [{"expression": "MIT"}]})
        }));
        let mut root_component = self.parts[&root].component(&root);
        root_component["type"] = json!("application");
        let bill = json!({
            "bomFormat": "CycloneDX",
            "specVersion": "1.5",
            "version": 1,
            "metadata": {"component": root_component},
            "components": components,
            "dependencies": dependencies,
        });
        Ok(serde_json::to_string_pretty(&bill)? + "\n")
    }

    /// The licence texts of external packages, each text once.
    pub(super) fn licences(&self) -> anyhow::Result<String> {
        let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for ((name, version), part) in &self.parts {
            if part.hash.is_none() {
                continue;
            }
            let mut text = licence_files(&part.sources)?;
            if text.is_empty() {
                text = format!(
                    "Licensed under {}; the package has no text.\n",
                    part.license
                );
            }
            let title = format!("{name} {version} ({})", part.license);
            texts.entry(text).or_default().push(title);
        }
        let mut by_title: Vec<(Vec<String>, String)> = texts
            .into_iter()
            .map(|(text, titles)| (titles, text))
            .collect();
        by_title.sort();
        let rule = "-".repeat(79);
        let sections = by_title.into_iter().map(|(titles, text)| {
            format!("{rule}\n{}\n\n{}\n", titles.join("\n"), text.trim_end())
        });
        let of_others = self.parts.values().filter(|part| part.hash.is_some());
        let count = of_others.count();
        Ok(format!(
            "{count} libraries of others are part of this program, with these licences.\n\n{}",
            sections.collect::<String>()
        ))
    }

    /// Number of crates.
    pub(super) fn count(&self) -> usize {
        self.parts.len()
    }
}

impl Part {
    fn component(&self, id: &Id) -> Value {
        let mut component = json!({"type": "library", "bom-ref": purl("cargo", id), "name": id.0,
            "version": id.1, "purl": purl("cargo", id)});
        if !self.license.is_empty() {
            // An old form of OR.
            let expression = self.license.replace('/', " OR ");
            component["licenses"] = json!([{"expression": expression}]);
        }
        if let Some(hash) = &self.hash {
            component["hashes"] = json!([{"alg": "SHA-256", "content": hash}]);
        }
        component
    }
}

/// The address of a package, as bills write it.
fn purl(kind: &str, (name, version): &Id) -> String {
    format!("pkg:{kind}/{name}@{version}")
}

/// Name and version of each line of `cargo tree`.
fn parse_tree(text: &str) -> BTreeSet<Id> {
    let id = |line: &str| {
        let (name, rest) = line.split_once(" v")?;
        let version = rest.split_whitespace().next()?;
        Some((name.to_owned(), version.to_owned()))
    };
    text.lines().filter_map(id).collect()
}

/// The hash of each package of a registry, from the lock file.
fn hashes(lock: &str) -> BTreeMap<Id, String> {
    let hash = |package: &str| {
        let text = |name: &str| {
            let (_, rest) = package.split_once(&format!("\n{name} = \""))?;
            Some(rest.split('"').next()?.to_owned())
        };
        Some(((text("name")?, text("version")?), text("checksum")?))
    };
    lock.split("[[package]]").filter_map(hash).collect()
}

/// Details of the chosen crates from Cargo's description.
fn details(
    chosen: &BTreeSet<Id>,
    metadata: &Metadata,
    hashes: &BTreeMap<Id, String>,
) -> anyhow::Result<BTreeMap<Id, Part>> {
    let id = |of| {
        (
            metadata[of].name.to_string(),
            metadata[of].version.to_string(),
        )
    };
    let mut parts = BTreeMap::new();
    for node in &metadata.resolve.as_ref().context("no dependencies")?.nodes {
        let is_normal = |need: &&NodeDep| {
            need.dep_kinds
                .iter()
                .any(|it| it.kind == DependencyKind::Normal)
        };
        let needs = node.deps.iter().filter(is_normal).map(|need| id(&need.pkg));
        let package = &metadata[&node.id];
        let sources = package
            .manifest_path
            .parent()
            .context("a manifest is in a directory")?;
        let part = Part {
            license: package.license.clone().unwrap_or_default(),
            sources: sources.into(),
            hash: hashes.get(&id(&node.id)).cloned(),
            needs: needs.filter(|id| chosen.contains(id)).collect(),
        };
        parts.insert(id(&node.id), part);
    }
    parts.retain(|id, _| chosen.contains(id));
    ensure!(
        parts.len() == chosen.len(),
        "cargo metadata knows fewer crates than cargo tree"
    );
    Ok(parts)
}

/// Packages of the page: the dependencies of its manifest, whose versions are exact.
fn of_page(manifest: &str) -> anyhow::Result<Vec<Id>> {
    let manifest: Value = serde_json::from_str(manifest)?;
    let packages = manifest["dependencies"]
        .as_object()
        .context("the page has packages")?;
    let ids = packages.iter().map(|(name, version)| {
        let version = version.as_str().context("a version is a text")?;
        Ok((name.clone(), version.to_owned()))
    });
    ids.collect()
}

/// The texts of the licence files of a package, in the order of their names.
fn licence_files(sources: &Path) -> anyhow::Result<String> {
    let entries = fs::read_dir(sources).with_context(|| sources.display().to_string())?;
    let is_licence = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default();
        let name = name.to_string_lossy().to_uppercase();
        let names = ["LICENSE", "LICENCE", "COPYING", "NOTICE", "COPYRIGHT"];
        path.is_file() && names.iter().any(|it| name.starts_with(it))
    };
    let paths = entries.flatten().map(|entry| entry.path());
    let mut names: Vec<PathBuf> = paths.filter(is_licence).collect();
    names.sort();
    let mut text = String::new();
    for name in names {
        text += String::from_utf8_lossy(&fs::read(name)?).trim_end();
        text += "\n\n";
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bill_names_the_driver_and_its_dependencies() {
        let workspace = Workspace::find().unwrap();
        let version = crate::release::version(&crate::metadata::of(&workspace).unwrap());
        let bill = Bill::of(&workspace, "x86_64-unknown-linux-gnu", &version).unwrap();
        let json: Value = serde_json::from_str(&bill.to_json().unwrap()).unwrap();
        let components = json["components"].as_array().unwrap();
        let find = |name: &str| components.iter().find(|it| it["name"] == name);
        assert_eq!(find("franka-async").unwrap()["version"], version.as_str());
        let tokio = find("tokio").expect("a dependency of dependencies");
        assert_eq!(tokio["hashes"][0]["content"].as_str().unwrap().len(), 64);
        assert!(find("three").is_some(), "a part of the page");
        assert!(find("proptest").is_none(), "a dependency of tests only");
        let licences = bill.licences().unwrap();
        assert!(licences.contains("\ntokio ") && !licences.contains("\nfranka-async "));
    }
}

//! Files delivered with the program: licences, man pages, completions, examples.

use std::fs;
use std::path::Path;
use std::process::Stdio;

use anyhow::{Context as _, ensure};

use super::archive::Entry;
use super::program::Program;
use xtask::workspace::Workspace;

/// A program and its files.
#[derive(Debug)]
pub(super) struct Content {
    pub(super) program: Vec<u8>,
    /// Files by their names.
    pub(super) man_pages: Vec<(String, Vec<u8>)>,
    /// Scripts by the shell: bash, fish, zsh.
    pub(super) completions: Vec<(&'static str, Vec<u8>)>,
    pub(super) examples: Vec<(String, Vec<u8>)>,
    /// `LICENSE`, `NOTICE` and so on, by their names.
    pub(super) papers: Vec<(String, Vec<u8>)>,
    /// The change log of the workspace.
    pub(super) changes: Vec<u8>,
}

impl Content {
    /// Reads the files of the workspace, and makes the program write the others; `work` is a
    /// directory that does not exist yet.
    pub(super) fn collect(
        workspace: &Workspace,
        program: &Program,
        work: &Path,
        third_parties: String,
    ) -> anyhow::Result<Self> {
        let read = |name: &str| {
            let path = workspace.root().join(name);
            fs::read(&path).with_context(|| path.display().to_string())
        };
        let mut man = program.command();
        let status = man.arg("man").arg(work).stdout(Stdio::null());
        ensure!(status.status()?.success(), "no man pages were written");
        let mut completions = Vec::new();
        for shell in ["bash", "fish", "zsh"] {
            let output = program.command().args(["completions", shell]).output()?;
            ensure!(output.status.success(), "no completions for {shell}");
            completions.push((shell, output.stdout));
        }
        let mut papers = vec![("THIRD-PARTY".to_owned(), third_parties.into_bytes())];
        for name in ["LICENSE", "NOTICE"] {
            papers.push((name.to_owned(), read(name)?));
        }
        papers.push(("README.md".to_owned(), read("franka-cli/README.md")?));
        Ok(Self {
            program: fs::read(&program.path)?,
            man_pages: files(work)?,
            completions,
            examples: files(&workspace.root().join("franka-cli/dist/examples"))?,
            papers,
            changes: read("CHANGELOG.md")?,
        })
    }

    /// The entries of a portable archive, below one directory.
    pub(super) fn portable(&self, directory: &str) -> Vec<Entry> {
        let at = |path: &str| format!("{directory}/{path}");
        let mut entries = vec![
            Entry::program(at("franka"), self.program.clone()),
            Entry::text(at("CHANGELOG.md"), self.changes.clone()),
        ];
        let named = |folder: &str, files: &[(String, Vec<u8>)]| {
            let entry = |(name, content): &(String, Vec<u8>)| {
                Entry::text(at(&format!("{folder}{name}")), content.clone())
            };
            files.iter().map(entry).collect::<Vec<_>>()
        };
        entries.extend(named("", &self.papers));
        entries.extend(named("man/", &self.man_pages));
        entries.extend(named("examples/", &self.examples));
        entries.extend(self.completions.iter().map(|(shell, script)| {
            Entry::text(at(&format!("completions/franka.{shell}")), script.clone())
        }));
        entries
    }
}

/// The files of a directory, by name.
fn files(directory: &Path) -> anyhow::Result<Vec<(String, Vec<u8>)>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(directory).with_context(|| directory.display().to_string())? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        files.push((name, fs::read(entry.path())?));
    }
    ensure!(!files.is_empty(), "{} is empty", directory.display());
    files.sort();
    Ok(files)
}

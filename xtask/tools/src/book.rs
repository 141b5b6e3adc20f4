//! The book: built with checks of its programs and links, and served together with the references
//! of Rust and Python.
//!
//! ```text
//! docs/src ── mdBook ──> target/book ── lychee: links
//! cargo doc ──> target/book/rust      pdoc ──> target/book/python      playground
//! ```

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};

use crate::metadata::copy_directory;
use crate::names;
use crate::package;
use crate::page::Page;
use crate::playground;
use xtask::python;
use xtask::step::{Outcome, or_missing};
use xtask::workspace::Workspace;

/// The book's step: every page is in the summary, every Rust program is compiled by a test, and no
/// link is broken.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let pages = names::pages(workspace)?;
    let mut found = unlisted(workspace, &pages)?;
    found.extend(untested(workspace, &pages)?);
    ensure!(found.is_empty(), "the book:\n{}", found.join("\n"));
    let tools = Tools::find(workspace)?;
    let book = build(workspace, &tools)?;
    println!("{} pages", pages.len());
    playground::leave_out(&book, "only the links were checked")?;
    links(workspace, &tools, &book, &REFERENCES)
}

/// Builds the book with its references. Serves it on this computer until Ctrl-C, unless only a
/// build is requested.
pub(crate) fn serve(workspace: &Workspace, port: Option<u16>) -> anyhow::Result<()> {
    let tools = Tools::find(workspace)?;
    let book = build(workspace, &tools)?;
    playground::add(workspace, &book)?;
    // Cargo keeps pages of names that no longer exist.
    remove(&workspace.target().join("doc"))?;
    let mut rust = workspace.cargo();
    rust.args(["doc", "--no-deps", "--features", FEATURES]);
    rust.args(["--package=franka-async", "--package=franka-sim"]);
    workspace.run(&mut rust)?;
    copy_directory(&workspace.target().join("doc"), &book.join("rust"))?;
    let missing: &[&str] = match or_missing(package::prepare(workspace))? {
        Ok(interpreter) => {
            let mut python = package::module(workspace, &interpreter, "pdoc");
            python.args(["--docformat", "google", "--output-directory"]);
            python.arg(book.join("python")).arg("franka_async");
            workspace.run(&mut python)?;
            &[]
        }
        Err(why) => {
            println!("without the reference of Python: {why}");
            &REFERENCES[1..]
        }
    };
    if let Outcome::Partly(what) = links(workspace, &tools, &book, missing)? {
        println!("NOT CHECKED: {what}");
    }
    println!("{}", book.join("index.html").display());
    let Some(port) = port else {
        return Ok(());
    };
    println!("http://127.0.0.1:{port}/ until Ctrl-C");
    let mut server = workspace.program(&tools.interpreter);
    server.args(["-m", "http.server", "--bind", "127.0.0.1"]);
    server.arg("--directory").arg(&book).arg(port.to_string());
    workspace.run(&mut server)
}

/// mdBook and lychee, pinned by hash, in a virtual environment.
struct Tools {
    interpreter: PathBuf,
}

impl Tools {
    /// Installs the tools.
    fn find(workspace: &Workspace) -> anyhow::Result<Self> {
        let interpreter = python::environment(workspace, "python-book", "docs/requirements.txt")?;
        Ok(Self { interpreter })
    }

    /// A program of the environment.
    fn program(&self, name: &str) -> PathBuf {
        self.interpreter.with_file_name(name)
    }
}

/// Builds the pages, in place of an earlier build, and returns their directory.
fn build(workspace: &Workspace, tools: &Tools) -> anyhow::Result<PathBuf> {
    let book = workspace.target().join("book");
    remove(&book)?;
    let mut mdbook = workspace.program(tools.program("mdbook"));
    mdbook.args(["build", "docs", "--dest-dir"]).arg(&book);
    workspace.run(&mut mdbook)?;
    Ok(book)
}

/// Checks the links of the built pages, and of the repository's pages, to files and to anchors in
/// them, except links to references that are `missing`.
fn links(
    workspace: &Workspace,
    tools: &Tools,
    book: &Path,
    missing: &[&str],
) -> anyhow::Result<Outcome> {
    let lychee = tools.program("lychee");
    if !lychee.exists() {
        return Ok(Outcome::Partly(
            "links: there is no lychee for this machine".to_owned(),
        ));
    }
    let mut check = workspace.program(&lychee);
    check.args(["--offline", "--no-progress", "--include-fragments"]);
    for reference in missing {
        check.args(["--exclude", reference]);
    }
    for page in REFERENCES.iter().chain(&["print.html", "404.html"]) {
        check.args(["--exclude-path", page]);
    }
    check.arg(book);
    check.args(REPOSITORY_PAGES);
    workspace.run(&mut check)?;
    Ok(Outcome::Passed)
}

/// Pages that are in no chapter of the summary.
fn unlisted(workspace: &Workspace, pages: &[PathBuf]) -> anyhow::Result<Vec<String>> {
    let sources = Path::new("docs/src");
    let summary = fs::read_to_string(workspace.root().join(sources).join("SUMMARY.md"))?;
    let names = pages.iter().map(|page| page.strip_prefix(sources));
    let names = names.collect::<Result<Vec<_>, _>>()?.into_iter();
    let names = names.map(|name| name.display().to_string());
    let is_missing =
        |name: &String| name != "SUMMARY.md" && !summary.contains(&format!("({name})"));
    let missing = names.filter(is_missing);
    Ok(missing
        .map(|name| format!("{name} is not in SUMMARY.md"))
        .collect())
}

/// Pages with Rust programs that no test compiles.
fn untested(workspace: &Workspace, pages: &[PathBuf]) -> anyhow::Result<Vec<String>> {
    let tests = fs::read_to_string(workspace.root().join(DOCTESTS)).context(DOCTESTS)?;
    let mut found = Vec::new();
    for page in pages {
        let has_program = programs(&fs::read_to_string(workspace.root().join(page))?);
        let name = page.display();
        if has_program && !tests.contains(&format!("../{name}\"")) {
            found.push(format!("{name} has Rust programs and is not in {DOCTESTS}"));
        }
    }
    Ok(found)
}

/// True if a page contains a Rust program that must not be ignored. An included program is a file
/// that builds.
fn programs(page: &str) -> bool {
    let mut blocks = Page::parse(page).blocks.into_iter();
    blocks.any(|(kind, code)| {
        kind.starts_with("rust") && !kind.contains("ignore") && !code.starts_with("{{#")
    })
}

/// Removes a directory if it exists.
fn remove(directory: &Path) -> anyhow::Result<()> {
    match fs::remove_dir_all(directory) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(error).with_context(|| directory.display().to_string())
        }
        _ => Ok(()),
    }
}

/// Features of the reference of Rust.
const FEATURES: &str = "franka-async/admission,franka-async/blocking,franka-async/doctor,\
    franka-async/export,franka-async/metrics,franka-async/pcap";

/// Directories of the references, which only `cargo xtask book` builds.
const REFERENCES: [&str; 2] = ["book/rust/", "book/python/"];

/// File that compiles the programs of the pages.
const DOCTESTS: &str = "tests/src/lib.rs";

/// Pages outside the book that users read first.
pub(crate) const REPOSITORY_PAGES: [&str; 3] =
    ["README.md", "examples/README.md", "franka-py/README.md"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_told_from_what_is_included_or_ignored() {
        assert!(programs("text\n```rust,no_run\nfn main() {}\n```\n"));
        assert!(!programs("```rust\n{{#include a.rs}}\n```\n"));
        assert!(!programs("```rust,ignore\nx\n```\n```python\nx\n```\n"));
    }
}

//! The playground of the book: driver and simulator as WebAssembly, and the page around them.
//!
//! ```text
//! playground/src  ── cargo ────> franka_playground.wasm ┐
//! playground/page ── esbuild ──> playground.js, .css    ├─> target/book/playground
//! franka-dash/page/meshes ──────────────────────────────┘
//! ```

use std::fs;
use std::path::Path;

use anyhow::bail;

use crate::cross;
use crate::dashboard;
use crate::metadata::copy_directory;
use xtask::step::{Missing, Outcome, or_missing};
use xtask::workspace::Workspace;

/// Adds the playground to a built book, or in its place a page with the requirements.
pub(crate) fn add(workspace: &Workspace, book: &Path) -> anyhow::Result<()> {
    match or_missing(build(workspace, &book.join("playground")))? {
        Ok(()) => Ok(()),
        Err(why) => {
            println!("without the playground: {why}");
            leave_out(book, &why)
        }
    }
}

/// Writes the reason for the missing playground into the built book.
pub(crate) fn leave_out(book: &Path, why: &str) -> anyhow::Result<()> {
    let folder = book.join("playground");
    fs::create_dir_all(&folder)?;
    Ok(fs::write(
        folder.join("index.html"),
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
             <title>Playground</title>\n<style>:root {{ color-scheme: light dark; }} \
             body {{ font: 14px system-ui, sans-serif; }}</style>\n\
             <p>This copy of the book was built without the playground: {why}.</p>\n"
        ),
    )?)
}

/// The step `playground`: builds it, and uses it in a real browser.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let folder = workspace.target().join("playground");
    if let Err(why) = or_missing(build(workspace, &folder))? {
        return Ok(Outcome::Skipped(why));
    }
    dashboard::browse(
        workspace,
        &["the_playground"],
        &[("FRANKA_PLAYGROUND", &folder)],
    )
}

fn build(workspace: &Workspace, folder: &Path) -> anyhow::Result<()> {
    dashboard::need_npm()?;
    if let Some(why) = cross::lacks(TARGET, cross::STD) {
        bail!(Missing(format!("of the target {TARGET}, {why}")));
    }
    let mut cargo = workspace.cargo();
    cargo.args(["build", "--profile=dist", "--package=franka-playground"]);
    workspace.run(cargo.args(["--target", TARGET]))?;
    let sources = workspace.root().join("playground").join("page");
    let dashboard = dashboard::page(workspace);
    fs::create_dir_all(folder)?;
    let entry = sources.join("playground.js");
    // Not a module: modules cannot be loaded from a file, and the page could not report that.
    dashboard::bundle(workspace, &entry, &folder.join("playground.js"), "iife")?;
    let meshes = folder.join("meshes");
    copy_directory(&dashboard.join("meshes"), &meshes)?;
    // No server informs the browser of the compression.
    let mut expand = workspace.program("gzip");
    workspace.run(
        expand
            .args(["--decompress", "--force", "--recursive"])
            .arg(&meshes),
    )?;
    let wasm = workspace.target().join(TARGET).join("dist");
    for (from, name) in [
        (&wasm, "franka_playground.wasm"),
        (&sources, "index.html"),
        (&dashboard, "icon.svg"),
    ] {
        fs::copy(from.join(name), folder.join(name))?;
    }
    let licences = dashboard::licences(workspace)?;
    Ok(fs::write(folder.join("licenses.txt"), licences)?)
}

const TARGET: &str = "wasm32-unknown-unknown";

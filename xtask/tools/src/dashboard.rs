//! The dashboard's page: its files made from pinned packages, and its tests in a real browser.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail, ensure};

use crate::others;
use xtask::realtime::succeeds;
use xtask::step::{Missing, Outcome};
use xtask::workspace::{Workspace, is_ci};

/// Rebuilds the files in `franka-dash/page/dist`.
pub(crate) fn assets(workspace: &Workspace) -> anyhow::Result<()> {
    make(workspace, &page(workspace).join("dist"))
}

/// Runs the tests of the page's modules in Node, and fails if the files in `franka-dash/page/dist`
/// differ from those that [`assets`] makes.
pub(crate) fn check_assets(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let page = page(workspace);
    need_npm()?;
    let mut node = workspace.program("node");
    let tests = fs::read_dir(page.join("test"))?.map(|entry| entry.map(|entry| entry.path()));
    let tests: Vec<_> = tests.collect::<Result<_, _>>()?;
    let is_test = |path: &&PathBuf| path.to_string_lossy().ends_with(".test.js");
    node.arg("--test").args(tests.iter().filter(is_test));
    workspace.run(&mut node)?;
    let made = work(workspace).join("dist");
    make(workspace, &made)?;
    for name in MADE {
        let read = |directory: &Path| {
            let mut expand = workspace.program("gzip");
            expand.args(["--decompress", "--force", "--stdout"]);
            workspace.output(expand.arg(directory.join(name)))
        };
        ensure!(
            read(&made)? == read(&page.join("dist"))?,
            "franka-dash/page/dist/{name} does not match the page's sources: run cargo xtask assets"
        );
    }
    Ok(Outcome::Passed)
}

/// Fails without npm, which installs what [`bundle`] and other tasks need.
pub(crate) fn need_npm() -> anyhow::Result<()> {
    ensure!(find(&["npm"]).is_some(), Missing("no npm".to_owned()));
    Ok(())
}

pub(crate) fn page(workspace: &Workspace) -> PathBuf {
    workspace.root().join("franka-dash").join("page")
}

/// Generated files.
const MADE: [&str; 3] = ["dash.js.gz", "dash.css", "licenses.txt"];

/// Makes the files of the page in `dist`.
fn make(workspace: &Workspace, dist: &Path) -> anyhow::Result<()> {
    let entry = page(workspace).join("src").join("main.js");
    let script = dist.join("dash.js");
    bundle(workspace, &entry, &script, "esm")?;
    let mut compress = workspace.program("gzip");
    workspace.run(compress.args(["-9", "--no-name", "--force"]).arg(script))?;
    Ok(fs::write(dist.join("licenses.txt"), licences(workspace)?)?)
}

/// Bundles a module with all its imports in one file, and their styles in another. It needs npm,
/// which checks the packages against the hashes of the lock file; none of their scripts runs.
pub(crate) fn bundle(
    workspace: &Workspace,
    entry: &Path,
    output: &Path,
    format: &str,
) -> anyhow::Result<()> {
    let work = work(workspace);
    install_packages(workspace, &page(workspace), &work)?;
    let packages = work.join("node_modules");
    let mut esbuild = workspace.program(packages.join(".bin/esbuild"));
    esbuild.arg(entry).args(["--bundle", "--minify"]);
    esbuild.args(["--legal-comments=eof", "--log-level=warning"]);
    esbuild.arg(format!("--format={format}"));
    esbuild.arg(format!("--outfile={}", output.display()));
    workspace.run(esbuild.env("NODE_PATH", packages))
}

/// Installs the packages of the lock file in `from` in `work`, unless they are already installed.
pub(crate) fn install_packages(
    workspace: &Workspace,
    from: &Path,
    work: &Path,
) -> anyhow::Result<()> {
    let (lock, installed) = (from.join("package-lock.json"), work.join("installed.json"));
    if fs::read(&installed).is_ok_and(|content| fs::read(&lock).is_ok_and(|it| it == content)) {
        return Ok(());
    }
    fs::create_dir_all(work)?;
    for name in ["package.json", "package-lock.json"] {
        fs::copy(from.join(name), work.join(name)).with_context(|| name.to_owned())?;
    }
    let mut npm = workspace.program("npm");
    npm.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"]);
    npm.arg("--prefer-offline");
    workspace.run(npm.current_dir(work))?;
    // Written last, so that an interrupted installation is repeated.
    fs::copy(&lock, &installed)?;
    Ok(())
}

/// The licences of the packages that [`bundle`] adds, and of the meshes.
pub(crate) fn licences(workspace: &Workspace) -> anyhow::Result<String> {
    let packages = work(workspace).join("node_modules");
    let meshes = page(workspace).join("meshes");
    let mut licences = String::new();
    for package in ["three", "uplot"] {
        let text = fs::read_to_string(packages.join(package).join("LICENSE"))?;
        licences += &format!("{package}\n\n{text}\n");
    }
    for name in ["NOTICE", "LICENSE-franka_description", "LICENSE"] {
        let text = fs::read_to_string(meshes.join(name))?;
        licences += &format!("meshes of the links: {name}\n\n{text}\n");
    }
    Ok(licences)
}

/// Directory of the installed packages.
fn work(workspace: &Workspace) -> PathBuf {
    workspace.target().join("dashboard-page")
}

/// Runs the tests of the page in a browser; with `FRANKA_THOROUGH=1` it also records its film.
pub(crate) fn run(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let film = workspace.target().join("dashboard").join("film.png");
    let all = ["the_page", "the_film"];
    let is_thorough = env::var_os("FRANKA_THOROUGH").is_some();
    let which = if is_thorough { &all[..] } else { &all[..1] };
    browse(workspace, which, &[("FRANKA_FILM", &film)])
}

/// Records the page's film, which the README shows.
pub(crate) fn film(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let file = workspace.root().join("docs/src/dashboard.png");
    browse(workspace, &["the_film"], &[("FRANKA_FILM", &file)])
}

/// Runs the browser tests whose names contain one of `which`, with variables for them.
pub(crate) fn browse(
    workspace: &Workspace,
    which: &[&str],
    variables: &[(&str, &Path)],
) -> anyhow::Result<Outcome> {
    let browsers = ["chromium", "chromium-browser", "google-chrome"];
    let find_both = || find(&["chromedriver"]).zip(find(&browsers));
    let found = find_both().or_else(|| {
        install();
        find_both()
    });
    let Some((driver, browser)) = found else {
        let why = "no Chromium with chromedriver (Debian: chromium, chromium-driver)";
        bail!(Missing(why.to_owned()));
    };
    let mut test = others::other_test(workspace, "browser");
    test.args(which).args(["--ignored", "--nocapture"]);
    test.env("FRANKA_WEBDRIVER", driver);
    test.env("FRANKA_BROWSER", browser);
    test.env("FRANKA_PICTURES", workspace.target().join("dashboard"));
    test.envs(variables.iter().copied());
    workspace.run(&mut test)?;
    Ok(Outcome::Passed)
}

/// With `CI=true`, tries to install the browser from Debian's packages, which requires root. The
/// caller must check if it exists afterwards.
fn install() {
    if is_ci() {
        println!("found no browser; installing Debian's chromium and chromium-driver");
        let install = ["install", "--yes", "--quiet", "--no-install-recommends"];
        let packages = ["chromium", "chromium-driver"];
        if succeeds(&["apt-get", "update", "--quiet"]) {
            succeeds(&[&["apt-get"][..], &install, &packages].concat());
        }
    }
}

/// The first of these programs that exists.
fn find(names: &[&str]) -> Option<PathBuf> {
    let path = env::var_os("PATH")?;
    let places: Vec<_> = env::split_paths(&path).collect();
    let mut programs = names
        .iter()
        .flat_map(|name| places.iter().map(move |place| place.join(name)));
    programs.find(|program| program.is_file())
}

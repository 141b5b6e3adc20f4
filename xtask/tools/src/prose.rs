//! Plain English: the step `prose`, by textlint with the rules in `xtask/tools/prose`.
//!
//! `baseline.txt` there has the number of hits by top-level folder and rule, which may only fall.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use anyhow::{Context as _, bail, ensure};

use crate::dashboard;
use xtask::step::{Missing, Outcome};
use xtask::workspace::Workspace;

/// Fails if a folder has more hits of a rule than before.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let hits = lint(workspace, &[])?;
    let baseline = read(workspace)?;
    let risen = risen(&baseline, &hits, &changed_files(workspace)?);
    ensure!(risen.is_empty(), "prose to mend:\n{risen}");
    let most: usize = baseline.values().sum();
    if hits.len() < most {
        println!("{most} hits are allowed: cargo xtask prose --lower lowers that");
    }
    println!("{} hits", hits.len());
    Ok(Outcome::Passed)
}

/// Prints the hits in `paths`, or everywhere. With `is_lowering`, writes the counts that fell to
/// the baseline instead, or all counts if there is no baseline.
pub(crate) fn run(
    workspace: &Workspace,
    paths: &[PathBuf],
    is_lowering: bool,
) -> anyhow::Result<()> {
    let hits = lint(workspace, paths)?;
    if !is_lowering {
        for hit in &hits {
            println!("{}", hit.line);
        }
        println!("{} hits", hits.len());
        return Ok(());
    }
    let exists = baseline(workspace).exists();
    let before = exists.then(|| read(workspace)).transpose()?;
    let mut text = String::from(HEADER);
    for (key, count) in count(&hits) {
        let allowed = |before: &Counts| before.get(&key).copied().unwrap_or_default();
        let most = before.as_ref().map_or(count, allowed).min(count);
        if most > 0 {
            writeln!(text, "{} {} {most}", key.0, key.1)?;
        }
    }
    Ok(fs::write(baseline(workspace), text)?)
}

const HEADER: &str = "# Hits of the step `prose` by folder and rule, at most. \
                      `cargo xtask prose --lower` writes them.\n";

/// A text that breaks a rule.
#[derive(Clone, Debug)]
struct Hit {
    file: String,
    rule: String,
    /// The whole report.
    line: String,
}

impl Hit {
    /// Reads a line of `lint.cjs`.
    fn parse(line: &str) -> Option<Self> {
        let mut fields = line.split('\t');
        let mut field = || fields.next();
        let (place, rule, text, instead) = (field()?, field()?, field()?, field()?);
        Some(Self {
            file: place.rsplit_once(':')?.0.to_owned(),
            rule: rule.to_owned(),
            line: format!("{place}: {rule}: \"{text}\"; instead: {instead}"),
        })
    }

    /// The top-level folder and the rule.
    fn key(&self) -> (String, String) {
        let folder = self.file.split_once('/').map_or(".", |(folder, _)| folder);
        (folder.to_owned(), self.rule.clone())
    }
}

/// The hits in `paths`, or everywhere.
fn lint(workspace: &Workspace, paths: &[PathBuf]) -> anyhow::Result<Vec<Hit>> {
    dashboard::need_npm()?;
    let packages = workspace.target().join("prose");
    if let Err(error) = dashboard::install_packages(workspace, &folder(workspace), &packages) {
        bail!(Missing(format!("textlint cannot be installed: {error:#}")));
    }
    let paths: Vec<_> = paths.iter().filter_map(|path| path.to_str()).collect();
    let is_prose = |file: &&str| {
        KINDS.iter().any(|kind| file.ends_with(kind)) && !file.contains("/generated/")
    };
    let files = workspace.files(&paths)?;
    let files: Vec<_> = files.iter().filter_map(|file| file.to_str()).collect();
    let files: Vec<_> = files.into_iter().filter(is_prose).collect();
    let mut node = workspace.program("node");
    node.arg(folder(workspace).join("lint.cjs"));
    node.env("NODE_PATH", packages.join("node_modules"));
    node.stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut node = node.spawn().context("cannot run node")?;
    let mut input = node.stdin.take().context("no input")?;
    input.write_all(files.join("\n").as_bytes())?;
    drop(input);
    let output = node.wait_with_output()?;
    ensure!(output.status.success(), "textlint failed");
    let output = String::from_utf8(output.stdout)?;
    let hits = output
        .lines()
        .map(|line| Hit::parse(line).context(line.to_owned()));
    hits.collect()
}

/// Endings of the files that are read.
const KINDS: [&str; 4] = [".rs", ".md", ".py", ".pyi"];

fn folder(workspace: &Workspace) -> PathBuf {
    workspace.root().join("xtask/tools/prose")
}

fn baseline(workspace: &Workspace) -> PathBuf {
    folder(workspace).join("baseline.txt")
}

/// Number of hits by top-level folder and rule.
type Counts = BTreeMap<(String, String), usize>;

fn count(hits: &[Hit]) -> Counts {
    let mut counts = Counts::new();
    for hit in hits {
        *counts.entry(hit.key()).or_default() += 1;
    }
    counts
}

fn read(workspace: &Workspace) -> anyhow::Result<Counts> {
    parse(&fs::read_to_string(baseline(workspace)).context("no baseline of the prose")?)
}

fn parse(text: &str) -> anyhow::Result<Counts> {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    let counts = lines.map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
        [folder, rule, most] => Ok(((folder.to_owned(), rule.to_owned()), most.parse()?)),
        _ => anyhow::bail!("baseline of the prose: {line:?}"),
    });
    counts.collect()
}

/// The counts above the baseline, each with its hits in the changed files, or all of them if none
/// is there.
fn risen(baseline: &Counts, hits: &[Hit], changed: &BTreeSet<String>) -> String {
    let mut text = String::new();
    for (key, count) in count(hits) {
        let most = baseline.get(&key).copied().unwrap_or_default();
        if count > most {
            let all: Vec<_> = hits.iter().filter(|hit| hit.key() == key).collect();
            let mut new = all.clone();
            new.retain(|hit| changed.contains(&hit.file));
            let shown = if new.is_empty() { all } else { new };
            text += &format!("{}, {}: {count} hits, {most} at most:\n", key.0, key.1);
            text.extend(shown.iter().map(|hit| format!("  {}\n", hit.line)));
        }
    }
    text
}

/// The files that changed since the baseline was written.
fn changed_files(workspace: &Workspace) -> anyhow::Result<BTreeSet<String>> {
    let path = baseline(workspace);
    let path = path
        .strip_prefix(workspace.root())
        .unwrap_or(Path::new("."));
    let path = path.to_str().context("path")?;
    let commit = workspace.git(&["log", "-1", "--format=%H", "--", path])?;
    let since = if commit.is_empty() { "HEAD" } else { &commit };
    let changed = workspace.git(&["diff", "--name-only", since])?;
    let new = workspace.git(&["ls-files", "--others", "--exclude-standard"])?;
    let files = changed.lines().chain(new.lines());
    Ok(files.map(str::to_owned).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hits(places: &[&str]) -> Vec<Hit> {
        let line = |place: &&str| format!("{place}\tgoes-on\tgoes on\tcontinues");
        let hits = places.iter().map(line).map(|line| Hit::parse(&line));
        hits.collect::<Option<_>>().expect("four fields")
    }

    #[test]
    fn a_new_hit_fails_with_its_place_and_suggestion() {
        let baseline = parse("# comment\nfranka-rt goes-on 1\n").expect("valid");
        let hits = hits(&["franka-rt/src/a.rs:3", "franka-rt/src/b.rs:7"]);
        let changed = BTreeSet::from(["franka-rt/src/b.rs".to_owned()]);
        let text = risen(&baseline, &hits, &changed);
        assert_eq!(
            text,
            "franka-rt, goes-on: 2 hits, 1 at most:\n  \
             franka-rt/src/b.rs:7: goes-on: \"goes on\"; instead: continues\n"
        );
        let text = risen(&baseline, &hits, &BTreeSet::new());
        assert!(text.contains("a.rs:3") && text.contains("b.rs:7"), "{text}");
    }

    #[test]
    fn hits_of_another_folder_or_rule_do_not_make_up_for_a_new_one() {
        let baseline = parse("franka-rt goes-on 9\n. says 9\n").expect("valid");
        let text = risen(&baseline, &hits(&["README.md:1"]), &BTreeSet::new());
        assert!(text.starts_with("., goes-on: 1 hits, 0 at most"), "{text}");
    }

    #[test]
    fn as_many_hits_as_allowed_pass() {
        let baseline = parse("docs goes-on 2\n").expect("valid");
        let two = hits(&["docs/src/a.md:1", "docs/src/a.md:2"]);
        assert_eq!(risen(&baseline, &two, &BTreeSet::new()), "");
    }

    #[test]
    fn a_damaged_baseline_is_refused() {
        for text in ["docs goes-on\n", "docs goes-on x\n", "\n"] {
            assert!(parse(text).is_err(), "{text:?}");
        }
    }
}

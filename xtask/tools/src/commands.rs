//! The commands of Cargo that the book and the READMEs name. Their tasks, steps, packages,
//! examples, programs and tests must exist.
//!
//! Figures are next to the command that printed them. Without the command, nobody can measure the
//! figure again.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};

use crate::book::REPOSITORY_PAGES;
use crate::metadata::{self, list, text};
use crate::names;
use crate::page::{blocks, prose};
use xtask::realtime::succeeds;
use xtask::step;
use xtask::suite::STEPS;
use xtask::workspace::Workspace;

/// Fails with every command that cannot be run.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<()> {
    let targets = targets(workspace)?;
    let mut found = Vec::new();
    let mut count = 0;
    let mut pages = names::pages(workspace)?;
    pages.extend(REPOSITORY_PAGES.map(PathBuf::from));
    for path in pages {
        let name = path.display();
        let page = fs::read_to_string(workspace.root().join(&path));
        for command in commands(&page.with_context(|| name.to_string())?) {
            count += 1;
            if let Some(fault) = fault(&command, &targets) {
                found.push(format!("{name}: `{command}`: {fault}"));
            }
        }
    }
    if !found.is_empty() {
        bail!("commands that the book names:\n{}", found.join("\n"));
    }
    println!("{count} commands of Cargo in the book and the READMEs");
    Ok(())
}

/// The commands of Cargo on a page: code in its text, and lines of its blocks.
fn commands(page: &str) -> Vec<String> {
    let prose: String = prose(page).map(|line| format!("{line} ")).collect();
    let spans = prose.split('`').skip(1).step_by(2);
    let lines = blocks(page);
    let words = spans
        .chain(lines)
        .map(|text| text.split_whitespace().collect::<Vec<_>>());
    let commands = words.map(|words| {
        let is_setting = |word: &&&str| word.contains('=') && !word.starts_with('-');
        let settings = words.iter().take_while(is_setting).count();
        words[settings..].join(" ")
    });
    commands
        .filter(|command| command.starts_with("cargo "))
        .collect()
}

/// A target that Cargo builds.
struct Target {
    package: String,
    kind: String,
    name: String,
    /// The file of its root.
    file: PathBuf,
    /// The features that it requires.
    features: Vec<String>,
}

fn targets(workspace: &Workspace) -> anyhow::Result<Vec<Target>> {
    let mut targets = Vec::new();
    for package in metadata::packages(workspace)? {
        for target in list(&package["targets"]) {
            for kind in list(&target["kind"]) {
                targets.push(Target {
                    package: text(&package["name"]),
                    kind: text(kind),
                    name: text(&target["name"]),
                    file: text(&target["src_path"]).into(),
                    features: list(&target["required-features"])
                        .iter()
                        .map(text)
                        .collect(),
                });
            }
        }
    }
    Ok(targets)
}

/// The missing object of a command, if any.
fn fault(command: &str, targets: &[Target]) -> Option<String> {
    let command = command.split(" -- ").next().unwrap_or(command);
    let command = command.split(" # ").next().unwrap_or(command);
    let words: Vec<&str> = command.split(' ').skip(1).collect();
    match words[..] {
        ["xtask", "test"] => None,
        ["xtask", "test", "--only", steps] => {
            let steps: Vec<_> = steps.split(',').map(str::to_owned).collect();
            let fault = step::check_names(STEPS, &steps).err();
            fault.map(|fault| fault.to_string())
        }
        ["xtask", ref words @ ..] => crate::fault_of_task(words),
        _ => fault_of_build(&words, targets),
    }
}

/// The missing target of a command, if any.
fn fault_of_build(words: &[&str], targets: &[Target]) -> Option<String> {
    let behind = |options: &[&str]| {
        let at = words.iter().position(|word| options.contains(word))?;
        words.get(at + 1).copied()
    };
    let package = behind(&["--package", "-p"]);
    if let Some(package) = package
        && !targets.iter().any(|target| target.package == package)
    {
        return Some(format!("no package {package}"));
    }
    for (option, kind) in [
        ("--example", "example"),
        ("--bin", "bin"),
        ("--test", "test"),
    ] {
        let Some(name) = behind(&[option]) else {
            continue;
        };
        let target = targets.iter().find(|target| {
            target.kind == kind
                && target.name == name
                && package.is_none_or(|package| target.package == package)
        });
        let Some(target) = target else {
            return Some(format!("no {kind} {name}"));
        };
        let given = behind(&["--features", "-F"]).unwrap_or_default();
        let missing = |feature: &&String| given.split(',').all(|it| it != *feature);
        if let Some(feature) = target.features.iter().find(missing) {
            return Some(format!("{name} takes --features {feature}"));
        }
        let at = words.iter().position(|word| *word == option)?;
        let filter = words.get(at + 2).filter(|word| !word.starts_with('-'));
        if let (Some(filter), "test") = (filter, kind)
            && !names_a_test(&target.file, filter)
        {
            return Some(format!("no test {filter} in {name}"));
        }
    }
    None
}

/// True if a file in the directory of the tests' root, or below it, contains the last part of the
/// filter or has it in its name.
fn names_a_test(root: &Path, filter: &str) -> bool {
    let name = filter.rsplit("::").next().unwrap_or(filter);
    let Some(directory) = root.parent() else {
        return false;
    };
    let function = format!("fn {name}");
    let files = format!("{}/*{name}*", directory.display());
    let directory = directory.display().to_string();
    succeeds(&["git", "ls-files", "--error-unmatch", &files])
        || succeeds(&[
            "git",
            "grep",
            "--untracked",
            "-q",
            &function,
            "--",
            &directory,
        ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_found_in_code_and_blocks_without_their_settings() {
        let page = "`A=1 B=2 cargo test\n--test x`, `cargo` and cargo doc\n```sh\ncargo run --example y\nls\n```\n";
        assert_eq!(
            commands(page),
            ["cargo test --test x", "cargo run --example y"]
        );
    }

    #[test]
    fn missing_command_target_is_reported() {
        let target = |package: &str, kind: &str, name: &str| Target {
            package: package.to_owned(),
            kind: kind.to_owned(),
            name: name.to_owned(),
            file: Path::new("none/main.rs").to_owned(),
            features: vec![],
        };
        let with_feature = Target {
            features: vec!["f".to_owned()],
            ..target("a", "example", "g")
        };
        let targets = [
            target("a", "example", "e"),
            target("b", "bin", "p"),
            target("b", "test", "t"),
            with_feature,
        ];
        for (command, expected) in [
            ("cargo run --example e -- --figure x", None),
            ("cargo run --example x", Some("no example x")),
            ("cargo run --example g", Some("g takes --features f")),
            ("cargo run --features e,f --example g", None),
            ("cargo run -p a --bin p", Some("no bin p")),
            ("cargo run --package c", Some("no package c")),
            ("cargo xtask test --only tests", None),
            (
                "cargo xtask test --only tests,x",
                Some("got the step `x`, expected one of tests, doctests, client"),
            ),
            ("cargo xtask check --only fmt,clippy # quick", None),
            ("cargo xtask arms --x", None),
            ("cargo test --test t", None),
            (
                "cargo test --test t f -- --nocapture",
                Some("no test f in t"),
            ),
        ] {
            let found = fault(command, &targets);
            assert_eq!(found.as_deref(), expected, "{command}");
        }
        for command in [
            "cargo xtask check --only fmt,x",
            "cargo xtask check --x",
            "cargo xtask x",
        ] {
            assert!(fault(command, &targets).is_some(), "{command}");
        }
    }
}

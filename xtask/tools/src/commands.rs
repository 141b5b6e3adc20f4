//! The commands of Cargo that the book and the READMEs name. Their tasks, steps, packages,
//! examples, programs and tests must exist.
//!
//! Figures are next to the command that printed them. Without the command, nobody can measure the
//! figure again.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use cargo_metadata::{Package, TargetKind};

use crate::book::REPOSITORY_PAGES;
use crate::metadata;
use crate::names;
use crate::page::Page;
use xtask::realtime::succeeds;
use xtask::step;
use xtask::test_steps::STEPS;
use xtask::workspace::Workspace;

/// Fails with every command that cannot be run.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<()> {
    let packages = metadata::of(workspace)?.packages;
    let mut found = Vec::new();
    let mut count = 0;
    let mut pages = names::pages(workspace)?;
    pages.extend(REPOSITORY_PAGES.map(PathBuf::from));
    for path in pages {
        let name = path.display();
        let page = fs::read_to_string(workspace.root().join(&path));
        for command in commands(&page.with_context(|| name.to_string())?) {
            count += 1;
            if let Some(fault) = fault(&command, &packages) {
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
    let page = Page::parse(page);
    let lines = page.blocks.iter().flat_map(|(_, code)| code.lines());
    let code = page.spans.iter().map(String::as_str).chain(lines);
    let words = code.map(|text| text.split_whitespace().collect::<Vec<_>>());
    let commands = words.map(|words| {
        let is_setting = |word: &&&str| word.contains('=') && !word.starts_with('-');
        let settings = words.iter().take_while(is_setting).count();
        words[settings..].join(" ")
    });
    commands
        .filter(|command| command.starts_with("cargo "))
        .collect()
}

/// The missing object of a command, if any.
fn fault(command: &str, packages: &[Package]) -> Option<String> {
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
        _ => fault_of_build(&words, packages),
    }
}

/// The missing target of a command, if any.
fn fault_of_build(words: &[&str], packages: &[Package]) -> Option<String> {
    let behind = |options: &[&str]| {
        let at = words.iter().position(|word| options.contains(word))?;
        words.get(at + 1).copied()
    };
    let package = behind(&["--package", "-p"]);
    let mut chosen: Vec<_> = packages.iter().collect();
    if let Some(name) = package {
        chosen.retain(|package| *package.name == name);
        if chosen.is_empty() {
            return Some(format!("no package {name}"));
        }
    }
    for (option, kind) in [
        ("--example", TargetKind::Example),
        ("--bin", TargetKind::Bin),
        ("--test", TargetKind::Test),
    ] {
        let Some(name) = behind(&[option]) else {
            continue;
        };
        let mut targets = chosen.iter().flat_map(|package| &package.targets);
        let target = targets.find(|target| target.is_kind(kind.clone()) && target.name == name);
        let Some(target) = target else {
            return Some(format!("no {} {name}", option.trim_start_matches('-')));
        };
        let given = behind(&["--features", "-F"]).unwrap_or_default();
        let missing = |feature: &&String| given.split(',').all(|it| it != *feature);
        if let Some(feature) = target.required_features.iter().find(missing) {
            return Some(format!("{name} takes --features {feature}"));
        }
        let at = words.iter().position(|word| *word == option)?;
        let filter = words.get(at + 2).filter(|word| !word.starts_with('-'));
        if let (Some(filter), TargetKind::Test) = (filter, kind)
            && !names_a_test(target.src_path.as_std_path(), filter)
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
    let grep = [
        "git",
        "grep",
        "--untracked",
        "-q",
        &function,
        "--",
        &directory,
    ];
    succeeds(&["git", "ls-files", "--error-unmatch", &files]) || succeeds(&grep)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

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
        let package = |name: &str, targets: &[(&str, &str)]| -> Package {
            let targets = targets.iter().map(|(kind, name)| {
                let features = if *name == "g" { &["f"][..] } else { &[] };
                json!({"kind": [kind], "name": name, "crate_types": [], "edition": "2024",
                    "src_path": "none/main.rs", "required-features": features})
            });
            let targets: Vec<_> = targets.collect();
            serde_json::from_value(
                json!({"name": name, "version": "1.0.0", "id": name, "features": {},
                "dependencies": [], "targets": targets, "manifest_path": "none"}),
            )
            .expect("a package")
        };
        let packages = [
            package("a", &[("example", "e"), ("example", "g")]),
            package("b", &[("bin", "p"), ("test", "t")]),
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
            let found = fault(command, &packages);
            assert_eq!(found.as_deref(), expected, "{command}");
        }
        for command in [
            "cargo xtask check --only fmt,x",
            "cargo xtask check --x",
            "cargo xtask x",
        ] {
            assert!(fault(command, &packages).is_some(), "{command}");
        }
    }
}

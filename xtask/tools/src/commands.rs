//! The commands of Cargo that the book and the READMEs name. Their tasks, steps, packages,
//! examples, programs and tests must exist.
//!
//! Figures are next to the command that printed them. Without the command, nobody can measure the
//! figure again.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};

use crate::book::REPOSITORY_PAGES;
use crate::metadata;
use crate::names;
use crate::page::{blocks, prose};
use xtask::workspace::Workspace;

/// Fails with every command that cannot be run. `tasks` are the tasks of `cargo xtask`, each with
/// its flags; `steps` are the steps of `cargo xtask test --only`.
pub(crate) fn check(
    workspace: &Workspace,
    tasks: &[(String, Vec<String>)],
    steps: &[String],
) -> anyhow::Result<()> {
    let targets = targets(workspace)?;
    let known = Known {
        targets: &targets,
        tasks,
        steps,
    };
    let mut found = Vec::new();
    let mut count = 0;
    let mut pages = names::pages(&workspace.root().join("docs/src"))?;
    pages.extend(REPOSITORY_PAGES.map(|page| workspace.root().join(page)));
    for path in pages {
        let name = path.strip_prefix(workspace.root()).unwrap_or(&path);
        let page = fs::read_to_string(&path).with_context(|| format!("{}", path.display()))?;
        for command in commands(&page) {
            count += 1;
            if let Some(fault) = known.fault(&command) {
                found.push(format!("{}: `{command}`: {fault}", name.display()));
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
    let text = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_owned();
    let list = |value: &serde_json::Value| value.as_array().cloned().unwrap_or_default();
    let mut targets = Vec::new();
    for package in metadata::packages(workspace)? {
        for target in list(&package["targets"]) {
            for kind in list(&target["kind"]) {
                targets.push(Target {
                    package: text(&package["name"]),
                    kind: text(&kind),
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

/// All existing targets, tasks and steps.
struct Known<'a> {
    targets: &'a [Target],
    tasks: &'a [(String, Vec<String>)],
    steps: &'a [String],
}

impl Known<'_> {
    /// The missing object of a command, if any.
    fn fault(&self, command: &str) -> Option<String> {
        let command = command.split(" -- ").next().unwrap_or(command);
        let words: Vec<&str> = command.split(' ').skip(1).collect();
        match words[..] {
            ["xtask", task, ref rest @ ..] => self.fault_of_task(task, rest),
            _ => self.fault_of_build(&words),
        }
    }

    fn fault_of_task(&self, task: &str, rest: &[&str]) -> Option<String> {
        let Some((_, flags)) = self.tasks.iter().find(|(name, _)| name == task) else {
            return Some(format!("no task {task}"));
        };
        // Arguments after `--` belong to another program.
        let flags = (!flags.is_empty()).then_some(flags);
        for (index, word) in rest.iter().enumerate() {
            let flag = word.strip_prefix("--");
            if let (Some(flag), Some(flags)) = (flag, flags)
                && !flags.iter().any(|name| name == flag)
            {
                return Some(format!("no option --{flag}"));
            }
            if *word == "--only" && task == "test" {
                let only = rest.get(index + 1).copied().unwrap_or_default();
                let unknown = only
                    .split(',')
                    .find(|step| !self.steps.iter().any(|it| it == step));
                if let Some(step) = unknown {
                    return Some(format!("no step {step}"));
                }
            }
        }
        None
    }

    fn fault_of_build(&self, words: &[&str]) -> Option<String> {
        let behind = |options: &[&str]| {
            let at = words.iter().position(|word| options.contains(word))?;
            words.get(at + 1).copied()
        };
        let package = behind(&["--package", "-p"]);
        if let Some(package) = package
            && !self.targets.iter().any(|target| target.package == package)
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
            let target = self.targets.iter().find(|target| {
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
}

/// True if a file in the directory of the tests' root, or below it, contains the last part of the
/// filter or has it in its name.
fn names_a_test(root: &Path, filter: &str) -> bool {
    let name = filter.rsplit("::").next().unwrap_or(filter);
    root.parent()
        .is_some_and(|directory| is_below(directory, name))
}

fn is_below(directory: &Path, name: &str) -> bool {
    let Ok(entries) = fs::read_dir(directory) else {
        return false;
    };
    entries.flatten().map(|entry| entry.path()).any(|path| {
        let is_named = path
            .file_stem()
            .is_some_and(|stem| stem.to_string_lossy().contains(name));
        let has =
            || fs::read_to_string(&path).is_ok_and(|text| text.contains(&format!("fn {name}")));
        is_named || path.is_dir() && is_below(&path, name) || path.is_file() && has()
    })
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
        let known = Known {
            targets: &[
                target("a", "example", "e"),
                target("b", "bin", "p"),
                target("b", "test", "t"),
                with_feature,
            ],
            tasks: &[
                ("test".into(), vec!["only".into()]),
                ("arms".into(), vec![]),
            ],
            steps: &["fmt".into()],
        };
        for (command, fault) in [
            ("cargo run --example e -- --figure x", None),
            ("cargo run --example x", Some("no example x")),
            ("cargo run --example g", Some("g takes --features f")),
            ("cargo run --features e,f --example g", None),
            ("cargo run -p a --bin p", Some("no bin p")),
            ("cargo run --package c", Some("no package c")),
            ("cargo xtask test --only fmt", None),
            ("cargo xtask test --only fmt,x", Some("no step x")),
            ("cargo xtask test --x", Some("no option --x")),
            ("cargo xtask arms --x", None),
            ("cargo xtask x", Some("no task x")),
            ("cargo test --test t", None),
            (
                "cargo test --test t f -- --nocapture",
                Some("no test f in t"),
            ),
        ] {
            assert_eq!(known.fault(command).as_deref(), fault, "{command}");
        }
    }
}

//! The fuzz targets: builds them with a pinned cargo-fuzz and runs each for a number of executions.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context as _, bail, ensure};

use crate::step::Outcome;
use crate::workspace::Workspace;

/// Runs every target for a moment: the step of `cargo xtask test`.
pub(crate) fn check(workspace: &Workspace) -> anyhow::Result<Outcome> {
    match supported() {
        Ok(()) => run_all(workspace, RUNS_OF_A_CHECK).map(|()| Outcome::Passed),
        Err(why) => Outcome::without(why),
    }
}

/// Runs each target for `runs` executions.
pub(crate) fn run(workspace: &Workspace, runs: u64) -> anyhow::Result<()> {
    supported().map_err(anyhow::Error::msg)?;
    run_all(workspace, runs)
}

/// One target after the other. A finding ends its target and not the others.
fn run_all(workspace: &Workspace, runs: u64) -> anyhow::Result<()> {
    let fuzz = Fuzz::build(workspace)?;
    let reports = fuzz
        .targets()?
        .iter()
        .map(|target| fuzz.run(target, runs))
        .collect::<anyhow::Result<Vec<_>>>()?;
    println!();
    for report in &reports {
        println!("{}", report.line());
    }
    let findings = reports.iter().filter_map(|report| report.finding.as_ref());
    match findings.count() {
        0 => Ok(()),
        count => bail!("{count} of {} targets have a finding", reports.len()),
    }
}

/// Whether this machine can build the targets at all: libFuzzer is C++, and the sanitizer has its
/// platforms.
fn supported() -> Result<(), String> {
    if !cfg!(any(target_os = "linux", target_os = "macos")) {
        return Err("cargo-fuzz works on Linux and macOS only".to_owned());
    }
    let compiler = std::env::var("CXX").unwrap_or_else(|_| "c++".to_owned());
    let mut probe = Command::new(&compiler);
    probe.arg("--version");
    probe.stdout(Stdio::null()).stderr(Stdio::null());
    if probe.status().is_ok_and(|status| status.success()) {
        Ok(())
    } else {
        Err(format!(
            "libFuzzer needs a C++ compiler, and `{compiler}` is none"
        ))
    }
}

/// The targets, built.
struct Fuzz {
    /// The package of the targets.
    package: PathBuf,
    /// What is built, found and collected.
    output: PathBuf,
    /// Where the programs are.
    programs: PathBuf,
}

impl Fuzz {
    /// Builds the targets, in a directory of their own: they are compiled with a sanitizer.
    fn build(workspace: &Workspace) -> anyhow::Result<Self> {
        let cargo_fuzz = install(workspace)?;
        let package = workspace.root().join("fuzz");
        let output = workspace.target().join("fuzz");
        // cargo-fuzz has no `--locked`: this fails where the lock file is not up to date.
        let mut fetch = workspace.cargo();
        fetch.args(["fetch", "--locked", "--manifest-path"]);
        workspace.run(fetch.arg(package.join("Cargo.toml")))?;

        let triple = host()?;
        let mut build = workspace.program(cargo_fuzz);
        build.args(["fuzz", "build", "--target", &triple, "--target-dir"]);
        build.arg(output.join("build")).current_dir(&package);
        // The sanitizer's options are for nightly compilers, and a stable one takes them with this.
        build.env("RUSTC_BOOTSTRAP", "1");
        workspace.run(&mut build)?;

        let programs = output.join("build").join(triple).join("release");
        let mut seeds = workspace.program(programs.join("seeds"));
        workspace.run(seeds.arg(output.join("seeds")))?;
        Ok(Self {
            package,
            output,
            programs,
        })
    }

    /// The names of the targets: those of their sources.
    fn targets(&self) -> anyhow::Result<Vec<String>> {
        let directory = self.package.join("fuzz_targets");
        let mut names = Vec::new();
        for entry in fs::read_dir(&directory)? {
            let path = entry?.path();
            let name = path.file_stem().context("a source has a name")?;
            names.push(name.to_string_lossy().into_owned());
        }
        ensure!(!names.is_empty(), "no target in {}", directory.display());
        names.sort();
        Ok(names)
    }

    /// One target. What it learns stays in the corpus, from which the next run goes on.
    fn run(&self, target: &str, runs: u64) -> anyhow::Result<Report> {
        let directory = |kind: &str| self.output.join(kind).join(target);
        let (corpus, findings) = (directory("corpus"), directory("findings"));
        for directory in [&corpus, &findings] {
            fs::create_dir_all(directory)?;
        }
        println!("$ {target} -runs={runs}");
        let start = Instant::now();
        let output = Command::new(self.programs.join(target))
            .arg(format!("-runs={runs}"))
            .arg(format!("-max_len={INPUT_MAX}"))
            .arg(format!("-artifact_prefix={}/", findings.display()))
            .arg("-print_final_stats=1")
            .args([&corpus, &directory("seeds")])
            // The crate does not allocate, and finding leaks needs rights that containers lack.
            .env("ASAN_OPTIONS", "detect_leaks=0")
            .output()
            .with_context(|| format!("cannot run {target}"))?;
        let log = String::from_utf8_lossy(&output.stderr);
        let finding = (!output.status.success()).then(|| {
            eprintln!("{log}");
            findings
        });
        Ok(Report {
            target: target.to_owned(),
            executions: executions(&log),
            seconds: start.elapsed().as_secs_f64(),
            finding,
        })
    }
}

/// What came of one target.
struct Report {
    target: String,
    /// `None` if the target did not get as far as to count them.
    executions: Option<u64>,
    seconds: f64,
    /// Where the input is that broke something.
    finding: Option<PathBuf>,
}

impl Report {
    fn line(&self) -> String {
        let executions = match self.executions {
            Some(count) => count.to_string(),
            None => "an unknown number of".to_owned(),
        };
        let findings = match &self.finding {
            None => "0 findings".to_owned(),
            Some(directory) => format!("A FINDING, in {}", directory.display()),
        };
        format!(
            "{:<16} {executions:>10} executions in {:7.1} s, {findings}",
            self.target, self.seconds
        )
    }
}

/// How often libFuzzer has called the target, by the statistics at the end of its log.
fn executions(log: &str) -> Option<u64> {
    let line = log
        .lines()
        .find_map(|line| line.strip_prefix("stat::number_of_executed_units:"))?;
    line.trim().parse().ok()
}

/// cargo-fuzz, installed below the build directory unless it is there in the right version.
fn install(workspace: &Workspace) -> anyhow::Result<PathBuf> {
    let root = workspace.target().join("tools");
    let program = root.join("bin").join("cargo-fuzz");
    if version(&program).as_deref() == Some(VERSION) {
        return Ok(program);
    }
    // It starts a compiler and nothing more: without optimisation it is there sooner.
    let mut install = workspace.cargo();
    install.args(["install", "--quiet", "--locked", "--debug", "--force"]);
    install
        .args(["--version", VERSION, "--root"])
        .arg(&root)
        .arg("--target-dir")
        .arg(root.join("build"));
    workspace.run(install.arg("cargo-fuzz"))?;
    // It is not built twice.
    fs::remove_dir_all(root.join("build"))?;
    Ok(program)
}

/// Version of an installed cargo-fuzz.
fn version(program: &Path) -> Option<String> {
    let output = Command::new(program).arg("--version").output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout);
    Some(text.trim().strip_prefix("cargo-fuzz ")?.to_owned())
}

/// The platform that the compiler builds for by itself. cargo-fuzz would guess that of its own
/// build.
fn host() -> anyhow::Result<String> {
    let output = Command::new("rustc").arg("-vV").output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.context("rustc names no host")?.to_owned())
}

/// The cargo-fuzz that the targets are built with.
const VERSION: &str = "0.13.2";

/// Executions of each target in `cargo xtask test`: five seconds or so for the slowest.
const RUNS_OF_A_CHECK: u64 = 200_000;

/// Longest input in bytes: beyond the longest datagram, and a stream of some messages.
const INPUT_MAX: usize = 4096;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn executions_are_read_from_the_statistics() {
        let log = "#4 pulse\nstat::number_of_executed_units: 10000000\nstat::peak_rss_mb: 553\n";
        assert_eq!(executions(log), Some(10_000_000));
        assert_eq!(executions("==1==ERROR: AddressSanitizer"), None);
    }

    #[test]
    fn a_finding_stands_out_in_the_line_of_its_target() {
        let mut report = Report {
            target: "stream".to_owned(),
            executions: Some(10),
            seconds: 1.25,
            finding: None,
        };
        assert!(report.line().ends_with("s, 0 findings"));
        report.finding = Some("target/fuzz/findings/stream".into());
        let line = report.line();
        assert!(line.starts_with("stream "), "{line}");
        assert!(
            line.ends_with("A FINDING, in target/fuzz/findings/stream"),
            "{line}"
        );
    }

    #[test]
    fn a_program_that_is_not_there_has_no_version() {
        assert_eq!(version(Path::new("no-such-program")), None);
    }
}

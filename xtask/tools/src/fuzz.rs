//! The fuzz targets: builds them as cargo-fuzz does and runs each for a number of executions.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use anyhow::{Context as _, bail, ensure};

use xtask::workspace::Workspace;

/// Runs each target for `runs` executions, as many targets at a time as there are processors. A
/// finding ends its target, but not the others.
pub(crate) fn run(workspace: &Workspace, runs: u64) -> anyhow::Result<()> {
    supported().map_err(anyhow::Error::msg)?;
    let fuzz = Fuzz::build(workspace)?;
    let targets = fuzz.targets()?;
    let (next, reports) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some(target) = targets.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let report = fuzz.run(target, runs);
                    reports.lock().expect("no panic").push(report);
                }
            });
        }
    });
    let reports = reports.into_inner().expect("no panic");
    let mut reports = reports.into_iter().collect::<anyhow::Result<Vec<_>>>()?;
    reports.sort_by(|a, b| a.target.cmp(&b.target));
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

/// Checks that this machine can build the targets: libFuzzer is C++, and the sanitizer supports
/// only some platforms.
fn supported() -> Result<(), String> {
    if !cfg!(any(target_os = "linux", target_os = "macos")) {
        return Err("the address sanitizer exists on Linux and macOS only".to_owned());
    }
    let compiler = std::env::var("CXX").unwrap_or_else(|_| "c++".to_owned());
    let mut probe = Command::new(&compiler);
    probe.arg("--version");
    probe.stdout(Stdio::null()).stderr(Stdio::null());
    if probe.status().is_ok_and(|status| status.success()) {
        Ok(())
    } else {
        Err(format!(
            "libFuzzer needs a C++ compiler, and `{compiler}` is not one"
        ))
    }
}

/// The targets, built.
struct Fuzz {
    /// The package of the targets.
    package: PathBuf,
    /// Directory of builds, findings and corpora.
    output: PathBuf,
    /// Directory of the programs.
    programs: PathBuf,
}

impl Fuzz {
    /// Builds the targets, in a separate directory, because they are compiled with a sanitizer.
    fn build(workspace: &Workspace) -> anyhow::Result<Self> {
        let package = workspace.root().join("fuzz");
        let output = workspace.target().join("fuzz");
        let triple = host()?;
        let mut build = workspace.cargo();
        build.args([
            "build",
            "--locked",
            "--release",
            "--bins",
            "--target",
            &triple,
        ]);
        build.arg("--manifest-path").arg(package.join("Cargo.toml"));
        build.arg("--target-dir").arg(output.join("build"));
        build.env("RUSTFLAGS", FLAGS.join(" "));
        // The sanitizer's options require a nightly compiler; with this variable a stable one
        // accepts them.
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

    /// The names of the targets: the names of their sources.
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

    /// Runs one target. Its new inputs stay in the corpus, from which the next run continues.
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
            .arg(format!("-malloc_limit_mb={ALLOCATION_MAX_MB}"))
            .arg("-print_final_stats=1")
            .args([&corpus, &directory("seeds")])
            // Finding leaks requires rights that containers lack.
            .env("ASAN_OPTIONS", "detect_leaks=0")
            .output()
            .with_context(|| format!("cannot run {target}"))?;
        let log = String::from_utf8_lossy(&output.stderr);
        ensure!(
            log.contains("inline 8-bit counters"),
            "{target} was built without counters of its coverage:\n{log}"
        );
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

/// Result of one target.
struct Report {
    target: String,
    /// `None` if the target ended before it counted them.
    executions: Option<u64>,
    seconds: f64,
    /// Path of the input that caused a failure.
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

/// Number of calls of the target by libFuzzer, from the statistics at the end of its log.
fn executions(log: &str) -> Option<u64> {
    let line = log
        .lines()
        .find_map(|line| line.strip_prefix("stat::number_of_executed_units:"))?;
    line.trim().parse().ok()
}

/// The default platform of the compiler. Naming it keeps build scripts and macros free of the
/// sanitizer.
fn host() -> anyhow::Result<String> {
    let output = Command::new("rustc").arg("-vV").output()?;
    let text = String::from_utf8_lossy(&output.stdout);
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.context("rustc names no host")?.to_owned())
}

/// The flags of cargo-fuzz 0.13 with `--strip-dead-code`: the instrumentation for libFuzzer, and
/// the sanitizer.
const FLAGS: &[&str] = &[
    "--cfg=fuzzing",
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    "-Zsanitizer=address",
    "-Ccodegen-units=1",
];

/// Longest input in bytes: beyond the longest datagram, and a stream of some messages.
const INPUT_MAX: usize = 4096;

/// Largest single allocation of a target. The largest correct result of [`INPUT_MAX`] bytes is 1
/// MB, by decompression. A larger allocation means that the target trusted a length in the input.
const ALLOCATION_MAX_MB: usize = 16;

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
}

//! The fuzz targets, each run by cargo-fuzz for a number of executions.

use std::fs;
use std::process::Command;
use std::thread;

use anyhow::{Context as _, ensure};

use crate::tools;
use xtask::workspace::Workspace;

/// Runs each target for `runs` executions, all at the same time. A
/// finding ends its target, but not the others.
pub(crate) fn run(workspace: &Workspace, runs: u64) -> anyhow::Result<()> {
    let path = tools::path_with(workspace, tools::FUZZ)?;
    let fuzz = |task: &str| {
        let mut command = workspace.cargo();
        command.args(["fuzz", task, "--fuzz-dir", "fuzz"]);
        // The sanitizer's options require a nightly compiler; with this variable a stable one
        // accepts them.
        command.env("PATH", &path).env("RUSTC_BOOTSTRAP", "1");
        command
    };
    let output = workspace.target().join("fuzz");
    let built = output.join("build");
    workspace.run(fuzz("build").arg("--target-dir").arg(&built))?;
    let platforms = fs::read_dir(&built)?.flatten();
    let mut seeds = platforms.map(|platform| platform.path().join("release/seeds"));
    let seeds = seeds.find(|program| program.exists());
    let mut seeds = workspace.program(seeds.context("cargo-fuzz built no `seeds`")?);
    workspace.run(seeds.arg(output.join("seeds")))?;
    let targets = workspace.output(&mut fuzz("list"))?;
    let command = |target: &str| -> anyhow::Result<Command> {
        let [corpus, findings, seeds] =
            ["corpus", "findings", "seeds"].map(|kind| output.join(kind).join(target));
        for directory in [&corpus, &findings] {
            fs::create_dir_all(directory)?;
        }
        let mut command = fuzz("run");
        command.arg("--target-dir").arg(&built).arg(target);
        command.args([&corpus, &seeds]).arg("--");
        command.arg(format!("-runs={runs}"));
        command.arg(format!("-artifact_prefix={}/", findings.display()));
        command.args(LIMITS).env("ASAN_OPTIONS", "detect_leaks=0");
        Ok(command)
    };
    let targets: Vec<&str> = targets.lines().collect();
    ensure!(!targets.is_empty(), "there are no targets");
    let run = &|target| -> anyhow::Result<Option<&str>> {
        let output = command(target)?.output().context("cannot run cargo")?;
        let log = String::from_utf8_lossy(&output.stderr);
        if output.status.success() {
            let lines = log.lines().filter(|line| line.starts_with("Done "));
            println!("{target}: {}", lines.collect::<String>());
            return Ok(None);
        }
        println!("{log}\n{target}: A FINDING, or it could not be run");
        Ok(Some(target))
    };
    let found: Vec<&str> = thread::scope(|scope| {
        let runs = targets.into_iter().map(|it| scope.spawn(move || run(it)));
        let ended = runs.collect::<Vec<_>>().into_iter().map(|it| it.join());
        let found = ended.map(|it| it.expect("no panic"));
        found
            .filter_map(Result::transpose)
            .collect::<Result<_, _>>()
    })?;
    ensure!(
        found.is_empty(),
        "{}: see target/fuzz/findings",
        found.join(", ")
    );
    Ok(())
}

/// The longest input is beyond the longest datagram, and a stream of some messages. The largest
/// correct result of an input is 1 MB, by decompression; an allocation of 16 MB means that the
/// target trusted a length in its input.
const LIMITS: [&str; 2] = ["-max_len=4096", "-malloc_limit_mb=16"];

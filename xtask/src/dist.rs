//! `cargo xtask dist`: the program `franka` for machines that have nothing else, checked where it
//! can run.
//!
//! ```text
//! standard library of the target? ── cargo zigbuild ──> franka ── static? size, time of --help
//!    ── here, or under qemu: a simulated robot, and a motion of it in virtual time
//! ```

use std::env;
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context as _, ensure};

use crate::cross::{architecture, emulator, is_installed, lacks, path_with, sysroot};
use crate::package::OLDEST;
use crate::python::{NEWEST, Python};
use crate::step::is_ci;
use crate::workspace::Workspace;

/// A machine to build for.
struct Machine {
    target: &'static str,
    /// The oldest C library that will do; none is needed where it is part of the program.
    glibc: &'static str,
}

const MACHINES: [Machine; 3] = [
    Machine {
        target: "x86_64-unknown-linux-musl",
        glibc: "",
    },
    Machine {
        target: "aarch64-unknown-linux-musl",
        glibc: "",
    },
    Machine {
        target: "x86_64-unknown-linux-gnu",
        glibc: ".2.17",
    },
];

/// Builds for every machine that this one can build for, checks what can run here, and says of each
/// what became of it. Fails if a check fails, or if none was built, and with `CI=true` if one was
/// not.
pub(crate) fn run(workspace: &Workspace, only: &[String]) -> anyhow::Result<()> {
    let is_chosen =
        |machine: &&Machine| only.is_empty() || only.iter().any(|it| it == machine.target);
    let chosen: Vec<&Machine> = MACHINES.iter().filter(is_chosen).collect();
    let targets = MACHINES.map(|machine| machine.target).join(", ");
    ensure!(!chosen.is_empty(), "the targets are {targets}");
    let (mut built, mut lines) = (0, Vec::new());
    for machine in &chosen {
        let line = match machine.build(workspace)? {
            Ok(program) => {
                built += 1;
                machine.check(&program)?
            }
            Err(why) => format!("NOT BUILT, NOT CHECKED: {why}"),
        };
        lines.push(format!("{}: {line}", machine.target));
    }
    println!("\n{}", lines.join("\n"));
    ensure!(built > 0, "nothing was built");
    ensure!(
        built == chosen.len() || !is_ci(),
        "with CI=true every chosen program has to be built"
    );
    Ok(())
}

impl Machine {
    /// The program, or what this machine lacks to build it.
    fn build(&self, workspace: &Workspace) -> anyhow::Result<Result<PathBuf, String>> {
        if let Some(why) = lacks(self.target, &sysroot()?) {
            return Ok(Err(why));
        }
        let python = match Python::find(OLDEST..=NEWEST) {
            Ok(python) => python,
            Err(why) => return Ok(Err(why)),
        };
        let requirements = workspace.root().join("franka-cli/dist/build.txt");
        let interpreter = python.environment(workspace, "python-dist", &requirements)?;
        let mut build = workspace.cargo();
        build.args(["zigbuild", "--locked", "--profile", "dist"]);
        build.args(["--package", "franka-cli", "--target"]);
        build.arg(format!("{}{}", self.target, self.glibc));
        build.env("PATH", path_with(&interpreter)?);
        workspace.run(&mut build)?;
        let program = workspace.target().join(self.target).join("dist/franka");
        Ok(Ok(program))
    }

    fn is_static(&self) -> bool {
        self.glibc.is_empty()
    }

    /// Runs what was built; returns a line about it.
    fn check(&self, program: &Path) -> anyhow::Result<String> {
        let bytes = fs::read(program)?;
        let needs = needs_a_loader(&bytes);
        ensure!(
            needs != self.is_static(),
            "{}: a loader of shared libraries: got {needs}, expected {}",
            program.display(),
            !self.is_static()
        );
        let size = bytes.len() as f64 / 1e6;
        let kind = match self.is_static() {
            true => "static",
            false => "dynamic",
        };
        let about = format!("{kind}, {size:.1} MB");
        let runner = match architecture(self.target) == env::consts::ARCH {
            true => None,
            false => match emulator(architecture(self.target), is_installed) {
                Ok(emulator) => Some(emulator),
                Err(why) => return Ok(format!("{about}; NOT CHECKED: {why}")),
            },
        };
        let run = || match &runner {
            None => Command::new(program),
            Some(emulator) => {
                let mut command = Command::new(emulator);
                command.arg(program);
                command
            }
        };
        let help = time_of_help(run)?;
        moves_a_simulated_robot(run)?;
        let by = runner.as_deref().unwrap_or("this machine");
        Ok(format!(
            "{about}, --help in {:.1} ms, moved a simulated robot; by {by}",
            help.as_secs_f64() * 1e3
        ))
    }
}

/// Whether a program (64-bit ELF, little-endian) asks for a loader of shared libraries: it then has
/// a program header of the type `PT_INTERP`.
fn needs_a_loader(program: &[u8]) -> bool {
    let at = |from: usize, bytes: usize| {
        let field = program.get(from..from + bytes).unwrap_or_default();
        let bytes = field.iter().rev();
        bytes.fold(0, |sum, byte| sum << 8 | usize::from(*byte))
    };
    let (headers, size, count) = (at(32, 8), at(54, 2), at(56, 2));
    (0..count).any(|header| at(headers + header * size, 4) == PT_INTERP)
}

/// Names the loader; ELF-64, program headers.
const PT_INTERP: usize = 3;

/// The median of 21 starts.
fn time_of_help(run: impl Fn() -> Command) -> anyhow::Result<Duration> {
    let mut times = Vec::new();
    for _ in 0..21 {
        let begin = Instant::now();
        let status = run().arg("--help").stdout(Stdio::null()).status()?;
        times.push(begin.elapsed());
        ensure!(status.success(), "--help failed");
    }
    times.sort_unstable();
    Ok(times[times.len() / 2])
}

/// Starts a simulated robot in virtual time and moves its hand by 5 cm.
fn moves_a_simulated_robot(run: impl Fn() -> Command) -> anyhow::Result<()> {
    let mut sim = run();
    sim.args(["sim", "--port", "0", "--virtual-time=5"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null());
    let mut sim = Running(sim.spawn()?);
    let mut line = String::new();
    let out = sim.0.stdout.as_mut().context("piped")?;
    BufReader::new(out).read_line(&mut line)?;
    let address = line.trim().rsplit(' ').next().unwrap_or_default();
    let mut motion = run();
    motion.args(["move", address, "--by", "0,0,0.05", "--yes"]);
    let status = motion.args(["--realtime", "ignore"]).status()?;
    ensure!(
        status.success(),
        "the simulated robot at {address} was not moved"
    );
    Ok(())
}

/// Killed at the end.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_of_this_machine_needs_a_loader_of_shared_libraries() {
        let this = fs::read(env::current_exe().unwrap()).unwrap();
        let is_dynamic = cfg!(target_env = "gnu");
        assert_eq!(needs_a_loader(&this), is_dynamic);
        // As many program headers as before, without their types.
        let mut without = this;
        let headers = usize::from(without[32]);
        without[headers..headers + 56 * 16].fill(0);
        assert!(!needs_a_loader(&without));
    }
}

//! Checks of a built program: its requirements, its size and speed, and a motion of a simulated
//! robot.

use std::env;
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::PathBuf;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail, ensure};

use crate::cross::{emulator, is_installed};

/// A program that can run here.
#[derive(Debug)]
pub(super) struct Program {
    pub(super) path: PathBuf,
    /// Emulator that runs it, if this machine cannot.
    emulator: Option<String>,
}

impl Program {
    /// The program, or the missing requirement to run one of `architecture`.
    pub(super) fn new(path: PathBuf, architecture: &str) -> Result<Self, String> {
        let emulator = match architecture == env::consts::ARCH {
            true => None,
            false => Some(emulator(architecture, is_installed)?),
        };
        Ok(Self { path, emulator })
    }

    pub(super) fn is_of_this_machine(&self) -> bool {
        self.emulator.is_none()
    }

    /// Begins a call of the program.
    pub(super) fn command(&self) -> Command {
        match &self.emulator {
            None => Command::new(&self.path),
            Some(emulator) => {
                let mut command = Command::new(emulator);
                command.arg(&self.path);
                command
            }
        }
    }

    /// Checks that it is static or dynamic, as expected, and runs it; returns a line about it.
    pub(super) fn check(&self, is_static: bool) -> anyhow::Result<String> {
        let mut headers = Command::new("readelf");
        let headers = headers.arg("--program-headers").arg(&self.path).output();
        let headers = headers
            .context("readelf, of binutils, cannot be run")?
            .stdout;
        let needs_a_loader = String::from_utf8_lossy(&headers).contains(" INTERP ");
        ensure!(
            needs_a_loader != is_static,
            "{}: a loader of shared libraries: got {needs_a_loader}, expected {}",
            self.path.display(),
            !is_static
        );
        let size = fs::metadata(&self.path)?.len() as f64 / 1e6;
        let kind = match is_static {
            true => "static",
            false => "dynamic",
        };
        let help = time_of_help(|| self.command())?;
        moves_a_simulated_robot(|| self.command())?;
        let by = self.emulator.as_deref().unwrap_or("this machine");
        Ok(format!(
            "{kind}, {size:.1} MB, --help in {:.1} ms, moved a simulated robot; by {by}",
            help.as_secs_f64() * 1e3
        ))
    }
}

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
    let mut sim = Running::start(sim.args(["sim", "--port", "0", "--virtual-time=5"]))?;
    let address = sim.address("listening on ")?;
    moves(run(), &address)
}

/// Moves the hand of a simulated robot by 5 cm.
pub(super) fn moves(mut franka: Command, address: &str) -> anyhow::Result<()> {
    franka.args(["move", address, "--by", "0,0,0.05", "--yes"]);
    let status = franka.args(["--realtime", "ignore"]).status()?;
    ensure!(
        status.success(),
        "the simulated robot at {address} was not moved"
    );
    Ok(())
}

/// A program that prints its address; killed at the end.
#[derive(Debug)]
pub(super) struct Running {
    program: Child,
    output: BufReader<ChildStdout>,
}

impl Running {
    pub(super) fn start(command: &mut Command) -> anyhow::Result<Self> {
        let mut program = command
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let output = BufReader::new(program.stdout.take().context("piped")?);
        Ok(Self { program, output })
    }

    /// The text after `before` in the next line that contains it.
    pub(super) fn address(&mut self, before: &str) -> anyhow::Result<String> {
        for line in (&mut self.output).lines() {
            if let Some((_, address)) = line?.split_once(before) {
                return Ok(address.trim().to_owned());
            }
        }
        bail!("the program ended without a line {before:?}")
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // The program may have ended already.
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

//! Checks of a built program: its requirements, its size, and a motion of a simulated
//! robot.

use std::env;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context as _, ensure};

use crate::cross::emulator;
use xtask::running::Running;

/// A program that can run here.
#[derive(Debug)]
pub(super) struct Program {
    pub(super) path: PathBuf,
    /// Emulator that runs it, if this machine cannot.
    emulator: Option<String>,
}

impl Program {
    /// The program of `architecture`, and what it takes to run it.
    pub(super) fn new(path: PathBuf, architecture: &str) -> anyhow::Result<Self> {
        let emulator = match architecture == env::consts::ARCH {
            true => None,
            false => Some(emulator(architecture)?),
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
        moves_a_simulated_robot(|| self.command())?;
        let by = self.emulator.as_deref().unwrap_or("this machine");
        Ok(format!(
            "{kind}, {size:.1} MB, moved a simulated robot; by {by}"
        ))
    }
}

/// Starts a simulated robot in virtual time and moves its hand by 5 cm.
fn moves_a_simulated_robot(run: impl Fn() -> Command) -> anyhow::Result<()> {
    let mut sim = run();
    sim.args(["sim", "--port", "0", "--virtual-time=5"]);
    let mut sim = Running::start("franka sim", sim)?;
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

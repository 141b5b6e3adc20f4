//! The client of franka-rs: a program that reads orders.

use std::io::{BufRead as _, BufReader, Lines, Write as _};
use std::net::SocketAddr;
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use anyhow::{Context as _, bail, ensure};

use crate::Stepped;

/// franka-rs, which holds the arm. Killed when this is dropped.
pub(crate) struct Theirs {
    program: Child,
    orders: ChildStdin,
    answers: Lines<BufReader<ChildStdout>>,
}

impl Theirs {
    /// Connects it to `robot`, and has it hold the arm.
    pub(crate) fn hold(program: &Path, robot: SocketAddr) -> anyhow::Result<Self> {
        let mut program = Command::new(program)
            .arg(robot.to_string())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .with_context(|| format!("cannot run {}", program.display()))?;
        let orders = program.stdin.take().context("no pipe")?;
        let output = program.stdout.take().context("no pipe")?;
        let mut this = Self {
            program,
            orders,
            answers: BufReader::new(output).lines(),
        };
        let answer = this.answer()?;
        ensure!(answer == "ready", "expected \"ready\", got {answer:?}");
        Ok(this)
    }

    /// Steps the target, `[m]`, and records the arm for `seconds`.
    pub(crate) fn step(&mut self, by: [f64; 3], seconds: f64) -> anyhow::Result<Stepped> {
        let [x, y, z] = by;
        writeln!(self.orders, "step {x} {y} {z} {seconds}")?;
        let answer = self.answer()?;
        match answer.split_whitespace().collect::<Vec<_>>()[..] {
            ["within", within, "off", off, "lag", lag] => Ok(Stepped {
                within: within.parse()?,
                off: off.parse()?,
                lag: lag.parse()?,
            }),
            _ => bail!("expected how the step came out, got {answer:?}"),
        }
    }

    /// Brings the arm to rest and ends the program.
    pub(crate) fn end(mut self) -> anyhow::Result<()> {
        writeln!(self.orders, "end")?;
        let answer = self.answer()?;
        ensure!(answer == "ended", "expected \"ended\", got {answer:?}");
        let status = self.program.wait()?;
        ensure!(status.success(), "it ended with {status}");
        Ok(())
    }

    fn answer(&mut self) -> anyhow::Result<String> {
        let line = self.answers.next().context("it ended without an answer")?;
        Ok(line?)
    }
}

impl Drop for Theirs {
    fn drop(&mut self) {
        // An error means that the program has ended.
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

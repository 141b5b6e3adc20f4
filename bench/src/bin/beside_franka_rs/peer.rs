//! Another client: a program that reads commands. See the table of commands in
//! `tests/peers/franka_rs`.

use std::io::{BufRead as _, BufReader, Lines, Write as _};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use anyhow::{Context as _, ensure};
use nalgebra::Vector3;

use crate::witness::Followed;

/// A client that holds the arm. Killed when it is dropped.
pub(crate) struct Peer {
    program: Child,
    orders: ChildStdin,
    answers: Lines<BufReader<ChildStdout>>,
}

impl Peer {
    /// Starts the program, which connects and holds the arm.
    pub(crate) fn hold(command: &mut Command) -> anyhow::Result<Self> {
        let mut program = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .with_context(|| format!("cannot run {}", command.get_program().display()))?;
        let orders = program.stdin.take().context("no pipe")?;
        let output = program.stdout.take().context("no pipe")?;
        let mut this = Self {
            program,
            orders,
            answers: BufReader::new(output).lines(),
        };
        this.expect("ready")?;
        Ok(this)
    }

    /// Steps the target, `[m]`, and waits for `seconds`.
    pub(crate) fn step(&mut self, by: [f64; 3], seconds: f64) -> anyhow::Result<Followed> {
        let [x, y, z] = by;
        writeln!(self.orders, "step {x} {y} {z} {seconds}")?;
        self.followed()
    }

    /// Moves the joints along a path that begins at their position, one point per cycle, `[rad]`,
    /// and waits until `seconds` have passed.
    pub(crate) fn follow(&mut self, path: &[[f64; 7]], seconds: f64) -> anyhow::Result<Followed> {
        writeln!(self.orders, "follow {} {seconds}", path.len())?;
        for point in path {
            writeln!(self.orders, "{}", point.map(|q| q.to_string()).join(" "))?;
        }
        self.followed()
    }

    /// Stops the arm and ends the program.
    pub(crate) fn end(mut self) -> anyhow::Result<()> {
        writeln!(self.orders, "end")?;
        self.expect("ended")?;
        let status = self.program.wait()?;
        ensure!(status.success(), "it ended with {status}");
        Ok(())
    }

    fn followed(&mut self) -> anyhow::Result<Followed> {
        let answer = self.answer()?;
        let target = answer.strip_prefix("target ").map(numbers);
        let target = target.with_context(|| format!("expected a target, got {answer:?}"))??;
        let mut reference = Vec::new();
        loop {
            let answer = self.answer()?;
            if answer == "done" {
                return Ok(Followed { target, reference });
            }
            let (time, position) = answer.split_once(' ').context("expected a cycle")?;
            reference.push((time.parse()?, numbers(position)?));
        }
    }

    fn expect(&mut self, wanted: &str) -> anyhow::Result<()> {
        let answer = self.answer()?;
        ensure!(answer == wanted, "expected {wanted:?}, got {answer:?}");
        Ok(())
    }

    fn answer(&mut self) -> anyhow::Result<String> {
        let line = self.answers.next().context("it ended without an answer")?;
        Ok(line?)
    }
}

fn numbers(text: &str) -> anyhow::Result<Vector3<f64>> {
    let values: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
    let values = values.with_context(|| format!("expected numbers, got {text:?}"))?;
    ensure!(values.len() == 3, "expected three numbers, got {text:?}");
    Ok(Vector3::from_column_slice(&values))
}

impl Drop for Peer {
    fn drop(&mut self) {
        // An error means that the program has ended.
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}

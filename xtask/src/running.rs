//! Programs whose output is read while they run.

use std::io::{self, BufRead as _, BufReader, PipeReader};
use std::process::{Child, Command};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::Context as _;

/// A program that serves others and prints its address; dropping this value ends it.
#[derive(Debug)]
pub struct Running {
    child: Child,
    lines: Receiver<String>,
}

impl Running {
    /// Starts a program, and prints each line of its output behind `name`.
    ///
    /// # Errors
    /// If the program cannot be started.
    pub fn start(name: impl Into<String>, command: Command) -> anyhow::Result<Self> {
        let name = name.into();
        let (child, output) = spawn(command)?;
        let (sender, lines) = mpsc::channel();
        // Reads to the end, so that a program that prints more never waits for a reader.
        thread::spawn(move || {
            for line in BufReader::new(output).lines().map_while(Result::ok) {
                println!("{name}: {line}");
                // The receiver may be gone.
                let _ = sender.send(line);
            }
        });
        Ok(Self { child, lines })
    }

    /// The text after `before` in the next line that contains it.
    ///
    /// # Errors
    /// If the program ends, or if there is no such line in time.
    pub fn address(&mut self, before: &str) -> anyhow::Result<String> {
        let deadline = Instant::now() + READY_TIME_MAX;
        loop {
            let line = self.lines.recv_timeout(deadline - Instant::now());
            let line = line.with_context(|| format!("the program printed no line {before:?}"))?;
            if let Some((_, address)) = line.split_once(before) {
                return Ok(address.trim().to_owned());
            }
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        kill(&mut self.child);
    }
}

/// Starts a program; the pipe has both its outputs.
fn spawn(mut command: Command) -> anyhow::Result<(Child, PipeReader)> {
    let (output, end) = io::pipe()?;
    let child = command.stdout(end.try_clone()?).stderr(end).spawn();
    let program = command.get_program().display();
    Ok((
        child.with_context(|| format!("cannot start {program}"))?,
        output,
    ))
}

/// Ends a child, which may also have ended already.
fn kill(child: &mut Child) {
    if child.kill().is_err() || child.wait().is_err() {
        eprintln!("could not end process {}", child.id());
    }
}

/// A simulator listens within milliseconds. On a machine that is busy with a build, or under an
/// emulator, it may take seconds.
const READY_TIME_MAX: Duration = Duration::from_secs(20);

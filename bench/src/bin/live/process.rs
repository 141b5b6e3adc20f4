//! The processes of simulator and clients: start, figures, end.

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::net::SocketAddr;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
use nix::time::{clock_getcpuclockid, clock_gettime};
use nix::unistd::Pid;

/// A child process, which is killed when this value is dropped.
#[derive(Debug)]
pub(crate) struct Process {
    child: Child,
    name: String,
}

impl Process {
    /// Starts the process.
    pub(crate) fn start(command: &mut Command) -> anyhow::Result<Self> {
        let name = command.get_program().display().to_string();
        let child = command
            .spawn()
            .with_context(|| format!("starting {name}"))?;
        Ok(Self { child, name })
    }

    /// Returns the processor time used by all its threads, including ended ones.
    pub(crate) fn cpu_time(&self) -> anyhow::Result<Duration> {
        let clock = clock_getcpuclockid(self.pid()?)?;
        Ok(clock_gettime(clock)?.into())
    }

    /// Returns the highest `SCHED_FIFO` priority of its threads; `None` if all run under the normal
    /// scheduler.
    pub(crate) fn fifo_priority(&self) -> anyhow::Result<Option<u32>> {
        let mut highest = None;
        for thread in fs::read_dir(format!("/proc/{}/task", self.child.id()))? {
            // A thread may end meanwhile.
            if let Ok(stat) = fs::read_to_string(thread?.path().join("stat")) {
                highest = highest.max(fifo_priority(&stat));
            }
        }
        Ok(highest)
    }

    /// Returns the peak memory, `[KiB]`: `VmHWM` of proc_pid_status(5).
    pub(crate) fn memory_max(&self) -> anyhow::Result<u64> {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id()))?;
        memory_max(&status).context("no VmHWM in the status")
    }

    /// Fails if the process has ended.
    pub(crate) fn expect_running(&mut self) -> anyhow::Result<()> {
        match self.child.try_wait()? {
            None => Ok(()),
            Some(status) => bail!("{} has ended: {status}", self.name),
        }
    }

    /// Waits for the end of the process, which must succeed within `time_max`.
    pub(crate) fn finish(mut self, time_max: Duration) -> anyhow::Result<()> {
        let deadline = Instant::now() + time_max;
        while Instant::now() < deadline {
            match self.child.try_wait()? {
                Some(status) if status.success() => return Ok(()),
                Some(status) => bail!("{} failed: {status}", self.name),
                None => std::thread::sleep(POLL),
            }
        }
        bail!("{} did not end within {time_max:?}", self.name)
    }

    fn pid(&self) -> anyhow::Result<Pid> {
        Ok(Pid::from_raw(self.child.id().try_into()?))
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if matches!(self.child.try_wait(), Ok(None)) {
            // An error means that the process has already ended.
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }
}

/// Starts the simulator for the measurement of clients, with real-time priority: a robot's states
/// do not depend on the load of this machine.
pub(crate) fn simulator(program: &Path) -> anyhow::Result<(Process, SocketAddr)> {
    let mut command = under_fifo(SIMULATOR_PRIORITY, program);
    ready(command.args(["--port", "0", "--no-gripper"]))
}

/// Starts a simulator, and returns it with its robot's address when it serves.
pub(crate) fn ready(command: &mut Command) -> anyhow::Result<(Process, SocketAddr)> {
    let mut process = Process::start(command.stdout(Stdio::piped()))?;
    // Stays open, because the program may write more.
    let output = process.child.stdout.as_mut().context("it is piped")?;
    let mut line = String::new();
    BufReader::new(output).read_line(&mut line)?;
    let address = line.trim().rsplit(' ').next().unwrap_or_default();
    let address = address
        .parse()
        .with_context(|| format!("the simulator says {line:?}"))?;
    Ok((process, address))
}

/// Returns the command that runs a program under `SCHED_FIFO`.
pub(crate) fn under_fifo(priority: u32, program: &Path) -> Command {
    let mut command = Command::new("chrt");
    command.args(["--fifo", &priority.to_string()]).arg(program);
    command
}

/// Returns the real-time priority under policy 1: fields 40 and 41 of proc_pid_stat(5), counted
/// after the name in parentheses.
fn fifo_priority(stat: &str) -> Option<u32> {
    let (_, rest) = stat.rsplit_once(')')?;
    let mut fields = rest.split_whitespace().skip(40 - 3);
    let (priority, policy) = (fields.next()?, fields.next()?);
    (policy == "1").then(|| priority.parse().ok())?
}

fn memory_max(status: &str) -> Option<u64> {
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix(" kB")?.parse().ok()
}

const POLL: Duration = Duration::from_millis(20);

/// Below the priorities of the relay and of the client.
const SIMULATOR_PRIORITY: u32 = 10;

#[cfg(test)]
mod tests {
    use super::*;

    fn sleep(seconds: &str) -> Process {
        Process::start(Command::new("sleep").arg(seconds)).unwrap()
    }

    #[test]
    fn priorities_are_read_behind_the_name() {
        let stat = |priority, policy| {
            format!(
                "7 (a) b c) S {} {priority} {policy} 0 0",
                "0 ".repeat(36).trim()
            )
        };
        assert_eq!(fifo_priority(&stat(99, 1)), Some(99));
        assert_eq!(fifo_priority(&stat(0, 0)), None);
        assert_eq!(sleep("1").fifo_priority().unwrap(), None);
    }

    #[test]
    fn memory_is_read_from_the_status() {
        let status = "Name:\tx\nVmPeak:\t  9000 kB\nVmHWM:\t    4711 kB\nVmRSS:\t 815 kB\n";
        assert_eq!(memory_max(status), Some(4711));
        assert!(sleep("1").memory_max().unwrap() > 0);
    }

    #[test]
    fn a_process_that_sleeps_uses_no_processor() {
        let process = sleep("1");
        let before = process.cpu_time().unwrap();
        std::thread::sleep(POLL);
        let used = process.cpu_time().unwrap() - before;
        assert!(used < POLL, "{used:?}");
    }

    #[test]
    fn the_end_of_a_process_is_reported() {
        sleep("0").finish(Duration::from_secs(20)).unwrap();
        let failed = Process::start(&mut Command::new("false")).unwrap();
        let error = failed.finish(Duration::from_secs(20)).unwrap_err();
        assert!(error.to_string().contains("failed"), "{error}");
        let error = sleep("60").finish(POLL).unwrap_err();
        assert!(error.to_string().contains("did not end"), "{error}");
    }
}

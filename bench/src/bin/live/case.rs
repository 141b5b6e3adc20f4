//! The measurement of one client.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use anyhow::bail;
use serde::Serialize;

use crate::process::{Process, simulator};
use crate::relay::Relay;
use crate::stamp;
use crate::trace::Summary;

/// A client that controls the robot.
#[derive(Clone, Debug)]
pub(crate) enum ClientKind {
    /// One receive and one send per state.
    Echo,
    /// A control function of this project.
    Torques,
    /// Target control of this project.
    Targets,
    /// The vendor's control loop, from Python. It always requests `SCHED_FIFO` on its own.
    Vendor {
        /// The Python interpreter with pylibfranka.
        interpreter: PathBuf,
        /// The script, whose arguments are address and seconds.
        script: PathBuf,
    },
}

/// The scheduling that the control thread requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scheduler {
    /// `SCHED_FIFO`, at the highest priority.
    Fifo,
    /// The normal scheduler.
    Normal,
}

/// A client under a scheduler.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    /// The client.
    pub(crate) client: ClientKind,
    /// Its scheduling.
    pub(crate) scheduler: Scheduler,
}

/// The result of a measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Measured {
    /// Summary of the relay's traffic.
    pub(crate) summary: Summary,
    /// Processor time of the client's process, all threads, in percent of one core.
    pub(crate) cpu_percent: f64,
    /// The actual `SCHED_FIFO` priority of its control thread; `None` under the normal scheduler.
    pub(crate) fifo_priority: Option<u32>,
}

impl ClientKind {
    /// The name of the client.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Echo => "echo",
            Self::Torques => "control function",
            Self::Targets => "target control",
            Self::Vendor { .. } => "pylibfranka",
        }
    }
}

impl Case {
    /// The names of client and scheduler.
    pub(crate) fn name(&self) -> String {
        match self.scheduler {
            Scheduler::Fifo => self.client.name().to_owned(),
            Scheduler::Normal => format!("{}, normal", self.client.name()),
        }
    }

    /// Measures the client for `time`, with a separate simulator; the project's programs are in
    /// `programs`.
    pub(crate) fn measure(&self, programs: &Path, time: Duration) -> anyhow::Result<Measured> {
        let (_simulator, robot) = simulator(&programs.join("franka-sim"))?;
        let listen = SocketAddr::new(loopback_address(std::process::id()), PORT);
        let relay = Relay::start(listen, robot)?;
        let seconds = (LEAD + time + LEAD).as_secs();
        let mut client = Process::start(&mut self.command(programs, listen, seconds))?;

        let deadline = Instant::now() + START_TIME_MAX;
        while relay.commands() < SETTLED {
            client.expect_running()?;
            if Instant::now() > deadline {
                bail!("no control within {START_TIME_MAX:?}");
            }
            std::thread::sleep(POLL);
        }
        let (begin, used) = (stamp::now(), client.cpu_time()?);
        let fifo_priority = client.fifo_priority()?;
        std::thread::sleep(time);
        client.expect_running()?;
        let (end, used) = (stamp::now(), client.cpu_time()?.saturating_sub(used));
        client.finish(END_TIME_MAX)?;
        let elapsed = end.saturating_sub(begin);
        Ok(Measured {
            summary: relay.finish()?.summary(begin, end)?,
            cpu_percent: 100.0 * used.as_secs_f64() / elapsed.as_secs_f64(),
            fifo_priority,
        })
    }

    fn command(&self, programs: &Path, robot: SocketAddr, seconds: u64) -> Command {
        let ours = |name: &str| {
            let mut command = Command::new(programs.join("live_client"));
            command.args([name, &robot.to_string()]);
            if self.scheduler == Scheduler::Fifo {
                command.arg("--fifo");
            }
            command
        };
        let mut command = match &self.client {
            ClientKind::Echo => ours("echo"),
            ClientKind::Torques => ours("torques"),
            ClientKind::Targets => ours("targets"),
            ClientKind::Vendor {
                interpreter,
                script,
            } => {
                let mut command = Command::new(interpreter);
                command.arg(script).arg(robot.ip().to_string());
                command
            }
        };
        command.arg(seconds.to_string());
        command
    }
}

/// Returns an address for a relay: the vendor's client uses one fixed port, so each relay needs its
/// own address.
pub(crate) fn loopback_address(process: u32) -> IpAddr {
    // 127.2.x.y: away from 127.0.0.1, where a simulator of the user may listen; y is never 0 or
    // 255.
    let (high, low) = ((process / 254) % 256, process % 254 + 1);
    Ipv4Addr::new(127, 2, high as u8, low as u8).into()
}

/// The port of every FCI server.
pub(crate) const PORT: u16 = 1337;

/// Time of control before and after the measurement.
const LEAD: Duration = Duration::from_secs(2);

/// Number of commands after which a motion has settled: half a second.
const SETTLED: u64 = 500;

/// Time limit, sufficient for the interpreter to load its modules.
const START_TIME_MAX: Duration = Duration::from_secs(20);

/// Time limit, sufficient for target control to stop the arm.
const END_TIME_MAX: Duration = Duration::from_secs(20);

const POLL: Duration = Duration::from_millis(10);

#[cfg(test)]
mod tests {
    use super::*;

    fn line(client: ClientKind, scheduler: Scheduler) -> String {
        let case = Case { client, scheduler };
        let address = SocketAddr::new(loopback_address(254), PORT);
        let command = case.command(Path::new("/bin"), address, 5);
        let words = [command.get_program()].into_iter();
        let words = words.chain(command.get_args()).map(|w| w.to_str().unwrap());
        words.collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn every_client_gets_address_and_duration() {
        let fifo = line(ClientKind::Torques, Scheduler::Fifo);
        assert_eq!(fifo, "/bin/live_client torques 127.2.1.1:1337 --fifo 5");
        let normal = line(ClientKind::Targets, Scheduler::Normal);
        assert_eq!(normal, "/bin/live_client targets 127.2.1.1:1337 5");
        // The vendor's client has a fixed port.
        let vendor = ClientKind::Vendor {
            interpreter: "python".into(),
            script: "script.py".into(),
        };
        let vendor = line(vendor, Scheduler::Fifo);
        assert_eq!(vendor, "python script.py 127.2.1.1 5");
    }
}

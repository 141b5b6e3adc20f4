//! The cost and the punctuality of one simulated arm: a measurement of the simulator.

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use serde::Serialize;

use crate::listener::Listener;
use crate::process::{Process, ready};
use crate::trace::Quantiles;

/// The plant, which computes the arm's motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Plant {
    /// Rigid bodies.
    Rigid,
    /// MuJoCo, with the arm above a table that it does not touch.
    Mujoco,
}

/// The client that is connected to the simulator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ConnectedClient {
    /// No client.
    None,
    /// A client that receives the states, and commands nothing.
    Listener,
    /// Target control of this project, in continuous motion.
    Targets,
}

/// A simulator, and the client that is connected to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SimulatorCase {
    /// Its plant.
    pub(crate) plant: Plant,
    /// Its client.
    pub(crate) client: ConnectedClient,
    /// True if it requests `SCHED_FIFO`.
    pub(crate) realtime: bool,
}

/// The result of a measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct SimulatorCost {
    /// Processor time of the simulator's process, all threads, in percent of one core.
    pub(crate) cpu_percent: f64,
    /// The peak memory, `VmHWM`, in kibibytes.
    pub(crate) memory_kib: u64,
    /// The actual `SCHED_FIFO` priority of its thread; `None` under the normal scheduler.
    pub(crate) fifo_priority: Option<u32>,
    /// The intervals between arrivals of states, if a listener records them.
    pub(crate) state_interval: Option<Quantiles>,
    /// The absolute differences of these intervals from a millisecond.
    pub(crate) state_deviation: Option<Quantiles>,
}

/// The times from the start of the program until a client has its first state, over several starts,
/// in nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Starts {
    /// The number of starts.
    pub(crate) count: u64,
    /// The median.
    pub(crate) p50: u64,
    /// The longest.
    pub(crate) max: u64,
}

impl Plant {
    /// The name of the plant.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Rigid => "rigid",
            Self::Mujoco => "mujoco",
        }
    }

    fn simulator(self, programs: &Path) -> Command {
        let mut command = Command::new(programs.join("franka-sim"));
        command.args(["--port", "0", "--plant", self.name(), "--arm", "ideal"]);
        command
    }

    /// Starts the simulator `count` times.
    pub(crate) fn start(self, programs: &Path, count: u64) -> anyhow::Result<Starts> {
        let start = || {
            let begin = Instant::now();
            let (_simulator, robot) = ready(&mut self.simulator(programs))?;
            let _client = Listener::connect(robot)?;
            Ok(begin.elapsed())
        };
        let mut times = (0..count)
            .map(|_| start())
            .collect::<anyhow::Result<Vec<_>>>()?;
        times.sort_unstable();
        let nanos = |time: Option<&Duration>| time.map_or(0, |time| time.as_nanos() as u64);
        Ok(Starts {
            count,
            p50: nanos(times.get(times.len() / 2)),
            max: nanos(times.last()),
        })
    }
}

impl ConnectedClient {
    /// The name of the client.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Listener => "listener",
            Self::Targets => "target control",
        }
    }
}

impl SimulatorCase {
    /// The name of the case.
    pub(crate) fn name(&self) -> String {
        let scheduler = if self.realtime { ", --realtime" } else { "" };
        let (plant, client) = (self.plant.name(), self.client.name());
        format!("{plant}, {client}{scheduler}")
    }

    /// Starts a simulator and measures it for `time`; the project's programs are in `programs`.
    pub(crate) fn measure(&self, programs: &Path, time: Duration) -> anyhow::Result<SimulatorCost> {
        let mut command = self.plant.simulator(programs);
        if self.realtime {
            command.arg("--realtime");
        }
        let (mut simulator, robot) = ready(&mut command)?;
        let (mut listener, mut client) = (None, None);
        match self.client {
            ConnectedClient::None => {}
            ConnectedClient::Listener => listener = Some(Listener::connect(robot)?),
            ConnectedClient::Targets => {
                let seconds = (LEAD + time + LEAD).as_secs().to_string();
                let mut command = Command::new(programs.join("live_client"));
                command.args(["targets", &robot.to_string(), &seconds]);
                client = Some(Process::start(&mut command)?);
            }
        }
        std::thread::sleep(LEAD);

        let (begin, used) = (Instant::now(), simulator.cpu_time()?);
        let arrivals = match &mut listener {
            Some(listener) => Some(listener.listen(time)?),
            None => {
                std::thread::sleep(time);
                None
            }
        };
        let used = simulator.cpu_time()?.saturating_sub(used);
        let elapsed = begin.elapsed();
        simulator.expect_running()?;
        let (memory_kib, fifo_priority) = (simulator.memory_max()?, simulator.fifo_priority()?);
        if let Some(client) = client {
            // The client fails if its motion fails.
            client.finish(END_TIME_MAX)?;
        }
        let intervals = arrivals.as_deref().map(intervals);
        Ok(SimulatorCost {
            cpu_percent: 100.0 * used.as_secs_f64() / elapsed.as_secs_f64(),
            memory_kib,
            fifo_priority,
            state_interval: intervals.as_ref().map(|all| Quantiles::of(all.clone())),
            state_deviation: intervals.map(|all| {
                let deviations = all.into_iter().map(|interval| interval.abs_diff(PERIOD));
                Quantiles::of(deviations)
            }),
        })
    }
}

/// Returns the intervals between consecutive moments.
fn intervals(moments: &[Duration]) -> Vec<Duration> {
    let gap = |pair: &[Duration]| pair[1].saturating_sub(pair[0]);
    moments.windows(2).map(gap).collect()
}

/// The period of the states.
const PERIOD: Duration = Duration::from_millis(1);

/// Time of control before and after the measurement.
const LEAD: Duration = Duration::from_secs(2);

/// Time limit, sufficient for target control to stop the arm.
const END_TIME_MAX: Duration = Duration::from_secs(20);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_state_makes_a_long_interval_and_a_short_one() {
        let moments = [5000, 6000, 7300, 8000].map(Duration::from_micros);
        let expected = [1000, 1300, 700].map(Duration::from_micros);
        assert_eq!(intervals(&moments), expected);
        assert_eq!(intervals(&moments[..1]), []);
    }

    #[test]
    fn the_plant_is_an_argument_of_the_program() {
        let command = Plant::Mujoco.simulator(Path::new("/bin"));
        assert_eq!(command.get_program(), "/bin/franka-sim");
        let arguments: Vec<_> = command.get_args().collect();
        assert_eq!(
            arguments,
            ["--port", "0", "--plant", "mujoco", "--arm", "ideal"]
        );
    }
}

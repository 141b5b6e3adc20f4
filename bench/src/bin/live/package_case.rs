//! The measurement of one Python package in one case: the report of its adapter, and the relay's
//! traffic.

use std::fs::{self, File};
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use anyhow::{Context as _, ensure};
use serde_json::{Map, Value, json};

use crate::case::{PORT, loopback_address};
use crate::process::{Process, ready};
use crate::relay::Relay;
use crate::trace::Trace;

/// A measured package.
#[derive(Debug)]
pub(crate) struct Package {
    /// Its distribution.
    pub(crate) name: &'static str,
    /// The module that programs import.
    module: &'static str,
    /// The file with its adapter.
    adapter: &'static str,
}

/// The paths of the programs and adapters.
#[derive(Debug)]
pub(crate) struct Places<'a> {
    /// Directory of the project's programs.
    pub(crate) programs: &'a Path,
    /// An interpreter that has the packages.
    pub(crate) interpreter: &'a Path,
    /// Directory of the adapters.
    pub(crate) adapters: &'a Path,
    /// Directory for the output of the adapters, one file per case.
    pub(crate) output: &'a Path,
}

impl Package {
    /// Returns the installed version and the import times, or the reason why it cannot be imported.
    pub(crate) fn import(&self, places: &Places<'_>) -> Result<Value, String> {
        let Self { name, module, .. } = self;
        let program = format!(
            "import time; begin = time.perf_counter(); import {module}; \
             took = time.perf_counter() - begin; import importlib.metadata as packages; \
             print(took, packages.version('{name}'))"
        );
        let mut took = Vec::new();
        let mut version = String::new();
        for _ in 0..IMPORTS {
            let mut command = Command::new(places.interpreter);
            let output = command.args(["-c", &program]).output();
            let output = output.map_err(|error| error.to_string())?;
            let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
            if !output.status.success() {
                let errors = text(&output.stderr);
                return Err(errors
                    .lines()
                    .last()
                    .unwrap_or("it cannot be imported")
                    .to_owned());
            }
            let printed = text(&output.stdout);
            let line = printed.lines().last().unwrap_or_default();
            let (seconds, number) = line.split_once(' ').unwrap_or((line, ""));
            took.push(
                seconds
                    .parse::<f64>()
                    .map_err(|_| format!("it printed {line:?}"))?,
            );
            number.clone_into(&mut version);
        }
        took.sort_by(f64::total_cmp);
        Ok(json!({ "version": version, "import_ms": took[IMPORTS / 2] * 1e3 }))
    }

    /// Runs a case with a separate simulator. Returns the results of each of its steps.
    ///
    /// # Errors
    /// If the simulator or the adapter cannot be started; failures in the adapter are part of the
    /// result.
    pub(crate) fn measure(
        &self,
        places: &Places<'_>,
        case: &str,
    ) -> anyhow::Result<Map<String, Value>> {
        let process = std::process::id();
        let hand = robot_address(process);
        let mut simulator = Command::new(places.programs.join("franka-sim"));
        simulator.args(["--robot", "fr3", "--hand", "--realtime", "--port"]);
        simulator.args([&PORT.to_string(), "--bind", &hand.to_string()]);
        simulator.stderr(Stdio::null());
        let (_simulator, robot) = ready(&mut simulator)?;
        let listen = SocketAddr::new(loopback_address(process), PORT);
        let relay = Relay::start(listen, robot)?;

        let file = |kind| places.output.join(format!("{}-{case}.{kind}", self.module));
        let create = |kind| File::create(file(kind)).context("for what an adapter prints");
        let mut adapter = Command::new(places.interpreter);
        adapter.arg(places.adapters.join(self.adapter)).arg(case);
        adapter.args([listen.ip().to_string(), hand.to_string()]);
        adapter.stdout(create("jsonl")?).stderr(create("log")?);
        let ended = Process::start(&mut adapter)?.finish(CASE_TIME_MAX);
        let mut steps = steps(&fs::read_to_string(file("jsonl"))?, &relay.finish()?)?;
        if let Err(error) = ended {
            steps.insert(case.to_owned(), json!({ "failed": format!("{error:#}") }));
        }
        Ok(steps)
    }
}

/// Returns the results of each step from the lines of an adapter and the trace.
fn steps(lines: &str, trace: &Trace) -> anyhow::Result<Map<String, Value>> {
    let mut steps = Map::new();
    for line in lines.lines() {
        let mut content: Map<String, Value> =
            serde_json::from_str(line).with_context(|| format!("an adapter printed {line:?}"))?;
        let step = content.remove("step").unwrap_or_default();
        let step = step
            .as_str()
            .with_context(|| format!("no step in {line:?}"))?;
        if let Some(window) = content.remove("window") {
            let [begin, end] = serde_json::from_value::<[f64; 2]>(window)?;
            ensure!(begin <= end, "the window ends before it begins: {line:?}");
            let [begin, end] = [begin, end].map(Duration::from_secs_f64);
            content.insert("commands".to_owned(), json!(trace.punctuality(begin, end)));
            // Without an answer there is no turnaround.
            if let Ok(summary) = trace.summary(begin, end) {
                content.insert("turnaround".to_owned(), json!(summary.turnaround));
            }
        }
        // A step that failed after its measurement keeps both.
        let known = steps.entry(step).or_insert_with(|| json!({}));
        let known = known.as_object_mut().context("only objects are inserted")?;
        known.append(&mut content);
    }
    Ok(steps)
}

/// Returns the address of the simulator, whose gripper has the port after the robot's.
fn robot_address(process: u32) -> IpAddr {
    // 127.4.x.y, where no relay listens.
    match loopback_address(process) {
        IpAddr::V4(address) => {
            let [_, _, high, low] = address.octets();
            Ipv4Addr::new(127, 4, high, low).into()
        }
        IpAddr::V6(address) => address.into(),
    }
}

/// Our package, and the packages compared with it.
pub(crate) const PACKAGES: [Package; 5] = [
    Package {
        name: "franka-async",
        module: "franka_async",
        adapter: "with_franka_async.py",
    },
    Package {
        name: "franka-rs",
        module: "franka",
        adapter: "with_franka_rs.py",
    },
    Package {
        name: "pylibfranka",
        module: "pylibfranka",
        adapter: "with_pylibfranka.py",
    },
    Package {
        name: "franky-control",
        module: "franky",
        adapter: "with_franky.py",
    },
    Package {
        name: "aiofranka",
        module: "aiofranka",
        adapter: "with_aiofranka.py",
    },
];

/// The cases of an adapter, each with its own process.
pub(crate) const CASES: [&str; 7] = [
    "hand",
    "robot",
    "active",
    "law",
    "event_loop",
    "interpreter",
    "threads",
];

/// Number of imports of each package; odd, for the median.
const IMPORTS: usize = 5;

/// Time limit, longer than any case on a busy machine, including compilation of a law.
const CASE_TIME_MAX: Duration = Duration::from_secs(60);

#[cfg(test)]
mod tests {
    use franka_proto::RobotMode;

    use crate::trace::{CommandArrival, Departure};

    use super::*;

    #[test]
    fn a_window_is_completed_by_what_passed_the_relay() {
        let millis = |number| Duration::from_millis(number);
        let numbers = 1..=10;
        let trace = Trace {
            departures: numbers
                .clone()
                .map(|id| Departure {
                    id,
                    left: millis(id),
                    success_rate: 1.0,
                    mode: RobotMode::Move,
                })
                .collect(),
            answers: numbers
                .filter(|id| *id != 5)
                .map(|id| CommandArrival {
                    id,
                    arrived: millis(id) + Duration::from_micros(100),
                })
                .collect(),
        };
        let lines = r#"{"step": "idle", "values": {"ticks": 9}}
{"step": "law", "window": [0.0025, 0.0085]}
{"step": "law", "failed": "late"}"#;
        let steps = steps(lines, &trace).unwrap();
        assert_eq!(steps["idle"]["values"]["ticks"], 9);
        assert_eq!(steps["law"]["failed"], "late");
        let commands = json!({ "states": 6, "late": 1, "reflex": false });
        assert_eq!(steps["law"]["commands"], commands);
        let p50 = steps["law"]["turnaround"]["p50"].as_u64().unwrap();
        assert!(p50.abs_diff(100_000) < 200, "{p50}");
    }

    #[test]
    fn malformed_step_report_is_an_error() {
        for line in ["Moving", "{}", r#"{"step": "x", "window": [2, 1]}"#] {
            assert!(steps(line, &Trace::default()).is_err(), "{line}");
        }
    }
}

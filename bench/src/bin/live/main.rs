//! Measures over real sockets: clients against the simulator, the simulator itself, or the control
//! thread next to a busy program.
//!
//! `live clients OUTPUT.json [--seconds N] [--python INTERPRETER SCRIPT]`:
//!
//! ```text
//!  franka-sim  --state-->  relay  --state, departure noted------------->  client
//!              <-command-         <-command, stamped by the kernel-----   (a process of its own)
//! ```
//!
//! `live simulator OUTPUT.json [--seconds N] [--mujoco]`:
//!
//! ```text
//!  franka-sim  --state, stamped by the kernel-->  listener
//!  (a process of its own: time to start, processor time, memory)
//! ```
//!
//! `live packages OUTPUT.json --python INTERPRETER --adapters DIRECTORY`: the packages for Python,
//! each in a few cases, with the same relay.
//!
//! `live starvation [--seconds N]`: see [`starvation`].
//!
//! `live recorder DIRECTORY [--seconds N]`: see [`recorder`].
//!
//! `live dashboard [--seconds N]`: see [`dashboard`].
//!
//! | module | content |
//! |---|---|
//! | [`relay`] | between client and robot, records the traffic and its times |
//! | [`listener`] | a client that records the arrival times of states |
//! | [`stamp`] | datagrams with the kernel's arrival time |
//! | [`trace`] | the traffic and its statistics |
//! | [`process`] | the processes of simulator and clients |
//! | [`case`] | the measurement of one client |
//! | [`simulator_case`] | the measurement of one simulator |
//! | [`report`] | the tables, and the JSON |
//! | [`package_case`] | the measurement of one package for Python |
//! | [`package_report`] | the table of the packages |
//! | [`recorder`] | the effect of a recorder on the control thread |
//! | [`dashboard`], [`viewers`] | the effect of a dashboard and its viewers on the control thread |
//! | [`turn`] | cycles without and with another load |
//! | [`starvation`] | the effect of blocked runtime workers |

mod case;
mod dashboard;
mod listener;
mod package_case;
mod package_report;
mod process;
mod recorder;
mod relay;
mod report;
mod simulator_case;
mod stamp;
mod starvation;
mod trace;
mod turn;
mod viewers;

use std::fs;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use anyhow::Context as _;
use clap::{Args, Parser, Subcommand, value_parser};
use serde_json::Value;

use case::{Case, ClientKind, Scheduler};
use package_case::{CASES, PACKAGES, Places};
use simulator_case::{ConnectedClient, Plant, SimulatorCase};

/// Measures over real sockets.
#[derive(Debug, Parser)]
struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Clients against the simulator.
    Clients {
        #[command(flatten)]
        common: Common,
        /// Measure pylibfranka too: the interpreter with that package, and the script to run.
        #[arg(long, num_args = 2, value_names = ["INTERPRETER", "SCRIPT"])]
        python: Option<Vec<PathBuf>>,
    },
    /// Cost and punctuality of one simulated arm.
    Simulator {
        #[command(flatten)]
        common: Common,
        /// Measure the MuJoCo plant too; the simulator must be built with it.
        #[arg(long)]
        mujoco: bool,
    },
    /// Packages for Python.
    Packages {
        /// File for the values; the output of each adapter is in a directory next to it.
        output: PathBuf,
        /// An interpreter that has the packages.
        #[arg(long)]
        python: PathBuf,
        /// Directory of the adapters.
        #[arg(long)]
        adapters: PathBuf,
        /// Measure these packages only.
        #[arg(long)]
        only: Vec<String>,
    },
    /// Effect of blocked runtime workers on the control thread, and on a task in its place.
    Starvation {
        /// Duration of each case.
        #[arg(long, default_value_t = 10, value_parser = value_parser!(u32).range(1..))]
        seconds: u32,
    },
    /// Effect of a recorder on the control thread, alternately with and without a recorder.
    Recorder {
        /// Directory for the recordings.
        directory: PathBuf,
        /// Duration with a recorder; the same without.
        #[arg(long, default_value_t = 60, value_parser = value_parser!(u32).range(1..))]
        seconds: u32,
    },
    /// Effect of a dashboard with viewers on the control thread, alternately with and without
    /// viewers.
    Dashboard {
        /// Duration with viewers; the same without.
        #[arg(long, default_value_t = 60, value_parser = value_parser!(u32).range(1..))]
        seconds: u32,
    },
    /// Viewers of a dashboard, until the standard input ends.
    #[command(hide = true)]
    Viewers {
        /// Address of the page.
        address: SocketAddr,
    },
}

#[derive(Debug, Args)]
struct Common {
    /// File for the values.
    output: PathBuf,
    /// Duration of each case.
    #[arg(long, default_value_t = 30)]
    seconds: u32,
}

impl Common {
    fn time(&self) -> Duration {
        Duration::from_secs(self.seconds.into())
    }

    fn write(&self, values: &Value) -> anyhow::Result<()> {
        write(&self.output, values)
    }
}

fn write(output: &Path, values: &Value) -> anyhow::Result<()> {
    let json = serde_json::to_string_pretty(values)?;
    fs::write(output, json + "\n").with_context(|| format!("writing {}", output.display()))?;
    println!("written to {}", output.display());
    Ok(())
}

fn main() -> ExitCode {
    match run(Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: Arguments) -> anyhow::Result<()> {
    let programs = std::env::current_exe()?;
    let programs = programs.parent().context("this program is somewhere")?;
    match arguments.what {
        What::Clients { common, python } => measure_clients(programs, &common, python.as_deref()),
        What::Simulator { common, mujoco } => measure_simulator(programs, &common, mujoco),
        What::Packages {
            output,
            python,
            adapters,
            only,
        } => {
            let places = Places {
                programs,
                interpreter: &python,
                adapters: &adapters,
                output: &output.with_extension(""),
            };
            measure_packages(&places, &output, &only)
        }
        What::Starvation { seconds } => {
            starvation::print(seconds);
            Ok(())
        }
        What::Recorder { directory, seconds } => {
            recorder::print(&programs.join("franka-sim"), &directory, seconds)
        }
        What::Dashboard { seconds } => dashboard::print(programs, seconds),
        What::Viewers { address } => viewers::run(address),
    }
}

fn measure_clients(
    programs: &Path,
    common: &Common,
    python: Option<&[PathBuf]>,
) -> anyhow::Result<()> {
    let time = common.time();
    let ours = [ClientKind::Echo, ClientKind::Torques, ClientKind::Targets];
    let with = |scheduler| ours.clone().map(|client| Case { client, scheduler });
    let mut cases = Vec::from(with(Scheduler::Fifo));
    if let Some([interpreter, script]) = python {
        cases.push(Case {
            client: ClientKind::Vendor {
                interpreter: interpreter.clone(),
                script: script.clone(),
            },
            scheduler: Scheduler::Fifo,
        });
    }
    cases.extend(with(Scheduler::Normal));
    let mut results = Vec::new();
    for case in cases {
        eprintln!("measuring {} for {time:?}", case.name());
        let result = case.measure(programs, time);
        results.push((case, result));
    }
    println!("{}", report::markdown(&results, time));
    common.write(&report::json(&results, time))?;
    let failed = results.iter().filter(|(_, result)| result.is_err()).count();
    anyhow::ensure!(failed == 0, "{failed} of {} clients failed", results.len());
    Ok(())
}

fn measure_simulator(programs: &Path, common: &Common, mujoco: bool) -> anyhow::Result<()> {
    let time = common.time();
    let mut starts = Vec::new();
    let mut cases = Vec::new();
    for plant in [Plant::Rigid, Plant::Mujoco] {
        if plant == Plant::Mujoco && !mujoco {
            continue;
        }
        eprintln!("starting {} {STARTS} times", plant.name());
        starts.push((plant, plant.start(programs, STARTS)?));
        for (client, realtime) in [
            (ConnectedClient::None, false),
            (ConnectedClient::Listener, false),
            (ConnectedClient::Listener, true),
            (ConnectedClient::Targets, false),
        ] {
            let case = SimulatorCase {
                plant,
                client,
                realtime,
            };
            eprintln!("measuring {} for {time:?}", case.name());
            cases.push((case, case.measure(programs, time)?));
        }
    }
    println!("{}", report::simulator_markdown(&starts, &cases, time));
    common.write(&report::simulator_json(&starts, &cases, time))
}

fn measure_packages(places: &Places<'_>, output: &Path, only: &[String]) -> anyhow::Result<()> {
    fs::create_dir_all(places.output)?;
    let mut rows = Vec::new();
    for package in &PACKAGES {
        let name = package.name;
        if !only.is_empty() && !only.iter().any(|wanted| wanted == name) {
            continue;
        }
        eprintln!("measuring {name}");
        let row = match package.import(places) {
            Err(why) => serde_json::json!({ "package": name, "absent": why }),
            Ok(mut row) => {
                let mut steps = serde_json::Map::new();
                for case in CASES {
                    steps.append(&mut package.measure(places, case)?);
                }
                row["package"] = name.into();
                row["steps"] = steps.into();
                row
            }
        };
        rows.push(row);
    }
    let machine = report::machine();
    println!("{machine}\n\n{}", package_report::markdown(&rows));
    write(
        output,
        &serde_json::json!({ "machine": machine, "packages": rows }),
    )
}

/// Number of starts of the simulator.
const STARTS: u64 = 20;

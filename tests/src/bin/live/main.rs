//! Measures clients against the simulator over real sockets: `live --seconds N OUTPUT.json [--python INTERPRETER SCRIPT]`.
//!
//! ```text
//!  franka-sim  --state-->  relay  --state, departure noted------------->  client
//!              <-command-         <-command, stamped by the kernel-----   (a process of its own)
//! ```
//!
//! | module | what it is |
//! |---|---|
//! | [`relay`] | between client and robot, noting what passes and when |
//! | [`stamp`] | datagrams with the kernel's time of arrival |
//! | [`trace`] | what passed, and the numbers that come of it |
//! | [`process`] | simulator and clients: started, watched, ended |
//! | [`case`] | one client measured |
//! | [`report`] | the table, and the JSON |

mod case;
mod process;
mod relay;
mod report;
mod stamp;
mod trace;

use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use anyhow::Context as _;
use clap::Parser;

use case::{Case, Client, Scheduler};

/// Measures clients against the simulator over real sockets.
#[derive(Debug, Parser)]
struct Arguments {
    /// Where to write the values.
    output: PathBuf,
    /// How long to measure each client.
    #[arg(long, default_value_t = 30)]
    seconds: u32,
    /// Measure pylibfranka too: the interpreter that has it, and the script to run.
    #[arg(long, num_args = 2, value_names = ["INTERPRETER", "SCRIPT"])]
    python: Option<Vec<PathBuf>>,
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
    let time = Duration::from_secs(arguments.seconds.into());
    let ours = [Client::Echo, Client::Torques, Client::Targets];
    let with = |scheduler| ours.clone().map(|client| Case { client, scheduler });
    let mut cases = Vec::from(with(Scheduler::Fifo));
    if let Some([interpreter, script]) = arguments.python.as_deref() {
        cases.push(Case {
            client: Client::Vendor {
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
    let json = serde_json::to_string_pretty(&report::json(&results, time))?;
    fs::write(&arguments.output, json + "\n")
        .with_context(|| format!("writing {}", arguments.output.display()))?;
    println!("written to {}", arguments.output.display());
    let failed = results.iter().filter(|(_, result)| result.is_err()).count();
    anyhow::ensure!(failed == 0, "{failed} of {} clients failed", results.len());
    Ok(())
}

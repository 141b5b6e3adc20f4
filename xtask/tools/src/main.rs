//! The tasks of this workspace except its tests: `cargo xtask help` lists them.

mod book;
mod checks;
mod circles;
mod commands;
mod cross;
mod dashboard;
mod dist;
mod fuzz;
mod live;
mod members;
mod metadata;
mod mujoco;
mod names;
mod others;
mod package;
mod page;
mod peer_pages;
mod playground;
mod prose;
mod recordings;
mod reference_pages;
mod release;
mod schemas;
mod texts;
mod tidy;
mod tools;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::checks::{Check, Nightly};
use crate::metadata::measuring_program;
use xtask::workspace::Workspace;

/// One-command tasks of this workspace.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Run the checks that a change must pass in addition to the tests, and stop at the first
    /// failure.
    Check {
        /// Run only these steps (may be repeated or separated by commas).
        #[arg(long, value_enum, value_delimiter = ',')]
        only: Vec<Check>,
    },
    /// Run the slow checks, and stop at the first failure.
    Nightly {
        /// Run only these steps (may be repeated or separated by commas).
        #[arg(long, value_enum, value_delimiter = ',')]
        only: Vec<Nightly>,
    },
    /// List the texts that break the rules of the step `prose`.
    Prose {
        /// Files and folders; everything by default.
        paths: Vec<PathBuf>,
        /// Lower the numbers in the baseline to the current ones.
        #[arg(long, conflicts_with = "paths")]
        lower: bool,
    },
    /// Rewrite the Rust code of the messages of recordings.
    Schemas,
    /// Check the crates against golden vectors and print a line per file.
    Vectors {
        /// Directory of the vectors [default: the project's].
        dir: Option<PathBuf>,
    },
    /// Run the fuzz targets and print a line per target.
    Fuzz {
        /// Executions of each target.
        #[arg(long, default_value_t = 10_000_000)]
        runs: u64,
    },
    /// Measure the work of one control cycle and write `target/bench.json`.
    ///
    /// With --live: measure clients against the simulator over real sockets, and write
    /// `target/bench_live.json`. With --sim: measure the cost of one simulated arm, and write
    /// `target/bench_sim.json`. With --python: measure the package for Python together with others,
    /// and write `target/bench_python.json`.
    Bench {
        /// Rounds; each runs every benchmark once.
        #[arg(long, default_value_t = 15)]
        rounds: usize,
        /// Count the instructions of the model's calls instead; needs valgrind.
        #[arg(long, conflicts_with = "live")]
        instructions: bool,
        /// Measure over real sockets instead; nothing else should run meanwhile.
        #[arg(long, group = "sockets")]
        live: bool,
        /// Measure the cost of a busy program for the control thread, and for a task in its place.
        #[arg(long, conflicts_with_all = ["live", "instructions"])]
        starvation: bool,
        /// Measure start-up time, processor time, memory and punctuality of the simulator; nothing
        /// else should run meanwhile.
        #[arg(long, group = "sockets", conflicts_with_all = ["instructions", "starvation"])]
        sim: bool,
        /// Measure the package for Python and others against the simulator; nothing else should run
        /// meanwhile.
        #[arg(long, conflicts_with_all = ["sockets", "instructions", "starvation"])]
        python: bool,
        /// Measure the cost of a recorder for the control thread, alternately with and without one;
        /// nothing else should run meanwhile.
        #[arg(long, group = "sockets", conflicts_with_all = ["instructions", "starvation"])]
        recorder: bool,
        /// Measure the cost of a dashboard for the control thread, with ten viewers and with a
        /// viewer that never reads, alternately with and without viewers; nothing else should run
        /// meanwhile.
        #[arg(long, group = "sockets", conflicts_with_all = ["instructions", "starvation"])]
        dash: bool,
        /// Duration of each case of --live, --sim, --recorder and --dash, in seconds.
        #[arg(long, default_value_t = 30, requires = "sockets")]
        seconds: u32,
    },
    /// Measure target control on realistic simulated arms, and write `target/arms.json`.
    ///
    /// Arguments: --family ideal|nominal|realistic|bad|FILE.json, --arms N, --seed S, --robot
    /// fr3|fer; --help lists the others.
    #[command(disable_help_flag = true)]
    Arms {
        /// Arguments of the measuring program.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Build the wheels of the Python package for every platform that this machine can build for,
    /// with the oldest supported C library, and import those that can run here.
    Wheels {
        /// Build only for these targets (may be repeated or separated by commas).
        #[arg(long, value_delimiter = ',')]
        only: Vec<String>,
    },
    /// Rebuild the files of the dashboard's page, from npm packages that are pinned by hash.
    Assets {
        /// Only check that the files are up to date.
        #[arg(long)]
        check: bool,
    },
    /// Build the program `franka` for machines without other software: static for x86-64 and 64-bit
    /// Arm, and for C libraries from 2.17 on. Measures the builds, moves a simulated robot with
    /// each, under qemu if necessary, and packs them in `target/artefacts`: archives, packages for
    /// Debian, a container image, bills of materials, checksums.
    Dist {
        /// Build only for these targets (may be repeated or separated by commas).
        #[arg(long, value_delimiter = ',')]
        only: Vec<String>,
        /// Build everything twice, and compare the results.
        #[arg(long)]
        twice: bool,
        /// Use the program for this machine, the packages of the crates and the wheel, outside the
        /// repository.
        #[arg(long = "try")]
        trial: bool,
    },
    /// Build the book with the references of Rust and Python and its playground, and serve it.
    Book {
        /// Port on this computer.
        #[arg(long, default_value_t = 3000)]
        port: u16,
        /// Build the book in `target/book`, and do not serve it.
        #[arg(long, conflicts_with = "port")]
        build_only: bool,
    },
    /// Redraw the pictures of the book and the README, from this code and simulated motions; the
    /// README's is a film of the dashboard, which requires a browser.
    Pictures,
    /// Fetch the native library that the simulator's feature `mujoco` links to.
    Mujoco,
    /// Check the requirements of a release: the crates' metadata, their packages, one version
    /// everywhere, the change log. Nothing is published.
    ReleaseCheck {
        /// Build every crate from its package, against the packages of the others.
        #[arg(long)]
        verify: bool,
        /// Report what is still missing to publish this version.
        #[arg(long = "final")]
        last: bool,
    },
}

/// The tasks, each with the names of its options; no options for a task that passes its arguments
/// on. `test` is a task of the package `xtask` itself.
fn tasks() -> Vec<(String, Vec<String>)> {
    let options = |task: &clap::Command| {
        let passes_on = task.get_arguments().any(clap::Arg::is_trailing_var_arg_set);
        let options = task.get_arguments().filter_map(clap::Arg::get_long);
        match passes_on {
            true => Vec::new(),
            false => options.map(str::to_owned).collect(),
        }
    };
    let arguments = <Arguments as clap::CommandFactory>::command();
    let tasks = arguments.get_subcommands();
    let tasks = tasks.map(|task| (task.get_name().to_owned(), options(task)));
    let test = ("test".to_owned(), vec!["only".to_owned()]);
    tasks.chain([test]).collect()
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(arguments.task) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("\nerror: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(task: Task) -> anyhow::Result<()> {
    let workspace = Workspace::find()?;
    match task {
        Task::Check { only } => checks::run(&workspace, &only),
        Task::Nightly { only } => checks::run(&workspace, &only),
        Task::Prose { paths, lower } => prose::run(&workspace, &paths, lower),
        Task::Schemas => schemas::write(&workspace),
        Task::Vectors { dir } => {
            // The program runs in the root of the workspace, but the argument is relative to the
            // user's directory.
            let dir = dir.map(std::path::absolute).transpose()?;
            workspace.run(measuring_program(&workspace, &[], "vectors").args(dir))
        }
        Task::Fuzz { runs } => fuzz::run(&workspace, runs),
        Task::Bench {
            instructions: true, ..
        } => workspace.run(&mut measuring_program(&workspace, &[], "instructions")),
        Task::Bench {
            live: true,
            seconds,
            ..
        } => live::run(&workspace, seconds),
        Task::Bench {
            sim: true, seconds, ..
        } => live::run_simulator(&workspace, seconds),
        Task::Bench {
            recorder: true,
            seconds,
            ..
        } => live::run_beside(&workspace, "recorder", seconds),
        Task::Bench {
            dash: true,
            seconds,
            ..
        } => live::run_beside(&workspace, "dashboard", seconds),
        Task::Bench { python: true, .. } => live::run_python(&workspace),
        Task::Bench {
            starvation: true, ..
        } => workspace.run(measuring_program(&workspace, &[], "live").arg("starvation")),
        Task::Bench { rounds, .. } => {
            let output = workspace.target().join("bench.json");
            // Without MuJoCo its row is missing.
            let features = match mujoco::provide(&workspace)? {
                Ok(()) => &["mujoco"][..],
                Err(why) => {
                    println!("the MuJoCo plant is not measured: {why}");
                    &[]
                }
            };
            let mut command = measuring_program(&workspace, features, "bench");
            command.arg(&output).arg(rounds.to_string());
            workspace.run(&mut command)
        }
        Task::Arms { arguments } => {
            let mut command = measuring_program(&workspace, &[], "arms");
            command.args(arguments);
            command.arg(workspace.target().join("arms.json"));
            workspace.run(&mut command)
        }
        Task::Wheels { only } => package::wheels::run(&workspace, &only),
        Task::Assets { check: false } => dashboard::assets(&workspace),
        Task::Assets { check: true } => {
            let outcome = dashboard::check_assets(&workspace)?;
            println!("{outcome:?}");
            Ok(())
        }
        Task::Dist { only, twice, trial } => {
            dist::run(&workspace, &only, dist::Depth { twice, trial })
        }
        Task::Book { port, build_only } => book::serve(&workspace, (!build_only).then_some(port)),
        Task::Pictures => {
            workspace.run(&mut measuring_program(&workspace, &[], "pictures"))?;
            println!("{:?}", dashboard::film(&workspace)?);
            Ok(())
        }
        Task::Mujoco => mujoco::provide(&workspace)?.map_err(anyhow::Error::msg),
        Task::ReleaseCheck { verify, last } => {
            let outcome = release::check(&workspace, release::Depth { verify, last })?;
            println!("{outcome:?}");
            Ok(())
        }
    }
}

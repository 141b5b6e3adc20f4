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
mod metadata;
mod mujoco;
mod names;
mod others;
mod package;
mod page;
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

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Parser, Subcommand};

use crate::checks::{CHECK, NIGHTLY};
use crate::live::Subject;
use crate::metadata::measuring_program;
use xtask::step::{self, Outcome, Step};
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
        #[arg(long, value_delimiter = ',', value_parser = names(CHECK))]
        only: Vec<String>,
    },
    /// Run the slow checks, and stop at the first failure.
    Nightly {
        /// Run only these steps (may be repeated or separated by commas).
        #[arg(long, value_delimiter = ',', value_parser = names(NIGHTLY))]
        only: Vec<String>,
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
    /// Measure, and write `target/bench.json` or another file; nothing else should run meanwhile.
    Bench {
        #[arg(value_enum, default_value_t)]
        subject: Subject,
        /// Rounds of `cycle`; each runs every benchmark once.
        #[arg(long, default_value_t = 15)]
        rounds: usize,
        /// Duration of each case over real sockets, in seconds.
        #[arg(long, default_value_t = 30)]
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
    /// Arm, and for C libraries from 2.17 on. Moves a simulated robot with each, under qemu if
    /// necessary, and packs them in `target/artefacts`: archives, packages for Debian, bills of
    /// materials, checksums.
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

/// The names of steps, with their descriptions.
fn names(steps: &[Step]) -> PossibleValuesParser {
    let value = |step: &Step| PossibleValue::new(step.name).help(step.about);
    steps.iter().map(value).collect::<Vec<_>>().into()
}

/// The reason if the words after `cargo xtask` are no task.
fn fault_of_task(words: &[&str]) -> Option<String> {
    let words = ["cargo xtask"].iter().chain(words);
    let error = Arguments::try_parse_from(words).err()?;
    Some(error.to_string().lines().next()?.to_owned())
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
        Task::Check { only } => step::run(&workspace, CHECK, &only),
        Task::Nightly { only } => step::run(&workspace, NIGHTLY, &only),
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
            subject,
            rounds,
            seconds,
        } => live::run(&workspace, subject, rounds, seconds),
        Task::Arms { arguments } => {
            let mut command = measuring_program(&workspace, &[], "arms");
            command.args(arguments);
            command.arg(workspace.target().join("arms.json"));
            workspace.run(&mut command)
        }
        Task::Wheels { only } => package::wheels::run(&workspace, &only),
        Task::Assets { check: false } => dashboard::assets(&workspace),
        Task::Assets { check: true } => report(dashboard::check_assets(&workspace)),
        Task::Dist { only, twice, trial } => {
            dist::run(&workspace, &only, dist::Depth { twice, trial })
        }
        Task::Book { port, build_only } => book::serve(&workspace, (!build_only).then_some(port)),
        Task::Pictures => {
            workspace.run(&mut measuring_program(&workspace, &[], "pictures"))?;
            report(dashboard::film(&workspace))
        }
        Task::Mujoco => mujoco::provide(&workspace),
        Task::ReleaseCheck { verify, last } => {
            report(release::check(&workspace, release::Depth { verify, last }))
        }
    }
}

/// Prints the outcome of work that is not a step.
fn report(outcome: anyhow::Result<Outcome>) -> anyhow::Result<()> {
    outcome.map(|outcome| println!("{outcome:?}"))
}

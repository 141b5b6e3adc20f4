//! Measurements of a control cycle, of clients against the simulator over real sockets, and of the
//! simulator.

use clap::ValueEnum;

use crate::metadata::measuring_program;
use crate::{mujoco, package};
use xtask::peers;
use xtask::step::or_missing;
use xtask::workspace::Workspace;

/// The subject of a measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Subject {
    /// The work of one control cycle.
    #[default]
    Cycle,
    /// The instructions of the model's calls; needs valgrind.
    Instructions,
    /// Clients against the simulator over real sockets: `target/bench_live.json`.
    Live,
    /// Start-up time, processor time, memory and punctuality of the simulator:
    /// `target/bench_sim.json`.
    Sim,
    /// The package for Python together with others: `target/bench_python.json`.
    Python,
    /// The cost of a busy program for the control thread, and for a task in its place.
    Starvation,
    /// The cost of a recorder for the control thread, alternately with and without one.
    Recorder,
    /// The cost of a dashboard for the control thread, with ten viewers and with a viewer that
    /// never reads, alternately with and without viewers.
    Dash,
}

/// Builds the programs that measure, and runs them.
pub(crate) fn run(
    workspace: &Workspace,
    subject: Subject,
    rounds: usize,
    seconds: u32,
) -> anyhow::Result<()> {
    if subject == Subject::Instructions {
        return workspace.run(&mut measuring_program(workspace, &[], "instructions"));
    }
    let mut features: &[&str] = &[];
    if matches!(subject, Subject::Cycle | Subject::Sim) {
        match or_missing(mujoco::provide(workspace))? {
            Ok(()) => features = &["mujoco"],
            Err(why) => println!("the MuJoCo plant is NOT MEASURED: {why}"),
        }
    }
    let target = workspace.target();
    if subject == Subject::Cycle {
        let mut measure = measuring_program(workspace, features, "bench");
        measure.arg(target.join("bench.json"));
        return workspace.run(measure.arg(rounds.to_string()));
    }
    let mut build = workspace.cargo();
    build.args(["build", "--profile", "dist", "--package", "franka-sim"]);
    build.args(["--package", "franka-bench", "--bins", "--features"]);
    workspace.run(build.arg(features.join(",")))?;
    let mut measure = workspace.program(target.join("dist").join("live"));
    match subject {
        Subject::Cycle | Subject::Instructions => unreachable!("they have other programs"),
        Subject::Live => {
            measure.arg("clients").arg(target.join("bench_live.json"));
            match or_missing(peers::interpreter(workspace))? {
                Ok(interpreter) => {
                    let script = peers::directory(workspace).join("pylibfranka_torques.py");
                    measure.arg("--python").arg(interpreter).arg(script);
                }
                Err(why) => println!("pylibfranka is NOT MEASURED: {why}"),
            }
        }
        Subject::Sim => {
            measure.arg("simulator").arg(target.join("bench_sim.json"));
            measure.args((!features.is_empty()).then_some("--mujoco"));
        }
        Subject::Python => {
            measure
                .arg("packages")
                .arg(target.join("bench_python.json"));
            measure
                .arg("--python")
                .arg(package::prepare_bench(workspace)?);
            let adapters = package::directory(workspace).join("bench");
            measure.arg("--adapters").arg(adapters);
        }
        Subject::Starvation => _ = measure.arg("starvation"),
        Subject::Recorder => _ = measure.arg("recorder").arg(target),
        Subject::Dash => _ = measure.arg("dashboard"),
    }
    if !matches!(subject, Subject::Python | Subject::Starvation) {
        measure.args(["--seconds", &seconds.to_string()]);
    }
    workspace.run(&mut measure)
}

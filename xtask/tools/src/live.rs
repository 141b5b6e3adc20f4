//! Measurements of clients against the simulator over real sockets, and of the simulator.

use std::process::Command;

use anyhow::anyhow;

use crate::{mujoco, package};
use xtask::peers;
use xtask::workspace::Workspace;

/// Measures each client for `seconds` and writes `target/bench_live.json`.
pub(crate) fn run(workspace: &Workspace, seconds: u32) -> anyhow::Result<()> {
    build(workspace, &[])?;
    let mut measure = measure(workspace, "clients", "bench_live.json", seconds);
    match peers::interpreter(workspace)? {
        Ok(interpreter) => {
            let script = peers::directory(workspace).join("pylibfranka_torques.py");
            measure.arg("--python").arg(interpreter).arg(script);
        }
        Err(why) => println!("pylibfranka is NOT MEASURED: {why}"),
    }
    workspace.run(&mut measure)
}

/// Measures the simulator, each case for `seconds`, and writes `target/bench_sim.json`.
pub(crate) fn run_simulator(workspace: &Workspace, seconds: u32) -> anyhow::Result<()> {
    let mujoco = mujoco::provide(workspace)?;
    let mut measure = measure(workspace, "simulator", "bench_sim.json", seconds);
    match mujoco {
        Ok(()) => {
            build(workspace, &["--features", "mujoco"])?;
            measure.arg("--mujoco");
        }
        Err(why) => {
            println!("the MuJoCo plant is NOT MEASURED: {why}");
            build(workspace, &[])?;
        }
    }
    workspace.run(&mut measure)
}

/// Measures the cost of a recorder or a dashboard for the control thread, for `seconds` with one
/// and as long without.
pub(crate) fn run_beside(workspace: &Workspace, what: &str, seconds: u32) -> anyhow::Result<()> {
    build(workspace, &[])?;
    let target = workspace.target();
    let mut measure = workspace.program(target.join("dist").join("live"));
    measure.arg(what);
    if what == "recorder" {
        measure.arg(target);
    }
    workspace.run(measure.args(["--seconds", &seconds.to_string()]))
}

/// Measures the package for Python together with others and writes `target/bench_python.json`.
pub(crate) fn run_python(workspace: &Workspace) -> anyhow::Result<()> {
    let mut build = workspace.cargo();
    build.args([
        "build",
        "--profile",
        "dist",
        "--package",
        "franka-sim",
        "--package",
    ]);
    build.args(["franka-bench", "--bin", "franka-sim", "--bin", "live"]);
    workspace.run(&mut build)?;
    let interpreter = package::prepare_bench(workspace)?.map_err(|why| anyhow!(why))?;
    let target = workspace.target();
    let mut measure = workspace.program(target.join("dist").join("live"));
    measure
        .arg("packages")
        .arg(target.join("bench_python.json"));
    measure.arg("--python").arg(interpreter);
    measure
        .arg("--adapters")
        .arg(package::directory(workspace).join("bench"));
    workspace.run(&mut measure)
}

/// Builds the simulator and the measuring program.
fn build(workspace: &Workspace, features: &[&str]) -> anyhow::Result<()> {
    let mut build = workspace.cargo();
    build.args(["build", "--profile", "dist", "--package", "franka-sim"]);
    build.args(["--package", "franka-bench", "--bins"]);
    workspace.run(build.args(features))
}

/// The measuring program, with the subject, the output file and the duration.
fn measure(workspace: &Workspace, what: &str, output: &str, seconds: u32) -> Command {
    let target = workspace.target();
    let mut measure = workspace.program(target.join("dist").join("live"));
    measure.arg(what).arg(target.join(output));
    measure.args(["--seconds", &seconds.to_string()]);
    measure
}

//! Clients against the simulator over real sockets, measured.

use crate::peers;
use crate::workspace::Workspace;

/// Measures each client for `seconds` and writes `target/bench_live.json`.
pub(crate) fn run(workspace: &Workspace, seconds: u32) -> anyhow::Result<()> {
    let mut build = workspace.cargo();
    build.args(["build", "--release", "--package", "franka-sim"]);
    build.args(["--package", "franka-tests", "--bins"]);
    workspace.run(&mut build)?;
    let release = workspace.target().join("release");
    let mut measure = workspace.program(release.join("live"));
    measure.arg(workspace.target().join("bench_live.json"));
    measure.args(["--seconds", &seconds.to_string()]);
    match peers::interpreter(workspace)? {
        Ok(interpreter) => {
            let script = peers::directory(workspace).join("pylibfranka_torques.py");
            measure.arg("--python").arg(interpreter).arg(script);
        }
        Err(why) => println!("pylibfranka is NOT MEASURED: {why}"),
    }
    workspace.run(&mut measure)
}

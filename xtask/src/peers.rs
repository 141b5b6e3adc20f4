//! Other clients against the simulator: each runs with a separate simulator, several at once.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use anyhow::{bail, ensure};

use crate::python::Uv;
use crate::running::{self, Running};
use crate::selection::{PACKAGES, packages};
use crate::step::{Missing, Outcome, or_missing};
use crate::workspace::{Workspace, in_parallel};

/// A choice of clients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Set {
    /// The vendor's client: set-up, motions, torques, reflexes, the hand.
    Smoke,
    /// All others: further scripts, franka-rs, a cassette.
    Rest,
}

/// Runs our client together with another one, and the scripts of `tests/peers` that check something
/// against a separate simulator: as many at once as there are processors.
///
/// # Errors
/// If a program fails, or the machine lacks a requirement of the vendor's client.
pub fn run(workspace: &Workspace, set: Set) -> anyhow::Result<Outcome> {
    let interpreter = or_missing(interpreter(workspace))?;
    simulator(workspace)?;
    let mut programs = Vec::new();
    if set == Set::Rest {
        programs.push(beside_franka_rs(workspace, interpreter.as_deref().ok())?);
        programs.extend(interpreter.iter().map(|it| cassette(workspace, it)));
    }
    if let Ok(interpreter) = &interpreter {
        for (n, (name, arguments)) in SCRIPTS.iter().enumerate() {
            if SMOKE.contains(name) == (set == Set::Smoke) {
                programs.push(script(workspace, interpreter, n, name, arguments));
            }
        }
    }
    summarise(&in_parallel(programs, |it| it.run(PROGRAM_TIME_MAX)))?;
    match interpreter {
        Ok(_) => Ok(Outcome::Passed),
        Err(why) => bail!(Missing(why)),
    }
}

/// Builds the simulator's binary as the tests do, to reuse their build: Cargo builds the binaries
/// of a package with its integration tests.
fn simulator(workspace: &Workspace) -> anyhow::Result<()> {
    let mut build = workspace.cargo();
    build.args(["test", "--no-run", "--quiet", "--test=robot"]);
    build.args(packages(&PACKAGES));
    workspace.run(&mut build)
}

/// A program that prints a line per step, and the simulator that it needs, if any.
struct Program {
    name: &'static str,
    command: Command,
    simulator: Option<Command>,
}

/// Script `n` with its simulator.
fn script(
    workspace: &Workspace,
    interpreter: &Path,
    n: usize,
    name: &'static str,
    arguments: &[&str],
) -> Program {
    let address = loopback_address(std::process::id(), n);
    let mut simulator = workspace.program(workspace.target().join("debug").join("franka-sim"));
    simulator.args(["--bind", &address, "--port", PORT, "--arm", "ideal"]);
    simulator.args(arguments);
    let mut command = workspace.program(interpreter);
    command.arg(directory(workspace).join(name)).arg(address);
    Program {
        name,
        command,
        simulator: Some(simulator),
    }
}

/// The vendor's client against a cassette that it has recorded. Simulator, tap and cassette have
/// separate addresses, as the client knows only one port.
fn cassette(workspace: &Workspace, interpreter: &Path) -> Program {
    let name = "cassette_peer";
    let mut command = workspace.program(workspace.target().join("debug").join(name));
    command.arg(interpreter);
    command.arg(directory(workspace).join("pylibfranka_cassette.py"));
    command.args((1..=3).map(|n| loopback_address(std::process::id(), SCRIPTS.len() + n)));
    Program {
        name,
        command,
        simulator: None,
    }
}

/// Builds our programs and franka-rs. The returned program compares our target control with
/// franka-rs on the same robots. With an interpreter, it also compares it with the vendor's client.
fn beside_franka_rs(workspace: &Workspace, interpreter: Option<&Path>) -> anyhow::Result<Program> {
    let mut programs = workspace.cargo();
    programs.args(["build", "--quiet", "--package", "franka-bench"]);
    programs.args(["--bin", BESIDE, "--bin", "cassette_peer"]);
    workspace.run(&mut programs)?;
    workspace.run(&mut franka_rs(workspace))?;

    let mut command = workspace.program(workspace.target().join("debug").join(BESIDE));
    command.arg(workspace.target().join("debug").join("franka-rs-peer"));
    if let Some(interpreter) = interpreter {
        let script = directory(workspace).join(POSITIONS);
        let address = loopback_address(std::process::id(), SCRIPTS.len());
        command.arg("--pylibfranka").arg(interpreter).arg(script);
        command.arg(address);
    }
    Ok(Program {
        name: BESIDE,
        command,
        simulator: None,
    })
}

/// The build of franka-rs, in a separate workspace. It reuses the common part of the tests' build.
fn franka_rs(workspace: &Workspace) -> Command {
    let mut build = workspace.cargo();
    build.args(["build", "--quiet", "--locked", "--manifest-path"]);
    build.arg(directory(workspace).join("franka_rs").join("Cargo.toml"));
    build.arg("--target-dir").arg(workspace.target());
    build
}

/// The result of a program.
#[derive(Debug)]
struct Report {
    name: &'static str,
    time: Duration,
    /// Number of steps that passed.
    passed: u32,
    /// The line of each step that failed.
    failures: Vec<String>,
    /// The last line with any text.
    last: String,
    result: anyhow::Result<()>,
}

impl Program {
    fn run(self, time_max: Duration) -> Report {
        let start = Instant::now();
        let mut report = Report {
            name: self.name,
            time: Duration::ZERO,
            passed: 0,
            failures: Vec::new(),
            last: String::new(),
            result: Ok(()),
        };
        report.result = self.follow(time_max, &mut report);
        report.time = start.elapsed();
        report
    }

    /// Runs the program beside its simulator, prints its output behind its name, and counts the
    /// steps that it reports.
    fn follow(self, time_max: Duration, report: &mut Report) -> anyhow::Result<()> {
        let name = self.name;
        let start = |simulator| -> anyhow::Result<Running> {
            let mut simulator = Running::start(format!("{name}: [franka-sim]"), simulator)?;
            simulator.address("listening on ")?;
            Ok(simulator)
        };
        let _simulator = self.simulator.map(start).transpose()?;
        running::read(self.command, time_max, |line| {
            println!("{name}: {line}");
            report.passed += u32::from(line.starts_with("ok    "));
            if line.starts_with("FAIL  ") {
                report.failures.push(line.to_owned());
            }
            if !line.trim().is_empty() {
                line.clone_into(&mut report.last);
            }
        })?;
        ensure!(report.passed > 0, "no step passed");
        Ok(())
    }
}

/// Prints the result of each program, and then every failure in a line: the output of a program may
/// be far above, or cut off. Fails if one program failed.
fn summarise(reports: &[Report]) -> anyhow::Result<()> {
    println!();
    for report in reports {
        let (failed, seconds) = (report.failures.len(), report.time.as_secs_f64());
        let (name, passed) = (report.name, report.passed);
        println!("{name:32} {passed:3} passed, {failed} failed, {seconds:5.1} s");
    }
    println!();
    let mut failed = 0;
    for report in reports {
        let (name, Err(error)) = (report.name, &report.result) else {
            continue;
        };
        failed += 1;
        println!("{name}: {error:#}; its last line: {:?}", report.last);
        for line in &report.failures {
            println!("{name}: {line}");
        }
    }
    ensure!(failed == 0, "{failed} of {} programs failed", reports.len());
    Ok(())
}

/// A Python interpreter with the vendor's client.
///
/// # Errors
/// If the client cannot be installed, or has no wheels for this machine.
pub fn interpreter(workspace: &Workspace) -> anyhow::Result<PathBuf> {
    let (system, machine) = (env::consts::OS, env::consts::ARCH);
    if (system, machine) != ("linux", "x86_64") {
        bail!(Missing(format!(
            "pylibfranka has wheels for Linux on x86-64 only, this is {system} on {machine}"
        )));
    }
    let requirements = directory(workspace).join("requirements.txt");
    Uv::find(workspace)?.environment(workspace, "python", PYTHON, &requirements)
}

/// Directory of the scripts.
pub fn directory(workspace: &Workspace) -> PathBuf {
    workspace.root().join("tests").join("peers")
}

/// The address of the simulator of script `n`. The vendor's client knows only one port, so
/// simulators that run at the same time need separate addresses.
fn loopback_address(process: u32, n: usize) -> String {
    // Addresses from 127.1.x.y on: 127.0.0.1 may have a simulator of the user; y is never 0 or 255.
    // The scripts use the networks between for relays.
    let (high, low) = ((process / 254) % 256, process % 254 + 1);
    format!("127.{}.{high}.{low}", 2 * n + 1)
}

/// The program that runs our client together with franka-rs.
const BESIDE: &str = "beside_franka_rs";

/// The script that this program controls.
const POSITIONS: &str = "pylibfranka_positions.py";

/// The scripts, and the options of their simulators. They run in virtual time, in which no answer
/// is late, unless the script depends on the robot's clock.
const SCRIPTS: [(&str, &[&str]); 12] = [
    (
        "pylibfranka_hand.py",
        &[VIRTUAL, "--gripper-object-width", "0.05"],
    ),
    ("pylibfranka_async.py", &[]),
    ("pylibfranka_setup.py", &[VIRTUAL]),
    ("pylibfranka_model.py", &[VIRTUAL, "--hand"]),
    ("pylibfranka_motions.py", &[VIRTUAL]),
    ("pylibfranka_modes.py", &[VIRTUAL]),
    ("pylibfranka_torque_control.py", &[VIRTUAL]),
    ("pylibfranka_active.py", &[VIRTUAL]),
    ("pylibfranka_reflexes.py", &[VIRTUAL]),
    ("pylibfranka_late.py", &[]),
    // The Jacobian of the end effector nearly loses a rank there.
    (
        "pylibfranka_singular.py",
        &[VIRTUAL, "--q", "0,1.28,0,-0.5415,0,2.74,0"],
    ),
    ("pylibfranka_versions.py", &["--robot", "fer"]),
];

/// The scripts of [`Set::Smoke`].
const SMOKE: [&str; 5] = [
    "pylibfranka_hand.py",
    "pylibfranka_setup.py",
    "pylibfranka_motions.py",
    "pylibfranka_torque_control.py",
    "pylibfranka_reflexes.py",
];

const VIRTUAL: &str = "--virtual-time";

/// Versions of Python with wheels of the vendor.
const PYTHON: &str = ">=3.9,<3.13";

/// The port of every FCI server; the vendor's client uses no other.
const PORT: &str = "1337";

/// A program that takes longer hangs, on a busy machine too.
const PROGRAM_TIME_MAX: Duration = Duration::from_secs(300);

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::*;

    #[test]
    fn neighbours_get_addresses_of_their_own() {
        for process in [1, 253, 254, 255, 65_535, u32::MAX] {
            for n in 0..=SCRIPTS.len() {
                let address: Ipv4Addr = loopback_address(process, n).parse().unwrap();
                assert!(address.is_loopback());
                assert!((1..255).contains(&address.octets()[3]), "{address}");
                for next in [(process.wrapping_add(1), n), (process, n + 1)] {
                    assert_ne!(address.to_string(), loopback_address(next.0, next.1));
                }
            }
        }
    }

    fn report(program: &str, arguments: &[&str], time_max: Duration) -> Report {
        let mut command = Command::new(program);
        command.args(arguments);
        let program = Program {
            name: "program",
            command,
            simulator: None,
        };
        program.run(time_max)
    }

    #[test]
    fn steps_are_counted_by_what_a_program_prints() {
        let lines = "ok    one: fine\nok    two: fine\nFAIL  three: wrong\n2 passed, 1 failed\n\n";
        let report = report("printf", &[lines], Duration::from_secs(20));
        assert_eq!(report.passed, 2);
        assert_eq!(report.failures, ["FAIL  three: wrong"]);
        report.result.unwrap();
        let silent = super::tests::report("true", &[], Duration::from_secs(20));
        assert_eq!(silent.result.unwrap_err().to_string(), "no step passed");
    }

    #[test]
    fn the_last_line_that_says_anything_is_kept() {
        let script = "echo ok; echo 'Error: no robot' >&2; echo; exit 1";
        let report = report("sh", &["-c", script], Duration::from_secs(20));
        assert_eq!(
            (report.failures.len(), &*report.last),
            (0, "Error: no robot")
        );
        report.result.unwrap_err();
    }

    #[test]
    fn a_program_without_end_is_killed() {
        let report = report("sleep", &["60"], Duration::from_millis(100));
        let error = report.result.unwrap_err();
        assert!(error.to_string().contains("took longer"), "{error}");
    }
}

//! Other clients against the simulator: each runs with a separate simulator, several at once.

use std::env;
use std::fmt;
use std::io::{self, BufRead as _, BufReader, PipeReader};
use std::iter;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, anyhow, bail};

use crate::python::Uv;
use crate::selection::{PACKAGES, packages};
use crate::step::Outcome;
use crate::workspace::Workspace;

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
/// If a program fails, or the machine lacks a requirement and `CI=true`.
pub fn run(workspace: &Workspace, set: Set) -> anyhow::Result<Outcome> {
    let interpreter = interpreter(workspace)?;
    simulator(workspace)?;
    let scripts = interpreter.iter().flat_map(|interpreter| {
        let scripts = SCRIPTS.iter().enumerate();
        let scripts = scripts.filter(|(_, (name, _))| SMOKE.contains(name) == (set == Set::Smoke));
        scripts.map(|(n, (name, arguments))| script(workspace, interpreter, n, name, arguments))
    });
    let mut programs = Vec::new();
    if set == Set::Rest {
        programs.push(beside_franka_rs(workspace, interpreter.as_deref().ok())?);
        let interpreter = interpreter.iter();
        programs.extend(interpreter.map(|interpreter| cassette(workspace, interpreter)));
    }
    programs.extend(scripts);
    summarise(&side_by_side(programs))?;
    match interpreter {
        Ok(_) => Ok(Outcome::Passed),
        Err(why) => Outcome::without(why),
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

/// Runs the programs in this order, one per processor at a time.
fn side_by_side(programs: Vec<Program>) -> Vec<Summary> {
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let waiting = Mutex::new(programs.into_iter());
    let next = || {
        let mut waiting = waiting.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.next()
    };
    thread::scope(|scope| {
        let work = || iter::from_fn(next).map(Program::run).collect::<Vec<_>>();
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        let ended = workers.into_iter().map(|worker| worker.join());
        ended.flat_map(|ended| ended.expect("no panic")).collect()
    })
}

/// Name of a program, its steps, its duration, and its result.
type Summary = (&'static str, ReportedSteps, Duration, anyhow::Result<()>);

impl Program {
    fn run(self) -> Summary {
        let Self { name, command, .. } = self;
        let start = Instant::now();
        let simulator = self.simulator.map(|command| Running::start(name, command));
        let (steps, result) = match simulator.transpose() {
            Ok(_simulator) => count(name, command, PROGRAM_TIME_MAX),
            Err(error) => (ReportedSteps::default(), Err(error)),
        };
        (name, steps, start.elapsed(), result)
    }
}

/// Prints the result of each program, and then every failure in a line: the output of a program may
/// be far above, or cut off. Fails if one program failed.
fn summarise(summaries: &[Summary]) -> anyhow::Result<()> {
    let mut total = ReportedSteps::default();
    println!();
    for (name, steps, time, result) in summaries {
        let seconds = time.as_secs_f64();
        print!("{name:32} {steps}, {seconds:5.1} s");
        match result {
            Ok(()) => println!(),
            Err(error) => println!(", {error:#}"),
        }
        total.passed += steps.passed;
        total.failures.extend(steps.failures.clone());
    }
    println!("{:32} {total}", "together");
    println!();
    let mut failed = 0;
    for (name, steps, _, result) in summaries {
        let Err(error) = result else { continue };
        failed += 1;
        for line in &steps.failures {
            println!("{name}: {line}");
        }
        if steps.failures.is_empty() {
            println!("{name}: {error:#}; its last line: {:?}", steps.last);
        }
    }
    match failed {
        0 => Ok(()),
        failed => bail!("{failed} of {} programs failed", summaries.len()),
    }
}

/// The steps of a program that its output reports.
#[derive(Debug, Default)]
struct ReportedSteps {
    passed: u32,
    /// The line of each step that failed.
    failures: Vec<String>,
    /// The last line with any text.
    last: String,
}

impl ReportedSteps {
    /// Reads a line that a program printed.
    fn note(&mut self, line: &str) {
        if line.starts_with("ok    ") {
            self.passed += 1;
        } else if line.starts_with("FAIL  ") {
            self.failures.push(line.to_owned());
        }
        if !line.trim().is_empty() {
            line.clone_into(&mut self.last);
        }
    }
}

impl fmt::Display for ReportedSteps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (passed, failed) = (self.passed, self.failures.len());
        write!(f, "{passed:3} passed, {failed} failed")
    }
}

/// Runs a program to its end and counts the steps that it reports. Prints its output, each line
/// behind its name.
fn count(name: &str, command: Command, time_max: Duration) -> (ReportedSteps, anyhow::Result<()>) {
    let mut steps = ReportedSteps::default();
    let result = thread::scope(|scope| {
        let (child, output) = spawn(command)?;
        scope.spawn(|| {
            for line in BufReader::new(output).lines().map_while(Result::ok) {
                println!("{name}: {line}");
                steps.note(&line);
            }
        });
        finish(child, time_max)
    });
    let result = match result {
        Ok(()) if steps.passed == 0 => Err(anyhow!("no step passed")),
        result => result,
    };
    (steps, result)
}

/// Starts a program; the pipe has both its outputs.
fn spawn(mut command: Command) -> anyhow::Result<(Child, PipeReader)> {
    let (output, end) = io::pipe()?;
    let child = command.stdout(end.try_clone()?).stderr(end).spawn();
    let program = command.get_program().display();
    Ok((
        child.with_context(|| format!("cannot start {program}"))?,
        output,
    ))
}

/// A Python interpreter with the vendor's client, or the reason why none is available.
///
/// # Errors
/// If the client cannot be installed.
pub fn interpreter(workspace: &Workspace) -> anyhow::Result<Result<PathBuf, String>> {
    let requirements = directory(workspace).join("requirements.txt");
    if let Err(why) = supported() {
        return Ok(Err(why));
    }
    match Uv::find(workspace)? {
        Ok(uv) => uv.environment(workspace, "python", PYTHON, &requirements),
        Err(why) => Ok(Err(why)),
    }
}

/// Directory of the scripts.
pub fn directory(workspace: &Workspace) -> PathBuf {
    workspace.root().join("tests").join("peers")
}

/// Checks that the vendor's wheels exist for this machine.
fn supported() -> Result<(), String> {
    match (env::consts::OS, env::consts::ARCH) {
        ("linux", "x86_64") => Ok(()),
        (system, machine) => Err(format!(
            "pylibfranka has wheels for Linux on x86-64 only, this is {system} on {machine}"
        )),
    }
}

/// The address of the simulator of script `n`. The vendor's client knows only one port, so
/// simulators that run at the same time need separate addresses.
fn loopback_address(process: u32, n: usize) -> String {
    // Addresses from 127.1.x.y on: 127.0.0.1 may have a simulator of the user; y is never 0 or 255.
    // The scripts use the networks between for relays.
    let (high, low) = ((process / 254) % 256, process % 254 + 1);
    format!("127.{}.{high}.{low}", 2 * n + 1)
}

/// A simulator that is ready to serve; dropping this value ends it.
struct Running(Child);

impl Running {
    /// Starts the simulator of a script and waits for the line with its address.
    fn start(script: &'static str, command: Command) -> anyhow::Result<Self> {
        let (child, output) = spawn(command)?;
        let running = Self(child);
        let (sender, listens) = mpsc::channel();
        // Reads to the end, so that a simulator that prints more never waits for a reader.
        thread::spawn(move || {
            for line in BufReader::new(output).lines().map_while(Result::ok) {
                println!("{script}: [franka-sim] {line}");
                if line.starts_with("listening on ") {
                    // The receiver is gone if this came too late.
                    let _ = sender.send(());
                }
            }
        });
        match listens.recv_timeout(READY_TIME_MAX) {
            Ok(()) => Ok(running),
            Err(mpsc::RecvTimeoutError::Timeout) => Err(anyhow!(
                "the simulator did not listen within {READY_TIME_MAX:?}"
            )),
            Err(mpsc::RecvTimeoutError::Disconnected) => {
                Err(anyhow!("the simulator ended before it listened"))
            }
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        kill(&mut self.0);
    }
}

/// Waits for the end of a program. A program that takes longer than `time_max` is killed and counts
/// as failed.
fn finish(mut child: Child, time_max: Duration) -> anyhow::Result<()> {
    let deadline = Instant::now() + time_max;
    loop {
        match child.try_wait()? {
            Some(status) if status.success() => return Ok(()),
            Some(status) => bail!("the program failed: {status}"),
            None if Instant::now() >= deadline => {
                kill(&mut child);
                bail!("the program took longer than {time_max:?}");
            }
            None => thread::sleep(POLL),
        }
    }
}

/// Ends a child, which may also have ended already.
fn kill(child: &mut Child) {
    if child.kill().is_err() || child.wait().is_err() {
        eprintln!("could not end process {}", child.id());
    }
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

/// A simulator listens within milliseconds. On a machine that is busy with a build it may take
/// seconds.
const READY_TIME_MAX: Duration = Duration::from_secs(20);

/// A program that takes longer hangs, on a busy machine too.
const PROGRAM_TIME_MAX: Duration = Duration::from_secs(300);

const POLL: Duration = Duration::from_millis(50);

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

    #[test]
    fn steps_are_counted_by_what_a_program_prints() {
        let mut program = Command::new("printf");
        program.arg("%s\n").args([
            "ok    one (0.1 s): fine",
            "ok    two (0.1 s): fine",
            "FAIL  three: wrong",
            "2 passed, 1 failed",
            "",
        ]);
        let (steps, result) = count("printf", program, Duration::from_secs(20));
        assert_eq!(steps.to_string(), "  2 passed, 1 failed");
        assert_eq!(steps.failures, ["FAIL  three: wrong"]);
        result.unwrap();
        let (_, result) = count("true", Command::new("true"), Duration::from_secs(20));
        assert_eq!(result.unwrap_err().to_string(), "no step passed");
    }

    #[test]
    fn the_last_line_that_says_anything_is_kept() {
        let mut program = Command::new("sh");
        program.args(["-c", "echo ok; echo 'Error: no robot' >&2; echo; exit 1"]);
        let (steps, result) = count("sh", program, Duration::from_secs(20));
        assert_eq!((steps.failures.len(), &*steps.last), (0, "Error: no robot"));
        result.unwrap_err();
    }

    #[test]
    fn a_program_without_end_is_killed() {
        let mut command = Command::new("sleep");
        command.arg("60");
        let start = Instant::now();
        let (_, result) = count("sleep", command, Duration::from_millis(100));
        let error = result.unwrap_err();
        assert!(error.to_string().contains("took longer"), "{error}");
        assert!(start.elapsed() < Duration::from_secs(30));
    }
}

//! Other clients against the simulator: starts its binary, runs a script against it, ends it.

use std::env;
use std::fmt;
use std::io::{BufRead as _, BufReader};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, anyhow, bail};

use crate::mujoco;
use crate::python::{Python, Version};
use crate::realtime;
use crate::step::Outcome;
use crate::workspace::Workspace;

/// Runs our client beside another one, and the scripts of `tests/peers` that check something
/// against a simulator of their own.
pub(crate) fn run(workspace: &Workspace) -> anyhow::Result<Outcome> {
    let mut summaries = vec![beside_franka_rs(workspace)?];
    let interpreter = match interpreter(workspace)? {
        Ok(interpreter) => interpreter,
        Err(why) => {
            summarise(&summaries)?;
            return Outcome::without(why);
        }
    };
    let peers = directory(workspace);
    let address = loopback_address(std::process::id());
    for (name, arguments) in SCRIPTS {
        let mut simulator = real_time(&workspace.target().join("debug").join("franka-sim"));
        simulator.args(["--bind", &address, "--port", PORT]);
        simulator.args(arguments).env("NO_COLOR", "1");
        let _simulator = Running::start(simulator)?;

        let mut script = workspace.program(&interpreter);
        script.arg(peers.join(name)).arg(&address);
        println!("$ python tests/peers/{name} {address}");
        summaries.push(summary(name, script));
    }
    summarise(&summaries)
}

/// What became of a script, how long it took, and its name.
type Summary = (&'static str, Steps, Duration, anyhow::Result<()>);

fn summary(name: &'static str, script: Command) -> Summary {
    let start = Instant::now();
    let (steps, result) = count(script, SCRIPT_TIME_MAX);
    (name, steps, start.elapsed(), result)
}

/// Builds our programs, and franka-rs in a workspace of its own, and holds our target control
/// against its own on the same robots.
fn beside_franka_rs(workspace: &Workspace) -> anyhow::Result<Summary> {
    let target = workspace.target().join("peers");
    let mut build = workspace.cargo();
    build.args(["build", "--locked", "--manifest-path"]);
    build.arg(directory(workspace).join("franka_rs").join("Cargo.toml"));
    build.arg("--target-dir").arg(&target);
    workspace.run(&mut build)?;
    // As the tests are built, so that what they have built is used again: with it come the
    // programs.
    let mut build = workspace.cargo();
    build.args(["test", "--no-run", "--quiet", "--workspace", "--features"]);
    workspace.run(build.arg(mujoco::features(workspace)?))?;

    let mut beside = workspace.program(workspace.target().join("debug").join(BESIDE));
    beside.arg(target.join("debug").join("franka-rs-peer"));
    println!("$ {BESIDE}");
    Ok(summary(BESIDE, beside))
}

/// Prints what became of each script; fails if one did.
fn summarise(summaries: &[Summary]) -> anyhow::Result<Outcome> {
    let mut total = Steps::default();
    println!();
    for (name, steps, time, result) in summaries {
        let seconds = time.as_secs_f64();
        print!("{name:32} {steps}, {seconds:5.1} s");
        match result {
            Ok(()) => println!(),
            Err(error) => println!(", {error:#}"),
        }
        total.passed += steps.passed;
        total.failed += steps.failed;
        total.repeated += steps.repeated;
    }
    println!("{:32} {total}", "together");
    match summaries
        .iter()
        .filter(|(.., result)| result.is_err())
        .count()
    {
        0 => Ok(Outcome::Passed),
        failed => bail!("{failed} of {} scripts failed", summaries.len()),
    }
}

/// What a script printed of its steps.
#[derive(Debug, Default, PartialEq, Eq)]
struct Steps {
    passed: u32,
    failed: u32,
    /// Because commands came late.
    repeated: u32,
}

impl Steps {
    /// Takes in a line that a script printed.
    fn note(&mut self, line: &str) {
        if line.starts_with("ok    ") {
            self.passed += 1;
        } else if line.starts_with("FAIL  ") {
            self.failed += 1;
        } else if line.starts_with("      repeated ") {
            self.repeated += 1;
        }
    }
}

impl fmt::Display for Steps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            passed,
            failed,
            repeated,
        } = self;
        write!(f, "{passed:3} passed, {failed} failed, {repeated} repeated")
    }
}

/// Runs a script to its end and counts its steps, which it prints; what else it prints is passed
/// on.
fn count(mut script: Command, time_max: Duration) -> (Steps, anyhow::Result<()>) {
    let (sender, lines) = mpsc::channel();
    let result = thread::scope(|scope| {
        finish(script.stdout(Stdio::piped()), time_max, |output| {
            scope.spawn(move || {
                for line in BufReader::new(output).lines().map_while(Result::ok) {
                    println!("{line}");
                    // The receiver is there until all have been counted.
                    let _ = sender.send(line);
                }
            });
        })
    });
    let mut steps = Steps::default();
    for line in lines {
        steps.note(&line);
    }
    let result = match result {
        Ok(()) if steps.passed == 0 => Err(anyhow!("no step passed")),
        result => result,
    };
    (steps, result)
}

/// A Python interpreter that has the vendor's client, or why there is none.
pub(crate) fn interpreter(workspace: &Workspace) -> anyhow::Result<Result<PathBuf, String>> {
    let requirements = directory(workspace).join("requirements.txt");
    match supported().and_then(|()| Python::find(PYTHON)) {
        Ok(python) => Ok(Ok(python.environment(workspace, &requirements)?)),
        Err(why) => Ok(Err(why)),
    }
}

/// Where the scripts are.
pub(crate) fn directory(workspace: &Workspace) -> PathBuf {
    workspace.root().join("tests").join("peers")
}

/// Whether the vendor's wheels exist for this machine at all.
fn supported() -> Result<(), String> {
    match (env::consts::OS, env::consts::ARCH) {
        ("linux", "x86_64") => Ok(()),
        (system, machine) => Err(format!(
            "pylibfranka has wheels for Linux on x86-64 only, this is {system} on {machine}"
        )),
    }
}

/// The vendor's client knows one port only, so that simulators side by side need addresses of their
/// own.
fn loopback_address(process: u32) -> String {
    // 127.1.x.y: away from 127.0.0.1, where a simulator of the user may listen; y is never 0 or
    // 255.
    let (high, low) = ((process / 254) % 256, process % 254 + 1);
    format!("127.1.{high}.{low}")
}

/// The simulator under real-time scheduling where this user may ask for it, as it is otherwise. A
/// robot sends a state every millisecond whatever else happens; a simulator on a busy machine does
/// only if the kernel prefers it.
fn real_time(program: &Path) -> Command {
    match realtime::obtain() {
        Ok(()) => {
            let mut command = Command::new("chrt");
            command.args(["--fifo", "10"]).arg(program);
            command
        }
        Err(why) => {
            println!("{why}; commands may come late on a busy machine");
            Command::new(program)
        }
    }
}

/// A simulator that is ready to serve; it ends with this value.
struct Running(Child);

impl Running {
    /// Starts the simulator and waits for the line in which it says that it listens.
    fn start(mut command: Command) -> anyhow::Result<Self> {
        let mut child = command
            .stdout(Stdio::piped())
            .spawn()
            .context("cannot start the simulator")?;
        let output = child.stdout.take();
        let running = Self(child);
        let (sender, lines) = mpsc::channel();
        // Reads to the end, so that a simulator that prints more never waits for a reader.
        thread::spawn(move || {
            for line in output
                .into_iter()
                .flat_map(|output| BufReader::new(output).lines())
            {
                let Ok(line) = line else { return };
                println!("[franka-sim] {line}");
                // After the first line the output is not read.
                let _ = sender.send(line);
            }
        });
        match lines.recv_timeout(READY_TIME_MAX) {
            Ok(_) => Ok(running),
            Err(mpsc::RecvTimeoutError::Timeout) => Err(anyhow!(
                "the simulator printed nothing for {READY_TIME_MAX:?}"
            )),
            Err(mpsc::RecvTimeoutError::Disconnected) => {
                Err(anyhow!("the simulator ended at once"))
            }
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        kill(&mut self.0);
    }
}

/// Runs a program to its end; one that takes longer than `time_max` is killed and counts as failed.
/// `read` gets its output, if there is a pipe for it.
fn finish(
    command: &mut Command,
    time_max: Duration,
    read: impl FnOnce(ChildStdout),
) -> anyhow::Result<()> {
    let mut child = command.spawn().context("cannot start the script")?;
    child.stdout.take().map(read);
    let deadline = Instant::now() + time_max;
    loop {
        match child.try_wait()? {
            Some(status) if status.success() => return Ok(()),
            Some(status) => bail!("the script failed: {status}"),
            None if Instant::now() >= deadline => {
                kill(&mut child);
                bail!("the script took longer than {time_max:?}");
            }
            None => thread::sleep(POLL),
        }
    }
}

/// Ends a child; it may have ended by itself, which is as good.
fn kill(child: &mut Child) {
    if child.kill().is_err() || child.wait().is_err() {
        eprintln!("could not end process {}", child.id());
    }
}

/// The binary of the tests package that runs our client beside franka-rs.
const BESIDE: &str = "beside_franka_rs";

/// The scripts, and what their simulators are like.
const SCRIPTS: [(&str, &[&str]); 11] = [
    ("pylibfranka_setup.py", &[]),
    ("pylibfranka_model.py", &["--hand"]),
    ("pylibfranka_motions.py", &[]),
    ("pylibfranka_modes.py", &[]),
    ("pylibfranka_torque_control.py", &[]),
    ("pylibfranka_active.py", &[]),
    ("pylibfranka_async.py", &[]),
    ("pylibfranka_reflexes.py", &[]),
    // The Jacobian of the end effector all but loses a rank there.
    (
        "pylibfranka_singular.py",
        &["--q", "0,1.28,0,-0.5415,0,2.74,0"],
    ),
    ("pylibfranka_versions.py", &["--robot", "fer"]),
    ("pylibfranka_hand.py", &["--gripper-object-width", "0.05"]),
];

/// Versions of Python that the vendor builds wheels for.
const PYTHON: RangeInclusive<Version> = (3, 9)..=(3, 12);

/// The port of every FCI server; the vendor's client takes no other.
const PORT: &str = "1337";

/// A simulator listens within milliseconds; on a machine that is busy building it may take seconds.
const READY_TIME_MAX: Duration = Duration::from_secs(20);

/// The longest script takes some 12 s; a few of its motions may be repeated.
const SCRIPT_TIME_MAX: Duration = Duration::from_secs(180);

const POLL: Duration = Duration::from_millis(50);

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::*;

    #[test]
    fn neighbours_get_addresses_of_their_own() {
        for process in [1, 253, 254, 255, 65_535, u32::MAX] {
            let address: Ipv4Addr = loopback_address(process).parse().unwrap();
            assert!(address.is_loopback());
            assert!((1..255).contains(&address.octets()[3]), "{address}");
            let next = loopback_address(process.wrapping_add(1));
            assert_ne!(address.to_string(), next);
        }
    }

    #[test]
    fn steps_are_counted_by_what_a_script_prints() {
        let mut script = Command::new("printf");
        script.arg("%s\n").args([
            "ok    one (0.1 s): fine",
            "      repeated for late commands: so late",
            "ok    two (0.1 s): fine",
            "FAIL  three: wrong",
            "2 passed, 1 failed",
        ]);
        let (steps, result) = count(script, Duration::from_secs(20));
        let expected = Steps {
            passed: 2,
            failed: 1,
            repeated: 1,
        };
        assert_eq!(steps, expected);
        result.unwrap();
        let (_, result) = count(Command::new("true"), Duration::from_secs(20));
        assert_eq!(result.unwrap_err().to_string(), "no step passed");
    }

    #[test]
    fn a_program_without_end_is_killed() {
        let mut command = Command::new("sleep");
        command.arg("60");
        let start = Instant::now();
        let error = finish(&mut command, Duration::from_millis(100), drop).unwrap_err();
        assert!(error.to_string().contains("took longer"), "{error}");
        assert!(start.elapsed() < Duration::from_secs(30));
    }
}

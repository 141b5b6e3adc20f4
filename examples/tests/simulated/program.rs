//! Runs the examples as programs.

use std::io::{BufRead, BufReader, Lines, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdout, Command, ExitStatus, Stdio};

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

use crate::arm::{Arm, MeasuredPath, Scene};

/// Both robots, by their names in the examples' option.
pub(crate) const ROBOTS: [&str; 2] = ["fr3", "fer"];

/// Returns the command for an example. Cargo builds examples next to the tests.
pub(crate) fn example(name: &str) -> Command {
    let mut path: PathBuf = std::env::current_exe().expect("a test has a path");
    path.pop();
    path.pop();
    path.push("examples");
    path.push(name);
    assert!(path.exists(), "{} is built with the tests", path.display());
    let mut command = Command::new(path);
    command.env("RUST_BACKTRACE", "0"); // errors are read here
    command
}

/// The output of a program, and its exit code.
#[derive(Debug)]
pub(crate) struct Said {
    /// Exit code; `None` if it was killed.
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

/// Runs an example on `input` until it ends.
pub(crate) fn run(name: &str, arguments: &[&str], input: &str) -> Said {
    let mut child = example(name)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let mut stdin = child.stdin.take().expect("it is piped");
    // A program that does not read its input may have ended already.
    let _ = stdin.write_all(input.as_bytes());
    drop(stdin);
    let output = child.wait_with_output().expect("it is ours");
    let text = |bytes| String::from_utf8(bytes).expect("it prints text");
    Said {
        code: output.status.code(),
        stdout: text(output.stdout),
        stderr: text(output.stderr),
    }
}

/// An example that runs during the test, and is killed at its end, even if the test fails.
pub(crate) struct Beside {
    child: Child,
    lines: Lines<BufReader<ChildStdout>>,
}

impl Beside {
    /// Starts an example.
    pub(crate) fn start(name: &str, arguments: &[&str]) -> Self {
        let mut child = example(name)
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .expect("it starts");
        let stdout = child.stdout.take().expect("it is piped");
        let lines = BufReader::new(stdout).lines();
        Self { child, lines }
    }

    /// Starts a service for the robot at `robot`; also returns the service's address.
    pub(crate) fn serve(name: &str, robot: &str, options: &[&str]) -> (Self, String) {
        let mut arguments = options.to_vec();
        arguments.extend(["--listen", "127.0.0.1:0", "--realtime", "ignore", robot]);
        let mut service = Self::start(name, &arguments);
        let address = service.said("listening on ");
        (service, address)
    }

    /// Waits for a line with this beginning, and returns the rest of it.
    pub(crate) fn said(&mut self, beginning: &str) -> String {
        let said = self.lines.by_ref().find_map(|line| {
            let line = line.expect("it prints text");
            line.strip_prefix(beginning).map(str::to_owned)
        });
        said.unwrap_or_else(|| panic!("it ended, and never said {beginning:?}"))
    }

    /// Kills it, so that it cannot close its connections.
    pub(crate) fn kill(mut self) {
        self.child.kill().expect("it runs");
        self.child.wait().expect("it is ours");
    }

    /// Sends it a signal.
    pub(crate) fn signal(&self, signal: Signal) {
        let id = Pid::from_raw(self.child.id().cast_signed());
        kill(id, signal).expect("it runs");
    }

    /// Waits for its end.
    pub(crate) fn ended(&mut self) -> ExitStatus {
        self.child.wait().expect("it is ours")
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        // Fails only if it has already ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Runs an example on each robot, both at once, and passes its output and the motion of its arm to
/// `check`.
pub(crate) fn on_both(
    name: &str,
    arguments: &[&str],
    scene: &Scene,
    check: impl Fn(&str, &Said, &MeasuredPath) + Sync,
) {
    let judge = |robot| {
        let arm = Arm::start(robot, scene.clone());
        let mut all = arguments.to_vec();
        all.extend([arm.address.as_str(), "--realtime", "ignore", "--yes"]);
        let said = run(name, &all, "");
        check(robot, &said, &arm.stop());
    };
    std::thread::scope(|scope| {
        for robot in ROBOTS {
            let judge = &judge;
            scope.spawn(move || judge(robot));
        }
    });
}

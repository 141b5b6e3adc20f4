//! Runs the examples as programs, with a time limit.

use std::io::{Read, Write};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::arm::{Arm, Course, Scene};

/// Both robots, by their names in the option of the examples.
pub(crate) const ROBOTS: [&str; 2] = ["fr3", "fer"];

/// Held by each test, so that at most two robots share this machine.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

pub(crate) fn alone() -> MutexGuard<'static, ()> {
    ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the command for an example. Cargo builds examples with the tests, beside them.
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
    /// `None` if it was killed.
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Said {
    /// Whether the robot ended a motion after more than one in twenty of its last commands were
    /// late: that only means that this machine was busy.
    fn was_starved(&self) -> bool {
        let rate = self.stderr.split("control_command_success_rate: ").nth(1);
        let rate = rate.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
        rate.is_some_and(|rate| rate < 0.95)
    }
}

/// Runs an example on `input` until it ends, and kills it after a minute.
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
    let stdout = collect(child.stdout.take().expect("it is piped"));
    let stderr = collect(child.stderr.take().expect("it is piped"));
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().expect("it is ours") {
            break status;
        }
        if start.elapsed() > Duration::from_secs(60) {
            child.kill().expect("it is ours");
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    Said {
        code: status.code(),
        stdout: stdout.join().expect("no panic"),
        stderr: stderr.join().expect("no panic"),
    }
}

fn collect(mut pipe: impl Read + Send + 'static) -> std::thread::JoinHandle<String> {
    std::thread::spawn(move || {
        let mut text = String::new();
        pipe.read_to_string(&mut text).expect("it prints text");
        text
    })
}

/// Runs an example on each robot, both at once, and passes its output and the motion of its arm to
/// `check`.
///
/// A program that ended while [its commands came late](Said::was_starved) is run again.
pub(crate) fn on_both(
    name: &str,
    arguments: &[&str],
    scene: &Scene,
    check: impl Fn(&str, &Said, &Course) + Sync,
) {
    let _alone = alone();
    let attempt = |robot| {
        let arm = Arm::start(robot, scene.clone());
        let mut all = arguments.to_vec();
        all.extend([arm.address.as_str(), "--realtime", "ignore", "--yes"]);
        (run(name, &all, ""), arm.stop())
    };
    let judge = |robot| {
        let mut attempts = std::iter::repeat_with(|| attempt(robot));
        let (said, course) = attempts
            .by_ref()
            .take(3)
            .find(|(said, _)| !said.was_starved())
            .unwrap_or_else(|| panic!("{name} on {robot}: this machine was busy three times"));
        check(robot, &said, &course);
    };
    std::thread::scope(|scope| {
        for robot in ROBOTS {
            let judge = &judge;
            scope.spawn(move || judge(robot));
        }
    });
}

//! The program `franka`, with a separate configuration.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use std::{env, fs, process, thread};

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

/// A folder for the configuration of programs. It is deleted at the end.
pub(crate) struct Home(PathBuf);

impl Home {
    pub(crate) fn new() -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("franka-cli-{}-{count}", process::id());
        let folder = env::temp_dir().join(name);
        fs::create_dir_all(&folder).expect("a temporary folder");
        Self(folder)
    }

    /// Returns a path in the folder.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Returns the command for the program with these arguments, not started.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_franka"));
        command
            .args(arguments)
            .env("XDG_CONFIG_HOME", &self.0)
            .env_remove("FRANKA_ROBOT")
            .env_remove("NO_COLOR")
            .env_remove("CLICOLOR_FORCE")
            .current_dir(&self.0);
        command
    }

    /// Runs the program in pipes, without input.
    pub(crate) fn run(&self, arguments: &[&str]) -> Ran {
        Ran::of(self.command(arguments).output().expect("the program runs"))
    }

    /// Starts the program in pipes.
    pub(crate) fn start(&self, arguments: &[&str]) -> Started {
        let mut command = self.command(arguments);
        command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        Started(Some(command.spawn().expect("the program starts")))
    }
}

impl Drop for Home {
    fn drop(&mut self) {
        // The folder is left behind if it cannot be deleted.
        let _ = fs::remove_dir_all(&self.0);
    }
}

impl AsRef<Path> for Home {
    fn as_ref(&self) -> &Path {
        &self.0
    }
}

/// Result of a program that has ended.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Ran {
    fn of(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).expect("text"),
            err: String::from_utf8(output.stderr).expect("text"),
        }
    }

    /// Checks that the program ended with this code, and that its errors contain these texts.
    #[track_caller]
    pub(crate) fn failed(&self, code: i32, texts: &[&str]) {
        assert_eq!(self.code, Some(code), "{self:?}");
        for text in texts {
            assert!(self.err.contains(text), "{text:?} in {self:?}");
        }
        assert!(!self.err.contains("panicked"), "{self:?}");
    }

    /// Checks that the program succeeded, and returns its output.
    #[track_caller]
    pub(crate) fn done(self) -> String {
        assert_eq!(self.code, Some(0), "{self:?}");
        self.out
    }

    /// Checks that the program succeeded, and returns its JSON output.
    #[track_caller]
    pub(crate) fn json(self) -> serde_json::Value {
        let out = self.done();
        let json: serde_json::Value =
            serde_json::from_str(&out).unwrap_or_else(|error| panic!("{error}: {out}"));
        assert_eq!(json["schema"], 1, "{json}");
        json
    }
}

/// A running program. Dropping this value kills it.
pub(crate) struct Started(Option<Child>);

impl Started {
    pub(crate) fn child(&mut self) -> &mut Child {
        self.0.as_mut().expect("not ended")
    }

    pub(crate) fn signal(&mut self, signal: Signal) {
        let id = Pid::from_raw(self.child().id() as i32);
        kill(id, signal).expect("it runs");
    }

    /// Waits for the end of the program.
    pub(crate) fn ended(mut self) -> Ran {
        let child = self.0.take().expect("not ended");
        Ran::of(child.wait_with_output().expect("it ends"))
    }
}

impl Drop for Started {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            // The process may have ended already.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Returns the first address of a robot in the output of a tap or a player, if it is complete.
pub(crate) fn robot_address(text: &str) -> Option<String> {
    let (_, rest) = text.split_once("robot at ")?;
    let end = rest.find([',', '\r', '\n'])?;
    Some(rest[..end].to_owned())
}

/// Waits until a condition is true. A time limit detects a program that hangs.
#[track_caller]
pub(crate) fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !is_so() {
        assert!(begin.elapsed() < LIMIT, "{what} does not come");
        thread::sleep(Duration::from_millis(2));
    }
}

pub(crate) const LIMIT: Duration = Duration::from_secs(60);

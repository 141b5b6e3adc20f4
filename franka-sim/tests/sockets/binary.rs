//! The simulator as a separate process.

use std::fs;
use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use franka_proto::Version;

use crate::port::{Port, SOON};

/// Option for virtual time, which waits for clients on slow machines. A silence of 20 cycles, which
/// ends a motion, then takes some seconds.
const PATIENCE: &str = "--virtual-time=0.1";

/// A running simulator on free ports of 127.0.0.1. Dropping this value ends the simulator.
pub(crate) struct Binary {
    child: Mutex<Child>,
    version: Version,
    ports: [Port; 3],
    log: Arc<Mutex<Vec<String>>>,
}

impl Binary {
    /// Starts a robot of this kind that waits for answers. Returns when the robot listens.
    pub(crate) fn start(kind: &str) -> Self {
        Self::start_with(&["--robot", kind, PATIENCE])
    }

    /// Starts a robot with these arguments, of which the first is the kind. Returns when the robot
    /// listens.
    pub(crate) fn start_with(arguments: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_franka-sim"))
            .args(arguments)
            .args(["--port", "0", "--arm", "ideal"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the simulator starts");
        let output = child.stdout.take().expect("a pipe");
        let mut addresses = BufReader::new(output).lines().map(|line| {
            let line = line.expect("text");
            let address = line.rsplit(' ').next().expect("a word");
            address.parse::<SocketAddr>().expect("an address")
        });
        let mut address = || addresses.next().expect("three lines");
        let version = match arguments[1] {
            "fer" => Version::V5,
            _ => Version::V10,
        };
        let ports = [
            Port::robot(version, address()),
            Port::hand(address()),
            Port::vacuum_gripper(address()),
        ];
        let log = Arc::new(Mutex::new(Vec::new()));
        let errors = child.stderr.take().expect("a pipe");
        let written = log.clone();
        std::thread::spawn(move || {
            for line in BufReader::new(errors).lines().map_while(Result::ok) {
                written.lock().expect("no panic").push(line);
            }
        });
        Self {
            child: Mutex::new(child),
            version,
            ports,
            log,
        }
    }

    pub(crate) fn version(&self) -> Version {
        self.version
    }

    /// Ports of the robot, the hand and the vacuum gripper.
    pub(crate) fn ports(&self) -> &[Port; 3] {
        &self.ports
    }

    pub(crate) fn robot(&self) -> &Port {
        &self.ports[0]
    }

    /// Fails if the process that was started has ended.
    pub(crate) fn assert_alive(&self) {
        let ended = self.child.lock().expect("no panic").try_wait();
        let ended = ended.expect("a child of this process");
        assert!(ended.is_none(), "it ended: {ended:?}\n{}", self.log());
    }

    /// Waits until the simulator has logged a line that contains `text`.
    pub(crate) fn assert_logged(&self, text: &str) {
        let deadline = Instant::now() + SOON;
        while !self.log().contains(text) {
            assert!(Instant::now() < deadline, "no {text:?} in\n{}", self.log());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn log(&self) -> String {
        self.log.lock().expect("no panic").join("\n")
    }

    /// Stops the process for the time `stop`, and then continues it.
    pub(crate) fn stop_for(&self, stop: Duration) {
        self.signal(libc::SIGSTOP);
        std::thread::sleep(stop);
        self.signal(libc::SIGCONT);
    }

    /// Requests the end of the process.
    pub(crate) fn interrupt(&self) {
        self.signal(libc::SIGINT);
    }

    fn signal(&self, signal: libc::c_int) {
        let process = self.child.lock().expect("no panic").id();
        let process = libc::pid_t::try_from(process).expect("a process id");
        // SAFETY: the call sends a signal to a child that has not been waited for, and accesses no
        // memory.
        let result = unsafe { libc::kill(process, signal) };
        assert_eq!(result, 0, "{}", std::io::Error::last_os_error());
    }

    /// Private memory of the process, not shared with files, `[KiB]`.
    pub(crate) fn memory(&self) -> usize {
        self.status("RssAnon:")
    }

    /// Largest memory of the process so far, including memory that is shared with files, `[KiB]`.
    pub(crate) fn memory_max(&self) -> usize {
        self.status("VmHWM:")
    }

    /// A value of proc_pid_status(5), `[KiB]`.
    fn status(&self, name: &str) -> usize {
        let status = fs::read_to_string(self.proc("status")).expect("Linux");
        let line = status.lines().find_map(|line| line.strip_prefix(name));
        let text = line.expect("Linux 4.5").trim();
        text.trim_end_matches(" kB").parse().expect("a number")
    }

    /// Number of open file descriptors of the process.
    pub(crate) fn descriptors(&self) -> usize {
        fs::read_dir(self.proc("fd")).expect("Linux").count()
    }

    fn proc(&self, file: &str) -> String {
        let process = self.child.lock().expect("no panic").id();
        format!("/proc/{process}/{file}")
    }
}

impl Drop for Binary {
    fn drop(&mut self) {
        let mut child = self.child.lock().expect("no panic");
        child.kill().expect("a child of this process");
        child.wait().expect("a child of this process");
    }
}

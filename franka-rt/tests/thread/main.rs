//! The thread over real sockets, with a robot that is a plain UDP socket in this process.
//!
//! Waits have long deadlines and end as soon as their condition is true. The margins are for a
//! loaded machine with two processors, not for the code.

mod cores;
mod cycles;
mod faults;
mod lease;
mod receiving;
mod state_wakeups;
mod stopping;

use std::net::{IpAddr, Ipv4Addr, UdpSocket};
use std::time::{Duration, Instant};

use franka_proto::{DecodeError, RobotCommand, RobotState, Version};
use franka_rt::driver::{Driver, Event, LinkTimeout};
use franka_rt::exchange;
use franka_rt::sched::{Realtime, SchedError, Scheduling, kernel_is_realtime};
use franka_rt::stats::{Arrival, CycleTimes, MotionStatistics};
use franka_rt::thread::{
    self, Capacity, Core, Handle, LinkFault, Lost, Notice, StartError, ThreadConfig,
};

use cores::Probe;

const VERSION: Version = Version::V10;

/// Longer than any wait of a working thread, on any machine.
const DEADLINE: Duration = Duration::from_secs(300);

const ROBOT: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);

/// A peer on 127.0.0.0/8 that sends states to the thread.
struct Peer(UdpSocket);

impl Peer {
    fn new(address: [u8; 4], port: u16) -> Self {
        let socket = UdpSocket::bind((Ipv4Addr::from(address), 0)).expect("a free port");
        socket
            .connect((Ipv4Addr::LOCALHOST, port))
            .expect("an address");
        socket.set_read_timeout(Some(DEADLINE)).expect("an option");
        Self(socket)
    }

    fn send(&self, message_id: u64) {
        self.0.send(&state(message_id)).expect("loopback");
    }

    fn command(&self) -> RobotCommand {
        let mut bytes = [0; RobotCommand::MAX_SIZE];
        let size = self.0.recv(&mut bytes).expect("a command comes");
        RobotCommand::decode(VERSION, &bytes[..size]).expect("it is one")
    }
}

fn state(message_id: u64) -> Vec<u8> {
    let mut bytes = vec![0; RobotState::MAX_SIZE];
    let state = RobotState {
        message_id,
        q: [message_id as f64; 7],
        ..RobotState::default()
    };
    let size = state.encode(VERSION, &mut bytes).expect("there is room");
    bytes.truncate(size);
    bytes
}

/// Returns options with real-time scheduling if this process may have it.
fn config() -> ThreadConfig {
    let scheduling = Scheduling {
        realtime: Realtime::Ignore,
        ..Scheduling::default()
    };
    ThreadConfig {
        scheduling,
        ..ThreadConfig::default()
    }
}

fn socket() -> (UdpSocket, u16) {
    let socket = exchange::bind(ROBOT).expect("a free port");
    let port = socket.local_addr().expect("bound").port();
    (socket, port)
}

fn start<C: Core>(config: ThreadConfig, core: C) -> (Handle<C>, Peer) {
    let (socket, port) = socket();
    let handle = thread::spawn(config, core, socket, ROBOT, VERSION).expect("nothing is enforced");
    (handle, Peer::new([127, 0, 0, 1], port))
}

/// Polls until there is an answer.
fn wait_for<T>(what: &str, mut poll: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(answer) = poll() {
            return answer;
        }
        assert!(start.elapsed() < DEADLINE, "no {what} after {DEADLINE:?}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

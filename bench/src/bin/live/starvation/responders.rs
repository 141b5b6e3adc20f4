//! The same exchange on the control thread and in a task: reads the newest state and sends one
//! command, without computation.

use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::time::Duration;

use franka_proto::{RobotCommand, RobotState};
use franka_rt::exchange;
use franka_rt::thread::{self, Core, ThreadConfig};
use tokio::runtime::Runtime;

use super::preferred;
use super::robot::{self, ADDRESS, Outcome, VERSION};

/// The responder to the states.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Responder {
    /// The driver's control thread.
    Thread,
    /// A task of the program's async runtime.
    Task,
}

impl Responder {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Thread => "control thread",
            Self::Task => "task",
        }
    }

    /// Answers a robot for `time`.
    pub(crate) fn run(self, runtime: &Runtime, time: Duration) -> Outcome {
        let socket = exchange::bind(ADDRESS).expect("a free port");
        let port = socket.local_addr().expect("bound").port();
        match self {
            Self::Thread => {
                let config = ThreadConfig {
                    scheduling: preferred(None),
                    ..ThreadConfig::default()
                };
                let handle = thread::spawn(config, Echo, socket, ADDRESS, VERSION);
                let handle = handle.expect("nothing is enforced");
                let outcome = robot::run(port, time).expect("loopback");
                handle.thread.join().expect("nothing panics");
                outcome
            }
            Self::Task => {
                let task = runtime.spawn(answer(socket));
                let outcome = robot::run(port, time).expect("loopback");
                task.abort();
                outcome
            }
        }
    }
}

/// Answers every state.
struct Echo;

fn reply_to(state: &RobotState) -> RobotCommand {
    RobotCommand {
        message_id: state.message_id,
        ..RobotCommand::default()
    }
}

impl Core for Echo {
    type Order = ();
    type Event = ();
    type Record = ();

    fn on_order(&mut self, (): ()) {}

    fn on_state(&mut self, state: &RobotState) -> Option<RobotCommand> {
        Some(reply_to(state))
    }

    fn on_silence(&mut self, _silence: Duration) {}

    fn record(&self) {}

    fn take_event(&mut self) -> Option<()> {
        None
    }
}

/// A driver in a task of the runtime: answers the newest of the waiting states.
async fn answer(socket: UdpSocket) -> io::Result<()> {
    socket.set_nonblocking(true)?;
    let socket = tokio::net::UdpSocket::from_std(socket)?;
    let mut bytes = [0; RobotState::MAX_SIZE];
    let mut command = [0; RobotCommand::MAX_SIZE];
    loop {
        let mut newest = socket.recv_from(&mut bytes).await?;
        while let Ok(newer) = socket.try_recv_from(&mut bytes) {
            newest = newer;
        }
        let (length, robot): (usize, SocketAddr) = newest;
        if let Ok(state) = RobotState::decode(VERSION, &bytes[..length]) {
            let reply = reply_to(&state);
            let size = reply
                .encode(VERSION, &mut command)
                .expect("a command has at most `MAX_SIZE` bytes");
            socket.try_send_to(&command[..size], robot)?;
        }
    }
}

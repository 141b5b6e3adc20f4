//! The minimum work of any client: one receive and one send per state, on one thread.
//!
//! The client does not decode, check or compute anything. A command differs from the previous
//! command only in the `message_id` that it repeats.

use std::io::{Read as _, Write as _};
use std::net::{Ipv4Addr, TcpStream, UdpSocket};
use std::time::Duration;

use anyhow::{Context as _, bail, ensure};
use franka_proto::client::{Event, Session};
use franka_proto::framing::next_message;
use franka_proto::{
    MoveControllerMode, MoveRequest, MoveStatus, Reply, Request, RobotCommand, RobotState, Version,
};
use franka_rt::sched::{Realtime, Scheduling};

/// Answers states for `time`, then ends the motion.
pub(crate) fn run(address: &str, time: Duration, fifo: bool) -> anyhow::Result<()> {
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
    socket.set_read_timeout(Some(SILENCE))?;
    // Open until the end: closing it would end the motion.
    let _stream = begin_motion(address, socket.local_addr()?.port())?;
    if fifo {
        let asked = Scheduling {
            realtime: Realtime::Ignore,
            ..Scheduling::default()
        };
        let granted = asked.enter()?;
        ensure!(granted.priority.is_some(), "{:?}", granted.refusals);
    }
    let cycles = u64::try_from(time.as_millis())?;
    answer(&socket, cycles, &RobotCommand::default())?;
    let last = RobotCommand {
        torque_command_finished: true,
        ..RobotCommand::default()
    };
    answer(&socket, FINISHING, &last)
}

/// Connects and starts a torque motion; returns when the robot reports that it runs.
fn begin_motion(address: &str, udp_port: u16) -> anyhow::Result<TcpStream> {
    let mut stream = TcpStream::connect(address).context("connecting")?;
    let mut session = Session::new(VERSION);
    stream.write_all(session.connect(udp_port).as_bytes())?;
    let mut received = Vec::new();
    loop {
        let Some(message) = next_message(&received)? else {
            let mut portion = [0; 1024];
            let count = stream.read(&mut portion)?;
            ensure!(count > 0, "the robot has closed the connection");
            received.extend_from_slice(&portion[..count]);
            continue;
        };
        let length = message.size();
        match session.on_message(message)? {
            Event::Connected { version } => {
                let controller = MoveControllerMode::ExternalController;
                let motion = MoveRequest::new(controller, version.torque_generator());
                let motion = session.request(&Request::Move(motion))?;
                stream.write_all(motion.as_bytes())?;
            }
            Event::Reply {
                reply: Reply::Move(MoveStatus::MotionStarted),
                ..
            } => return Ok(stream),
            other => bail!("the robot does not start the motion: {other:?}"),
        }
        received.drain(..length);
    }
}

/// Answers `states` states with `command`.
fn answer(socket: &UdpSocket, states: u64, command: &RobotCommand) -> anyhow::Result<()> {
    let mut bytes = [0; RobotCommand::MAX_SIZE];
    let size = command.encode(VERSION, &mut bytes)?;
    let mut state = [0; RobotState::MAX_SIZE];
    for _ in 0..states {
        let (_, robot) = socket.recv_from(&mut state)?;
        bytes[..MESSAGE_ID].copy_from_slice(&state[..MESSAGE_ID]);
        socket.send_to(&bytes[..size], robot)?;
    }
    Ok(())
}

/// The protocol version of the FR3.
const VERSION: Version = Version::V10;

/// Both kinds of datagram begin with a `message_id` of this size.
const MESSAGE_ID: usize = size_of::<u64>();

/// Number of cycles in which a motion without torques ends.
const FINISHING: u64 = 50;

/// Time without data after which the robot counts as lost.
const SILENCE: Duration = Duration::from_secs(2);

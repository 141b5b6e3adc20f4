//! A minimal client: it connects, records the arrival times of states, and commands nothing.

use std::io::{self, Read as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpStream, UdpSocket};
use std::time::Duration;

use anyhow::{Context as _, bail, ensure};
use franka_proto::client::{Event, Session};
use franka_proto::framing::next_message;
use franka_proto::{RobotState, Version};

use crate::stamp::{self, Stamped};

/// A connection to a robot, which sends states until this value is dropped.
#[derive(Debug)]
pub(crate) struct Listener {
    socket: Stamped,
    /// Closing it would end the connection.
    _stream: TcpStream,
}

impl Listener {
    /// Connects, and returns when the first state has arrived.
    pub(crate) fn connect(robot: SocketAddr) -> anyhow::Result<Self> {
        let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
        socket.set_read_timeout(Some(SILENCE))?;
        let port = socket.local_addr()?.port();
        let mut stream = TcpStream::connect(robot).context("connecting")?;
        let mut session = Session::new(VERSION);
        stream.write_all(session.connect(port).as_bytes())?;
        let mut received = Vec::new();
        let message = loop {
            if let Some(message) = next_message(&received)? {
                break message;
            }
            let mut portion = [0; 1024];
            let count = stream.read(&mut portion)?;
            ensure!(count > 0, "the robot has closed the connection");
            received.extend_from_slice(&portion[..count]);
        };
        match session.on_message(message)? {
            Event::Connected { .. } => {}
            other => bail!("the robot does not connect: {other:?}"),
        }
        let mut listener = Self {
            socket: Stamped::new(socket)?,
            _stream: stream,
        };
        listener.receive().context("waiting for a state")?;
        Ok(listener)
    }

    /// Returns the kernel's arrival times of the states in the next `time`.
    pub(crate) fn listen(&mut self, time: Duration) -> anyhow::Result<Vec<Duration>> {
        let begin = stamp::now();
        let mut arrivals = Vec::new();
        loop {
            let arrived = self.receive()?;
            if arrived >= begin + time {
                return Ok(arrivals);
            }
            // Earlier states are still in the socket.
            if arrived >= begin {
                arrivals.push(arrived);
            }
        }
    }

    fn receive(&mut self) -> io::Result<Duration> {
        let (_, arrived) = self.socket.receive(&mut [0; RobotState::MAX_SIZE])?;
        Ok(arrived)
    }
}

/// The protocol version of the FR3.
const VERSION: Version = Version::V10;

/// Time without data after which the robot counts as lost.
const SILENCE: Duration = Duration::from_secs(2);

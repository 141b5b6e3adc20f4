//! The client that takes the least of a robot: connected, it notes when states arrive, and commands
//! nothing.

use std::io::{self, Read as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpStream, UdpSocket};
use std::time::Duration;

use anyhow::{Context as _, bail, ensure};
use franka_proto::client::{Event, Session};
use franka_proto::framing::next_message;
use franka_proto::{RobotState, Version};

use crate::stamp::{self, Stamped};

/// A connection to a robot, which sends its states as long as this lives.
#[derive(Debug)]
pub(crate) struct Listener {
    socket: Stamped,
    /// Closing it would end the connection.
    _stream: TcpStream,
}

impl Listener {
    /// Connects; returns when the first state is there.
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

    /// The kernel's times of arrival of the states of the next `time`.
    pub(crate) fn listen(&mut self, time: Duration) -> anyhow::Result<Vec<Duration>> {
        let begin = stamp::now();
        let mut arrivals = Vec::new();
        loop {
            let arrived = self.receive()?;
            if arrived >= begin + time {
                return Ok(arrivals);
            }
            // Others have waited in the socket.
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

/// The FR3's.
const VERSION: Version = Version::V10;

/// A robot that says nothing for so long is gone.
const SILENCE: Duration = Duration::from_secs(2);

//! A service of the simulator, seen as bytes.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::time::{Duration, Instant};

use franka_proto::framing::Header;
use franka_proto::{Command, Version, gripper, vacuum};
use socket2::SockRef;

/// Time limit for events that should be immediate, long enough for a busy machine.
pub(crate) const SOON: Duration = Duration::from_secs(300);

/// Port of the robot, the hand or the vacuum gripper.
pub(crate) struct Port {
    pub(crate) name: &'static str,
    pub(crate) address: SocketAddr,
    pub(crate) version: u16,
    /// Number of bytes of a command number: four for the robot, two for the end effectors.
    number: usize,
    /// Number of a command that only stops.
    pub(crate) stop: u32,
    /// Number of a command with parameters.
    pub(crate) setter: u32,
    /// Number of bytes of the answer to the handshake.
    greeting: usize,
}

impl Port {
    pub(crate) fn robot(version: Version, address: SocketAddr) -> Self {
        let number = |command| version.command_number(command).expect("both have it");
        Self {
            name: "robot",
            address,
            version: version.number(),
            number: 4,
            stop: number(Command::StopMove),
            setter: number(Command::SetLoad),
            greeting: Header::SIZE + 3,
        }
    }

    pub(crate) fn hand(address: SocketAddr) -> Self {
        Self {
            name: "Franka Hand",
            address,
            version: 3,
            number: 2,
            stop: 4,
            setter: gripper::Command::Move as u32,
            greeting: 14,
        }
    }

    pub(crate) fn vacuum_gripper(address: SocketAddr) -> Self {
        Self {
            name: "vacuum gripper",
            address,
            version: 1,
            number: 2,
            stop: 3,
            setter: vacuum::Command::DropOff as u32,
            greeting: 14,
        }
    }

    pub(crate) fn header(&self) -> usize {
        self.number + 8
    }

    /// Returns a message with its correct size.
    pub(crate) fn message(&self, command: u32, id: u32, payload: &[u8]) -> Vec<u8> {
        let size = (self.header() + payload.len()) as u32;
        [&self.announcing(size, command, id), payload].concat()
    }

    pub(crate) fn announcing(&self, size: u32, command: u32, id: u32) -> Vec<u8> {
        let mut bytes = command.to_le_bytes()[..self.number].to_vec();
        bytes.extend(id.to_le_bytes());
        bytes.extend(size.to_le_bytes());
        bytes
    }

    /// Returns the first message of a client.
    pub(crate) fn connect(&self, version: u16, udp_port: u16) -> Vec<u8> {
        let payload = [version.to_le_bytes(), udp_port.to_le_bytes()].concat();
        self.message(0, 0, &payload)
    }

    pub(crate) fn dial(&self) -> Connection {
        Connection::new(TcpStream::connect(self.address).expect("a listener"))
    }

    /// Returns a connection after the handshake, and the socket that receives the states.
    pub(crate) fn shake_hands(&self) -> (Connection, UdpSocket) {
        let begun = Instant::now();
        loop {
            let udp = UdpSocket::bind("127.0.0.1:0").expect("a port");
            udp.set_read_timeout(Some(SOON)).expect("an option");
            let port = udp.local_addr().expect("bound").port();
            let mut connection = self.dial();
            connection.send(&self.connect(self.version, port));
            if let Some(answer) = connection.read(self.greeting) {
                assert_eq!(answer[self.header()..][..1], [0], "{}", self.name);
                return (connection, udp);
            }
            // The server has not yet disconnected the previous client.
            assert!(begun.elapsed() < SOON, "{} accepts no client", self.name);
        }
    }
}

/// A client's stream.
pub(crate) struct Connection {
    stream: TcpStream,
}

impl Connection {
    fn new(stream: TcpStream) -> Self {
        stream.set_read_timeout(Some(SOON)).expect("an option");
        stream.set_write_timeout(Some(SOON)).expect("an option");
        stream.set_nodelay(true).expect("an option");
        Self { stream }
    }

    /// Address of the client's end.
    pub(crate) fn address(&self) -> SocketAddr {
        self.stream.local_addr().expect("connected")
    }

    /// Returns the same stream, for another thread.
    pub(crate) fn another(&self) -> Self {
        let stream = self.stream.try_clone().expect("a descriptor");
        Self { stream }
    }

    /// Writes bytes. It is not an error if the peer has already closed the stream.
    pub(crate) fn send(&mut self, bytes: &[u8]) {
        if let Err(error) = self.stream.write_all(bytes) {
            assert!(is_end(error.kind()), "{error}");
        }
    }

    /// Writes the bytes one by one, each in a separate segment, over half a second in total.
    pub(crate) fn trickle(&mut self, bytes: &[u8]) {
        let pause = Duration::from_millis(500) / bytes.len() as u32;
        for byte in bytes {
            self.send(&[*byte]);
            std::thread::sleep(pause);
        }
    }

    /// Returns the next bytes, unless the stream ends first.
    pub(crate) fn read(&mut self, length: usize) -> Option<Vec<u8>> {
        let mut bytes = vec![0; length];
        match self.stream.read_exact(&mut bytes) {
            Ok(()) => Some(bytes),
            Err(error) if is_end(error.kind()) => None,
            Err(error) => panic!("no answer: {error}"),
        }
    }

    /// Reads up to the end of the stream. Panics if the stream does not end.
    pub(crate) fn read_to_end(&mut self) -> Vec<u8> {
        let mut bytes = Vec::new();
        match self.stream.read_to_end(&mut bytes) {
            Ok(_) => {}
            Err(error) if is_end(error.kind()) => {}
            Err(error) => panic!("the connection stays open: {error}"),
        }
        bytes
    }

    /// Waits for a reset of the connection. Some clients understand a reset, but would wait
    /// indefinitely after an orderly close.
    pub(crate) fn expect_reset(&mut self) {
        let end = self.stream.read_exact(&mut [0; 1]);
        let end = end.map_err(|error| error.kind());
        assert_eq!(end, Err(ErrorKind::ConnectionReset));
    }

    /// Resets the connection instead of closing it.
    pub(crate) fn reset(self) {
        let socket = SockRef::from(&self.stream);
        let now = Some(Duration::ZERO);
        socket.set_linger(now).expect("an option");
    }
}

/// Waits for a state, even while the process is stopped. Returns the length and the source of the
/// state.
pub(crate) fn receive(udp: &UdpSocket, bytes: &mut [u8]) -> (usize, SocketAddr) {
    loop {
        match udp.recv_from(bytes) {
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            received => return received.expect("a state"),
        }
    }
}

fn is_end(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::UnexpectedEof | ErrorKind::ConnectionReset | ErrorKind::BrokenPipe
    )
}

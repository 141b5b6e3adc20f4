//! A misbehaving robot: the simulated robot as a value, on sockets under the control of a test.

use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, AtomicU16, AtomicU64, Ordering};
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};

use franka_async::connection::Version;
use franka_async::{Realtime, Robot};
use franka_proto::framing::{Header, next_message};
use franka_proto::{Command, RobotCommand};
use franka_sim::Config;

/// Treatment of a request.
pub(crate) enum Treatment {
    /// The robot gets it.
    Pass,
    /// It is thrown away.
    Swallow,
    /// The robot does not get it, and yet there is an answer with this status.
    Answer(u8),
}

/// Treatment of requests, and of the robot's replies.
pub(crate) struct Manners {
    pub(crate) request: fn(Option<Command>) -> Treatment,
    pub(crate) reply: fn(Vec<u8>) -> Vec<u8>,
    /// True if replies go out a byte at a time.
    pub(crate) piecewise: bool,
}

impl Default for Manners {
    fn default() -> Self {
        Self {
            request: |_| Treatment::Pass,
            reply: |reply| reply,
            piecewise: false,
        }
    }
}

/// A fault in mid-session.
enum Mischief {
    Bytes(Vec<u8>),
    /// The stream ends; states continue until the client no longer answers them.
    Close,
}

/// The robot, one client after another, until it is dropped.
pub(crate) struct Peer {
    address: SocketAddr,
    mischief: mpsc::Sender<Mischief>,
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    udp_port: AtomicU16,
    deaf: AtomicBool,
    over: AtomicBool,
    /// Bits of the speed of the fastest joint when the last client had gone, `[rad/s]`.
    speed: AtomicU64,
    goodbyes: AtomicU64,
}

impl Peer {
    pub(crate) fn start(manners: Manners) -> Self {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        listener.set_nonblocking(true).unwrap();
        let address = listener.local_addr().unwrap();
        let shared = Arc::new(Shared::default());
        let (mischief, asked) = mpsc::channel();
        let mut server = Server {
            robot: franka_sim::Robot::new(Config {
                // This thread runs when the machine lets it, so it cannot judge punctuality.
                enforce_communication: false,
                ..Config::default()
            }),
            udp: UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap(),
            manners,
            asked,
            shared: shared.clone(),
        };
        server.udp.set_nonblocking(true).unwrap();
        let shared_by_server = shared.clone();
        std::thread::spawn(move || {
            while !server.is_over() {
                match listener.accept() {
                    Ok((stream, _)) => {
                        server.robot.connect();
                        // After any end, the next client is served.
                        let _ = server.serve(&stream);
                        let speed = server.robot.dq().amax();
                        shared_by_server
                            .speed
                            .store(speed.to_bits(), Ordering::Relaxed);
                        shared_by_server.goodbyes.fetch_add(1, Ordering::Release);
                        server.robot.disconnect();
                    }
                    Err(_) => std::thread::sleep(Duration::from_millis(1)),
                }
            }
        });
        Self {
            address,
            mischief,
            shared,
        }
    }

    pub(crate) async fn connect(&self) -> Robot {
        let builder = Robot::builder(self.address).realtime(Realtime::Ignore);
        builder.connect().await.expect("a peer takes a client")
    }

    /// Writes `bytes` into the stream to the client.
    pub(crate) fn inject(&self, bytes: &[u8]) {
        self.mischief.send(Mischief::Bytes(bytes.into())).unwrap();
    }

    /// Ends the stream to the client.
    pub(crate) fn close(&self) {
        self.mischief.send(Mischief::Close).unwrap();
    }

    /// Speed of the fastest joint when a client had gone, `[rad/s]`; `None` before that.
    pub(crate) fn speed_at_goodbye(&self) -> Option<f64> {
        let gone = self.shared.goodbyes.load(Ordering::Acquire) > 0;
        gone.then(|| f64::from_bits(self.shared.speed.load(Ordering::Relaxed)))
    }

    /// Stops reading the stream permanently.
    pub(crate) fn stop_reading(&self) {
        self.shared.deaf.store(true, Ordering::Relaxed);
    }

    /// Address at which the client receives states.
    pub(crate) fn client_udp(&self) -> SocketAddr {
        let port = self.shared.udp_port.load(Ordering::Relaxed);
        (Ipv4Addr::LOCALHOST, port).into()
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        self.shared.over.store(true, Ordering::Relaxed);
    }
}

struct Server {
    robot: franka_sim::Robot,
    udp: UdpSocket,
    manners: Manners,
    asked: mpsc::Receiver<Mischief>,
    shared: Arc<Shared>,
}

impl Server {
    fn is_over(&self) -> bool {
        self.shared.over.load(Ordering::Relaxed)
    }

    fn serve(&mut self, mut stream: &TcpStream) -> std::io::Result<()> {
        stream.set_nonblocking(true)?;
        stream.set_nodelay(true)?;
        let (mut received, mut outgoing) = (Vec::new(), Vec::new());
        let mut deadline = Instant::now();
        // Cycles without a command since we ended the stream.
        let mut unanswered = None;
        while !self.is_over() && unanswered < Some(GOODBYE) {
            deadline = (deadline + Duration::from_millis(1)).max(Instant::now());
            std::thread::sleep(deadline.saturating_duration_since(Instant::now()));
            if !self.shared.deaf.load(Ordering::Relaxed) {
                let mut buffer = [0; 4096];
                match stream.read(&mut buffer) {
                    Ok(0) if unanswered.is_some() => {}
                    Ok(0) => return Ok(()),
                    Ok(length) => received.extend_from_slice(&buffer[..length]),
                    Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                    Err(error) => return Err(error),
                }
            }
            self.requests(&mut received, stream)?;
            let mut command = [0; RobotCommand::MAX_SIZE];
            unanswered = unanswered.map(|cycles| cycles + 1);
            while let Ok((length, _)) = self.udp.recv_from(&mut command) {
                unanswered = unanswered.map(|_| 0);
                self.robot.command(&command[..length]);
            }
            if let Some(datagram) = self.robot.tick() {
                self.shared.udp_port.store(datagram.port, Ordering::Relaxed);
                let client = (Ipv4Addr::LOCALHOST, datagram.port);
                // The client may have disconnected.
                let _ = self.udp.send_to(datagram.bytes, client);
            }
            while let Some(part) = self.robot.take_reply() {
                outgoing.extend_from_slice(&part);
            }
            while let Ok(Some(message)) = next_message(&outgoing) {
                let rest = outgoing.split_off(message.size());
                let whole = std::mem::replace(&mut outgoing, rest);
                let reply = (self.manners.reply)(whole);
                let portion = if self.manners.piecewise {
                    1
                } else {
                    reply.len().max(1)
                };
                for portion in reply.chunks(portion) {
                    stream.write_all(portion)?;
                }
            }
            for mischief in self.asked.try_iter() {
                match mischief {
                    Mischief::Bytes(bytes) => stream.write_all(&bytes)?,
                    Mischief::Close => {
                        stream.shutdown(Shutdown::Write)?;
                        unanswered = Some(0);
                    }
                }
            }
        }
        Ok(())
    }

    fn requests(&mut self, received: &mut Vec<u8>, mut stream: &TcpStream) -> std::io::Result<()> {
        while let Ok(Some(message)) = next_message(received) {
            let (header, size) = (message.header, message.size());
            match (self.manners.request)(Version::V10.command_from_number(header.command)) {
                Treatment::Pass => {
                    // These tests do not cover clients that violate the protocol.
                    let _ = self.robot.receive(&received[..size]);
                }
                Treatment::Swallow => {}
                Treatment::Answer(status) => stream.write_all(&reply(header, status))?,
            }
            received.drain(..size);
        }
        Ok(())
    }
}

/// Cycles without a command after which a client whose stream we have ended counts as gone.
const GOODBYE: u32 = 100;

/// A reply of one status byte to the request with this header.
pub(crate) fn reply(request: Header, status: u8) -> Vec<u8> {
    let size = Header::SIZE as u32 + 1;
    let mut bytes = Header { size, ..request }.to_bytes().to_vec();
    bytes.push(status);
    bytes
}

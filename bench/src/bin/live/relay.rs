//! A relay between client and robot: it forwards everything, and records the traffic and its times.
//!
//! A relay measures every client at the same place, in any language, and requires no change of
//! client or robot. Its extra hop is not part of the measurement: a turnaround begins when the
//! relay passes a state to the kernel, and ends with the kernel's stamp on the command. The relay's
//! own scheduling affects neither.
//!
//! The UDP port in a client's `Connect` is replaced by the relay's own; the rest of the stream is
//! forwarded unchanged.

use std::any::Any;
use std::io::{self, Read as _, Write as _};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use std::time::Duration;

use franka_proto::framing::{Header, next_message};
use franka_proto::wire::service::ConnectRequest;
use franka_proto::{RobotCommand, RobotState, Version};
use franka_rt::sched::{Realtime, Scheduling};
use zerocopy::FromBytes as _;

use crate::stamp::{self, Stamped};
use crate::trace::{CommandArrival, Departure, Trace};

/// A relay for one connection of one client. Dropping it waits until the client has disconnected.
#[derive(Debug)]
pub(crate) struct Relay {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<io::Result<Trace>>>,
}

#[derive(Debug, Default)]
struct Shared {
    stop: AtomicBool,
    commands: AtomicU64,
}

impl Relay {
    /// Waits at `listen` for a client of the robot at `robot`.
    pub(crate) fn start(listen: SocketAddr, robot: SocketAddr) -> io::Result<Self> {
        let listener = TcpListener::bind(listen)?;
        let shared = Arc::new(Shared::default());
        let thread = std::thread::spawn({
            let shared = shared.clone();
            move || match accept(listener, &shared)? {
                Some(client) => serve(client, robot, &shared),
                None => Ok(Trace::default()),
            }
        });
        Ok(Self {
            shared,
            thread: Some(thread),
        })
    }

    /// Number of commands forwarded so far.
    pub(crate) fn commands(&self) -> u64 {
        // Relaxed: the number guards no other data.
        self.shared.commands.load(Ordering::Relaxed)
    }

    /// Returns the recorded traffic. Call it after the client has disconnected.
    pub(crate) fn finish(mut self) -> anyhow::Result<Trace> {
        Ok(self.join()?)
    }

    fn join(&mut self) -> io::Result<Trace> {
        self.shared.stop.store(true, Ordering::Relaxed);
        match self.thread.take() {
            Some(thread) => thread.join().map_err(panicked)?,
            None => Ok(Trace::default()),
        }
    }
}

impl Drop for Relay {
    fn drop(&mut self) {
        // The trace of a failed client is not needed.
        let _ = self.join();
    }
}

impl Shared {
    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Accepts the client; `None` if the relay is stopped before.
fn accept(listener: TcpListener, shared: &Shared) -> io::Result<Option<TcpStream>> {
    listener.set_nonblocking(true)?;
    while !shared.stopped() {
        match listener.accept() {
            Ok((client, _)) => {
                client.set_nonblocking(false)?;
                return Ok(Some(client));
            }
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => std::thread::sleep(TICK),
            Err(error) => return Err(error),
        }
    }
    Ok(None)
}

/// Relays until either side closes the stream and the relay is stopped.
fn serve(mut client: TcpStream, robot: SocketAddr, shared: &Arc<Shared>) -> io::Result<Trace> {
    let mut robot = TcpStream::connect(robot)?;
    for stream in [&client, &robot] {
        stream.set_nodelay(true)?;
    }
    // A client accepts states only from the robot's address, which for the client is the relay's.
    let to_client = UdpSocket::bind((client.local_addr()?.ip(), 0))?;
    let to_robot = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
    for socket in [&to_client, &to_robot] {
        socket.set_read_timeout(Some(TICK))?;
    }
    let announced = to_robot.local_addr()?.port();
    let mut hello = read_message(&mut client)?;
    let (version, port) = replace_port(&mut hello, announced)?;
    let client_address = SocketAddr::new(client.peer_addr()?.ip(), port);
    let robot_address = Arc::new(OnceLock::new());

    let states = real_time({
        let (shared, robot_address) = (shared.clone(), robot_address.clone());
        let (from_robot, to_client) = (to_robot.try_clone()?, to_client.try_clone()?);
        let to = (to_client, client_address);
        move || pass_states(version, &from_robot, to, &robot_address, &shared)
    })?;
    let commands = real_time({
        let shared = shared.clone();
        let from_client = Stamped::new(to_client)?;
        move || pass_commands(version, from_client, &to_robot, &robot_address, &shared)
    })?;

    robot.write_all(&hello)?;
    let down = std::thread::spawn({
        let (from, to) = (robot.try_clone()?, client.try_clone()?);
        move || copy(from, to)
    });
    copy(client, robot);
    down.join().map_err(panicked)?;
    Ok(Trace {
        departures: states.join().map_err(panicked)??,
        answers: commands.join().map_err(panicked)??,
    })
}

/// Forwards a stream and its end. A broken stream counts as ended.
fn copy(mut from: TcpStream, mut to: TcpStream) {
    let _ = io::copy(&mut from, &mut to);
    let _ = to.shutdown(Shutdown::Write);
}

/// Starts a thread with a priority just below the client's.
fn real_time<T: Send + 'static>(
    run: impl FnOnce() -> T + Send + 'static,
) -> io::Result<JoinHandle<T>> {
    std::thread::Builder::new().spawn(|| {
        let asked = Scheduling {
            realtime: Realtime::Ignore,
            priority: Some(PRIORITY),
            ..Scheduling::default()
        };
        // Without the priority, states leave less regularly, but turnarounds are still measured
        // correctly.
        let _ = asked.enter();
        run()
    })
}

/// Forwards states, robot to client.
fn pass_states(
    version: Version,
    from_robot: &UdpSocket,
    (to_client, client): (UdpSocket, SocketAddr),
    robot_address: &OnceLock<SocketAddr>,
    shared: &Shared,
) -> io::Result<Vec<Departure>> {
    let mut departures = Vec::with_capacity(RESERVED);
    let mut buffer = [0; RobotState::MAX_SIZE];
    while !shared.stopped() {
        let Some((length, sender)) = waited(from_robot.recv_from(&mut buffer))? else {
            continue;
        };
        let left = stamp::now();
        // A client that is disconnecting may have closed its port.
        let _ = to_client.send_to(&buffer[..length], client);
        robot_address.get_or_init(|| sender);
        if let Ok(state) = RobotState::decode(version, &buffer[..length]) {
            departures.push(Departure {
                id: state.message_id,
                left,
                success_rate: state.control_command_success_rate,
                mode: state.robot_mode,
            });
        }
    }
    Ok(departures)
}

/// Forwards commands, client to robot.
fn pass_commands(
    version: Version,
    mut from_client: Stamped,
    to_robot: &UdpSocket,
    robot_address: &OnceLock<SocketAddr>,
    shared: &Shared,
) -> io::Result<Vec<CommandArrival>> {
    let mut answers = Vec::with_capacity(RESERVED);
    let mut buffer = [0; RobotCommand::MAX_SIZE];
    while !shared.stopped() {
        let Some((length, arrived)) = waited(from_client.receive(&mut buffer))? else {
            continue;
        };
        // A command answers a state, so its sender is known.
        if let Some(address) = robot_address.get() {
            let _ = to_robot.send_to(&buffer[..length], address);
        }
        if let Ok(command) = RobotCommand::decode(version, &buffer[..length]) {
            answers.push(CommandArrival {
                id: command.message_id,
                arrived,
            });
            shared.commands.fetch_add(1, Ordering::Relaxed);
        }
    }
    Ok(answers)
}

/// Returns the received data; `None` if the wait timed out.
fn waited<T>(received: io::Result<T>) -> io::Result<Option<T>> {
    match received {
        Ok(received) => Ok(Some(received)),
        Err(error) => match error.kind() {
            // The last means that one of our datagrams reached a closed port.
            io::ErrorKind::WouldBlock
            | io::ErrorKind::TimedOut
            | io::ErrorKind::Interrupted
            | io::ErrorKind::ConnectionRefused => Ok(None),
            _ => Err(error),
        },
    }
}

fn panicked(_: Box<dyn Any + Send>) -> io::Error {
    io::Error::other("a thread of the relay panicked")
}

/// Reads the first message of a stream, and any bytes that arrived with it.
fn read_message(stream: &mut TcpStream) -> io::Result<Vec<u8>> {
    let mut received = Vec::new();
    while next_message(&received).map_err(io::Error::other)?.is_none() {
        let mut portion = [0; 1024];
        let count = stream.read(&mut portion)?;
        if count == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        received.extend_from_slice(&portion[..count]);
    }
    Ok(received)
}

/// Replaces the UDP port in `Connect` by `port`; returns the version and the port that the client
/// announced.
fn replace_port(hello: &mut [u8], port: u16) -> io::Result<(Version, u16)> {
    let payload = &mut hello[Header::SIZE..];
    let Ok((request, _)) = ConnectRequest::mut_from_prefix(payload) else {
        return Err(io::Error::other("the first message is not a Connect"));
    };
    let version = request.version.get();
    let version = Version::from_number(version)
        .ok_or_else(|| io::Error::other(format!("protocol {version} is not known")))?;
    let announced = request.udp_port.get();
    request.udp_port = port.into();
    Ok((version, announced))
}

/// Interval at which the threads check for a stop.
const TICK: Duration = Duration::from_millis(20);

/// Below the priority of a client, which is 99 by default.
const PRIORITY: i32 = 50;

/// Capacity allocated at the start, in datagrams: more than five minutes.
const RESERVED: usize = 400_000;

#[cfg(test)]
mod tests {
    use franka_proto::client::Session;

    use super::*;

    #[test]
    fn the_port_of_the_client_is_replaced_by_that_of_the_relay() {
        for version in [Version::V5, Version::V10] {
            let hello = Session::new(version).connect(4711);
            let mut bytes = hello.as_bytes().to_vec();
            assert_eq!(replace_port(&mut bytes, 815).unwrap(), (version, 4711));
            assert_eq!(bytes, Session::new(version).connect(815).as_bytes());
        }
    }

    #[test]
    fn a_stream_without_connect_is_refused() {
        let header = Header {
            command: 2,
            command_id: 0,
            size: Header::SIZE as u32,
        };
        let error = replace_port(&mut header.to_bytes(), 815).unwrap_err();
        assert!(error.to_string().contains("not a Connect"), "{error}");
    }

    #[test]
    fn an_unused_relay_has_an_empty_trace() {
        let any = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        let relay = Relay::start(any, any).unwrap();
        assert_eq!(relay.commands(), 0);
        assert_eq!(relay.finish().unwrap(), Trace::default());
    }
}

//! One client's connection through the tap, with two streams and two directions of datagrams.

use std::io::{self, Read as _, Write as _};
use std::net::{IpAddr, Shutdown, SocketAddr, TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use franka_proto::wire::service::ConnectRequest;
use zerocopy::FromBytes as _;

use super::Route;
use super::journal::{Lane, Recorder, Source};
use crate::cassette::polling::{TICK, is_timeout};
use crate::cassette::{Device, Payload, Side};

/// State that the threads of a link share.
struct Link<'a> {
    stop: &'a AtomicBool,
    /// Time at which the first of the two streams ended.
    ended: OnceLock<Instant>,
    /// True if both streams have ended.
    over: AtomicBool,
    /// The client's address for datagrams.
    client: OnceLock<SocketAddr>,
    /// The address from which the robot sends datagrams. The tap sends commands to this address.
    robot: Mutex<Option<SocketAddr>>,
}

impl Link<'_> {
    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.over.load(Ordering::Relaxed)
    }

    /// Returns true if a silent stream must be closed because the other stream ended some time ago.
    /// This happens, for example, after a power failure.
    fn abandoned(&self) -> bool {
        let ended = self.ended.get();
        self.stopped() || ended.is_some_and(|ended| ended.elapsed() > LINGER)
    }
}

/// Forwards data until both sides have closed their streams or the tap is stopped. If the robot is
/// unreachable, this function logs the error and closes the client's connection immediately.
pub(super) fn serve(
    client: TcpStream,
    route: Route,
    connection: usize,
    recorder: &Recorder,
    stop: &AtomicBool,
) {
    let lane = |from, stream| {
        recorder.lane(Source {
            connection,
            device: route.device,
            from,
            stream,
        })
    };
    let mut refused = lane(Side::Robot, true);
    if let Err(error) = forward(&client, route, &lane, stop) {
        let Route { device, robot, .. } = route;
        tracing::warn!("refused a client: no {device} at {robot}: {error}");
        refused.note(refused.now(), Payload::End);
    }
    // The socket may be closed already.
    let _ = client.shutdown(Shutdown::Both);
}

fn forward(
    client: &TcpStream,
    route: Route,
    lane: &(impl Fn(Side, bool) -> Lane + Sync),
    stop: &AtomicBool,
) -> io::Result<()> {
    let robot = TcpStream::connect_timeout(&route.robot, CONNECT_TIME_MAX)?;
    // On some systems, a connection inherits this option from its listener.
    client.set_nonblocking(false)?;
    for stream in [client, &robot] {
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(TICK))?;
    }
    // A client accepts states only from the robot's address, which for the client is the address of
    // the tap.
    let to_client = UdpSocket::bind((client.local_addr()?.ip(), 0))?;
    let to_robot = UdpSocket::bind((robot.local_addr()?.ip(), 0))?;
    for socket in [&to_client, &to_robot] {
        socket.set_read_timeout(Some(TICK))?;
    }
    let port = to_robot.local_addr()?.port();
    let client_ip = client.peer_addr()?.ip();
    let link = Link {
        stop,
        ended: OnceLock::new(),
        over: AtomicBool::new(false),
        client: OnceLock::new(),
        robot: Mutex::new(None),
    };
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let lane = lane(Side::Robot, false);
            pass_states(&link, route.robot.ip(), &to_robot, &to_client, lane);
        });
        scope.spawn(|| {
            let lane = lane(Side::Client, false);
            pass_commands(&link, client_ip, &to_client, &to_robot, lane);
        });
        let down = scope.spawn(|| {
            let unchanged = |bytes: &[u8]| bytes.to_vec();
            copy(&link, &robot, client, lane(Side::Robot, true), unchanged);
        });
        let mut handshake = Handshake::new(route.device, port);
        let announce = |bytes: &[u8]| {
            let bytes = handshake.pass(bytes);
            if let Some(port) = handshake.announced {
                link.client.get_or_init(|| (client_ip, port).into());
            }
            bytes
        };
        copy(&link, client, &robot, lane(Side::Client, true), announce);
        let _ = down.join();
        link.over.store(true, Ordering::Relaxed);
    });
    Ok(())
}

/// Forwards a stream and its end. A broken stream counts as ended.
fn copy(
    link: &Link<'_>,
    mut from: &TcpStream,
    mut to: &TcpStream,
    mut lane: Lane,
    mut passed: impl FnMut(&[u8]) -> Vec<u8>,
) {
    let mut buffer = vec![0; STREAM_BUFFER];
    loop {
        match from.read(&mut buffer) {
            Ok(0) => break,
            Ok(length) => {
                let at = lane.now();
                let received = &buffer[..length];
                let sent = to.write_all(&passed(received));
                lane.note(at, Payload::Stream(received.to_vec()));
                if sent.is_err() {
                    // The receiver has disconnected, so the sender's stream must end, too.
                    let _ = from.shutdown(Shutdown::Both);
                    break;
                }
            }
            Err(error) if is_timeout(&error) && !link.abandoned() => {}
            Err(_) => break,
        }
    }
    lane.note(lane.now(), Payload::End);
    link.ended.get_or_init(Instant::now);
    let _ = to.shutdown(Shutdown::Write);
}

/// Forwards the robot's datagrams.
fn pass_states(link: &Link<'_>, robot: IpAddr, from: &UdpSocket, to: &UdpSocket, mut lane: Lane) {
    let mut buffer = vec![0; DATAGRAM_BUFFER];
    while !link.stopped() {
        let Some((length, sender)) = received(from, &mut buffer) else {
            continue;
        };
        if sender.ip() != robot {
            continue;
        }
        let at = lane.now();
        if let Some(client) = link.client.get() {
            // A client that is disconnecting may have closed its port.
            let _ = to.send_to(&buffer[..length], client);
        }
        *link.robot.lock().unwrap_or_else(PoisonError::into_inner) = Some(sender);
        lane.note(at, Payload::Datagram(buffer[..length].to_vec()));
    }
}

/// Forwards the client's datagrams to the source address of the newest state.
fn pass_commands(
    link: &Link<'_>,
    client: IpAddr,
    from: &UdpSocket,
    to: &UdpSocket,
    mut lane: Lane,
) {
    let mut buffer = vec![0; DATAGRAM_BUFFER];
    while !link.stopped() {
        let Some((length, sender)) = received(from, &mut buffer) else {
            continue;
        };
        if sender.ip() != client {
            continue;
        }
        let at = lane.now();
        let robot = *link.robot.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(robot) = robot {
            let _ = to.send_to(&buffer[..length], robot);
        }
        lane.note(at, Payload::Datagram(buffer[..length].to_vec()));
    }
}

/// Returns a datagram and its sender; `None` if no datagram arrived within the socket's timeout.
fn received(socket: &UdpSocket, buffer: &mut [u8]) -> Option<(usize, SocketAddr)> {
    match socket.recv_from(buffer) {
        Ok(received) => Some(received),
        Err(error) => {
            // Other errors return immediately, for example if an earlier datagram reached a closed
            // port.
            if !is_timeout(&error) && error.kind() != io::ErrorKind::ConnectionRefused {
                std::thread::sleep(TICK);
            }
            None
        }
    }
}

/// The client's stream up to the end of `Connect`, in which the tap replaces the port.
struct Handshake {
    device: Device,
    port: u16,
    waiting: Option<Vec<u8>>,
    announced: Option<u16>,
}

impl Handshake {
    fn new(device: Device, port: u16) -> Self {
        Self {
            device,
            port,
            waiting: Some(Vec::new()),
            announced: None,
        }
    }

    fn pass(&mut self, bytes: &[u8]) -> Vec<u8> {
        let Some(mut waiting) = self.waiting.take() else {
            return bytes.to_vec();
        };
        waiting.extend_from_slice(bytes);
        match self.device.next_message(&waiting) {
            Ok(None) => {
                self.waiting = Some(waiting);
                Vec::new()
            }
            Ok(Some(message)) if message.header.command == 0 => {
                let payload = message.size() - message.payload.len();
                let request = ConnectRequest::mut_from_prefix(&mut waiting[payload..]);
                if let Ok((request, _)) = request {
                    self.announced = Some(request.udp_port.get());
                    request.udp_port = self.port.into();
                }
                waiting
            }
            // These bytes are not a client's handshake. The robot decides how to answer them.
            Ok(Some(_)) | Err(_) => waiting,
        }
    }
}

/// Time limit for a connection to the robot.
const CONNECT_TIME_MAX: Duration = Duration::from_secs(1);

/// Time for which one side may stay open after the other side has closed its stream.
const LINGER: Duration = Duration::from_secs(1);

/// Size of the stream buffer. All messages fit, except the model library of protocol 5, whose size
/// is one megabyte.
const STREAM_BUFFER: usize = 64 << 10;

/// Size of the datagram buffer. The longest datagram has 2373 bytes.
const DATAGRAM_BUFFER: usize = 4096;

#[cfg(test)]
mod tests {
    use franka_proto::client::Session;
    use franka_proto::{Protocol, Version, gripper, vacuum};

    use super::*;

    /// Checks the handshake for every split of the stream.
    fn check<P: Protocol>(device: Device, version: P) {
        let hello = Session::new(version).connect(4711);
        let expected = Session::new(version).connect(815);
        for cut in 0..hello.as_bytes().len() {
            let mut handshake = Handshake::new(device, 815);
            let (first, second) = hello.as_bytes().split_at(cut);
            let mut passed = handshake.pass(first);
            passed.extend(handshake.pass(second));
            passed.extend(handshake.pass(&[9, 9]));
            assert_eq!(passed, [expected.as_bytes(), &[9, 9]].concat());
            assert_eq!(handshake.announced, Some(4711));
        }
    }

    #[test]
    fn the_port_of_the_client_is_replaced() {
        check(Device::Robot, Version::V5);
        check(Device::Robot, Version::V10);
        check(Device::Hand, gripper::Version::V3);
        check(Device::VacuumGripper, vacuum::Version::V1);
    }

    #[test]
    fn a_stream_without_connect_passes_as_it_is() {
        let mut handshake = Handshake::new(Device::Robot, 815);
        let garbage = [0xff; 30];
        assert_eq!(handshake.pass(&garbage), garbage);
        assert_eq!(handshake.announced, None);
    }
}

//! Round-trip time of packets to the robot, measured with echo requests (ICMP), as `ping`
//! sends them.

use core::time::Duration;
use std::io;
use std::net::{Ipv4Addr, SocketAddrV4, UdpSocket};
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Instant;

use socket2::{Domain, Protocol, Socket, Type};

/// The result of echo requests to the robot.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RoundTrips {
    /// Number of requests sent.
    pub sent: u64,
    /// Time of each answer that arrived within 100 ms, in any order.
    pub times: Vec<Duration>,
}

/// Sends `count` echo requests to `robot`, at most one per millisecond, and waits for each answer.
/// Ends early if no answers arrive. `done` counts the requests sent.
pub(crate) fn measure(robot: Ipv4Addr, count: u64, done: &AtomicU64) -> io::Result<RoundTrips> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::ICMPV4))?;
    socket.connect(&SocketAddrV4::new(robot, 0).into())?;
    // The kernel fills in the identifier and the checksum, and delivers answers only to this
    // socket.
    let socket = UdpSocket::from(socket);
    let mut measured = RoundTrips::default();
    let mut lost_in_a_row = 0;
    let mut due = Instant::now();
    for number in 0..count {
        thread::sleep(due.saturating_duration_since(Instant::now()));
        let sent = Instant::now();
        socket.send(&request(number))?;
        measured.sent += 1;
        match answer(&socket, number, sent) {
            Some(time) => {
                measured.times.push(time);
                lost_in_a_row = 0;
            }
            None => lost_in_a_row += 1,
        }
        done.store(number + 1, Ordering::Relaxed);
        if lost_in_a_row == LOST_MAX {
            break;
        }
        // Missed periods are not repeated.
        due = Instant::now().max(due + PERIOD);
    }
    Ok(measured)
}

/// Returns an echo request: type, code, checksum, identifier, sequence number, `number`, and zeros.
fn request(number: u64) -> [u8; PACKET] {
    let mut packet = [0; PACKET];
    packet[0] = ECHO_REQUEST;
    packet[6..8].copy_from_slice(&(number as u16).to_be_bytes());
    packet[8..16].copy_from_slice(&number.to_be_bytes());
    packet
}

/// Returns the time from the request to its answer; `None` if the answer does not arrive within
/// [`PATIENCE`].
fn answer(socket: &UdpSocket, number: u64, sent: Instant) -> Option<Duration> {
    let mut packet = [0; PACKET];
    loop {
        let remaining = PATIENCE.checked_sub(sent.elapsed())?;
        // A timeout of zero would mean no timeout.
        let remaining = remaining.max(Duration::from_micros(1));
        socket.set_read_timeout(Some(remaining)).ok()?;
        let length = match socket.recv(&mut packet) {
            Ok(length) => length,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            // The timeout expired, or a router on the path reported that the robot is unreachable.
            Err(_) => return None,
        };
        let time = sent.elapsed();
        if length == PACKET && packet[0] == ECHO_REPLY && packet[8..16] == number.to_be_bytes() {
            return Some(time);
        }
    }
}

/// Number of bytes of an echo request after its header of eight bytes. The vendor's test uses the
/// same number.
pub(crate) const PAYLOAD: usize = 1200;

const PACKET: usize = 8 + PAYLOAD;

/// Type of an ICMP echo request (RFC 792).
const ECHO_REQUEST: u8 = 8;
const ECHO_REPLY: u8 = 0;

/// Interval between requests.
pub(crate) const PERIOD: Duration = Duration::from_millis(1);

/// Time after which an answer counts as lost.
const PATIENCE: Duration = Duration::from_millis(100);

/// Number of consecutive unanswered requests after which the measurement ends.
const LOST_MAX: u32 = 20;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_host_answers_itself_where_such_sockets_are_allowed() {
        let done = AtomicU64::new(0);
        match measure(Ipv4Addr::LOCALHOST, 20, &done) {
            Ok(measured) => {
                assert_eq!((measured.sent, done.into_inner()), (20, 20));
                // A busy host may be late for some requests.
                assert!(!measured.times.is_empty());
            }
            Err(error) => assert_eq!(error.kind(), io::ErrorKind::PermissionDenied),
        }
    }
}

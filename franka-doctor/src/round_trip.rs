//! How long packets take to the robot and back: echo requests (ICMP), as `ping` sends them.

use core::time::Duration;
use std::io;
use std::net::{Ipv4Addr, SocketAddrV4, UdpSocket};
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::Instant;

use socket2::{Domain, Protocol, Socket, Type};

/// Echo requests to the robot, and the times until their answers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RoundTrips {
    /// Requests sent.
    pub sent: u64,
    /// Of each request that was answered within 100 ms, in any order.
    pub times: Vec<Duration>,
}

/// Sends `count` echo requests to `robot`, one each millisecond at most, and waits for each answer.
/// Ends early if nobody answers. `done` is set to how many were sent.
pub(crate) fn measure(robot: Ipv4Addr, count: u64, done: &AtomicU64) -> io::Result<RoundTrips> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::ICMPV4))?;
    socket.connect(&SocketAddrV4::new(robot, 0).into())?;
    // The kernel fills in identifier and checksum, and hands on answers to this socket alone.
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
        // What was missed meanwhile is not made up for.
        due = Instant::now().max(due + PERIOD);
    }
    Ok(measured)
}

/// An echo request: type, code, checksum, identifier, sequence number, then the number and zeros.
fn request(number: u64) -> [u8; PACKET] {
    let mut packet = [0; PACKET];
    packet[0] = ECHO_REQUEST;
    packet[6..8].copy_from_slice(&(number as u16).to_be_bytes());
    packet[8..16].copy_from_slice(&number.to_be_bytes());
    packet
}

/// The time until the answer to this request, if it comes within [`PATIENCE`].
fn answer(socket: &UdpSocket, number: u64, sent: Instant) -> Option<Duration> {
    let mut packet = [0; PACKET];
    loop {
        let remaining = PATIENCE.checked_sub(sent.elapsed())?;
        // A timeout of zero would mean none.
        let remaining = remaining.max(Duration::from_micros(1));
        socket.set_read_timeout(Some(remaining)).ok()?;
        let length = match socket.recv(&mut packet) {
            Ok(length) => length,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            // The time is up, or a router on the way says that there is no way.
            Err(_) => return None,
        };
        let time = sent.elapsed();
        if length == PACKET && packet[0] == ECHO_REPLY && packet[8..16] == number.to_be_bytes() {
            return Some(time);
        }
    }
}

/// Bytes of an echo request besides its header of eight, as in the vendor's test.
pub(crate) const PAYLOAD: usize = 1200;

const PACKET: usize = 8 + PAYLOAD;

/// RFC 792.
const ECHO_REQUEST: u8 = 8;
const ECHO_REPLY: u8 = 0;

/// From one request to the next.
pub(crate) const PERIOD: Duration = Duration::from_millis(1);

/// An answer that takes longer counts as lost.
const PATIENCE: Duration = Duration::from_millis(100);

/// After so many without an answer in a row, no more are sent.
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
                // A host that is busy with something else may be late for some.
                assert!(!measured.times.is_empty());
            }
            Err(error) => assert_eq!(error.kind(), io::ErrorKind::PermissionDenied),
        }
    }
}

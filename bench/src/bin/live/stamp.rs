//! Datagrams with the kernel's arrival time.
//!
//! The kernel stamps a datagram when the network layer receives it. On the loopback device this
//! happens within the sender's system call, so the stamp does not depend on the time of the read.

use std::io::{self, IoSliceMut};
use std::net::UdpSocket;
use std::os::fd::AsRawFd as _;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use nix::sys::socket::{ControlMessageOwned, MsgFlags, recvmsg, setsockopt, sockopt};
use nix::sys::time::TimeSpec;

/// A socket whose datagrams are stamped.
#[derive(Debug)]
pub(crate) struct Stamped {
    socket: UdpSocket,
    control: Vec<u8>,
}

impl Stamped {
    /// Makes the kernel stamp the datagrams that arrive from now on.
    pub(crate) fn new(socket: UdpSocket) -> io::Result<Self> {
        setsockopt(&socket, sockopt::ReceiveTimestampns, &true)?;
        let control = nix::cmsg_space!(TimeSpec);
        Ok(Self { socket, control })
    }

    /// Waits for a datagram. Returns its length, and its arrival time since the epoch.
    pub(crate) fn receive(&mut self, buffer: &mut [u8]) -> io::Result<(usize, Duration)> {
        let mut parts = [IoSliceMut::new(buffer)];
        let control = Some(&mut self.control[..]);
        let fd = self.socket.as_raw_fd();
        let message = recvmsg::<()>(fd, &mut parts, control, MsgFlags::empty())?;
        let arrived = message.cmsgs()?.find_map(|control| match control {
            ControlMessageOwned::ScmTimestampns(time) => Some(Duration::from(time)),
            _ => None,
        });
        let arrived = arrived.ok_or_else(|| io::Error::other("the kernel stamped no datagram"))?;
        Ok((message.bytes, arrived))
    }
}

/// Returns the current time since the epoch, on the clock of the kernel's stamps.
pub(crate) fn now() -> Duration {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .expect("the epoch is past")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stamp_is_the_time_of_arrival_and_not_of_reading() {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let address = socket.local_addr().unwrap();
        let mut stamped = Stamped::new(socket).unwrap();
        let sender = UdpSocket::bind("127.0.0.1:0").unwrap();
        let pause = Duration::from_millis(20);
        // The kernel enables time stamps in the background.
        std::thread::sleep(pause);
        let before = now();
        sender.send_to(&[7; 5], address).unwrap();
        let after = now();
        std::thread::sleep(pause);
        let mut buffer = [0; 8];
        let (length, arrived) = stamped.receive(&mut buffer).unwrap();
        assert_eq!((length, buffer[4]), (5, 7));
        assert!(before <= arrived && arrived <= after, "{arrived:?}");
    }
}

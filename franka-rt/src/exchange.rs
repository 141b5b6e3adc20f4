//! The UDP side of a connection: receives the robot's newest state, and sends one command back to
//! the sender of that state. Duplicates and states that a newer state has overtaken are dropped and
//! counted.
//!
//! The robot sends one state per millisecond, and a delayed host finds several of them waiting. The
//! newest state wins. [`Exchange::receive`] waits for a datagram, then reads all that are there. It
//! keeps the state with the highest `message_id`, if that is above the last one kept and not
//! impossibly far ahead of it. Datagrams from other addresses than the robot's are dropped and
//! counted. Nothing here allocates after [`Exchange::new`].

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::time::Duration;

use socket2::{SockAddr, Socket};

use crate::sys;

/// Opens the socket that `robot` sends its states to: any address of the robot's family, IPv4 or
/// IPv6, and a free port, which `Connect` must announce. States that arrive before the thread
/// starts wait in the kernel.
///
/// # Errors
/// The system refuses a socket or a port.
pub fn bind(robot: IpAddr) -> io::Result<UdpSocket> {
    // IPv4-mapped IPv6 counts as IPv4.
    match robot.to_canonical() {
        IpAddr::V4(_) => UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)),
        IpAddr::V6(_) => UdpSocket::bind((Ipv6Addr::UNSPECIFIED, 0)),
    }
}

/// Longest wait of [`Exchange::receive`]. While the robot is silent, the thread therefore sees an
/// order or a request to stop within this time.
pub const TICK: Duration = Duration::from_millis(20);

/// Returns the time to wait for a state so that a silence of `link_timeout` is noticed: a quarter
/// of it, and at most a [`TICK`].
///
/// A loss is noticed late by at most a quarter, and by two of the kernel's clock ticks (4 ms at 250
/// Hz), in which the kernel counts such waits.
pub fn wait_for(link_timeout: Duration) -> Duration {
    (link_timeout / 4).clamp(MIN_WAIT, TICK)
}

/// The shortest wait. A wait that rounds to zero would be no wait, or last forever.
const MIN_WAIT: Duration = Duration::from_millis(1);

/// Receives states and sends commands.
#[derive(Debug)]
pub struct Exchange {
    socket: Socket,
    robot: IpAddr,
    /// The newest state, in its first `state_size` bytes.
    newest: Box<[u8]>,
    /// Buffer of the next datagram; swapped with `newest` if the datagram is newer.
    incoming: Box<[u8]>,
    /// `message_id` of `newest`.
    message_id: Option<u64>,
    /// Sender of `newest`, to which commands are sent.
    reply_to: Option<SockAddr>,
    /// Longest time that each receive waits for a datagram.
    wait: Duration,
    /// True if the last receive failed. Finding nothing is no failure.
    failed: bool,
}

/// Result of one call of [`Exchange::receive`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reception {
    /// True if there is a newer state than before; [`Exchange::state`] has it.
    pub fresh: bool,
    /// Number of states that were newer than before and were skipped for a still newer one.
    pub skipped: u64,
    /// Number of states that are not newer than the newest: overtaken or duplicate ones.
    pub stale: u64,
    /// Number of datagrams from other addresses than the robot's.
    pub foreign: u64,
    /// Number of datagrams of the robot that are too short for a state.
    pub short: u64,
    /// Length in bytes of the last short datagram; 0 without one.
    pub short_length: usize,
    /// `message_id` of the last state that was dropped because it was more than [`LEAP_MAX`] above
    /// the newest; `None` without such a state.
    pub leap: Option<u64>,
    /// Length of the wait, if no datagram came; zero otherwise.
    pub waited: Duration,
    /// errno value of a receive that failed. Finding nothing is no failure.
    pub error: Option<i32>,
}

impl Exchange {
    /// Returns an exchange on the bound `socket`. `robot` is the robot's address. `state_size` is
    /// the size of a state in bytes, including its leading `message_id` (8 bytes, little-endian),
    /// which is the same in every protocol version.
    ///
    /// # Errors
    /// The system refuses the options of the socket.
    ///
    /// # Panics
    /// If `state_size` has no room for a `message_id`.
    pub fn new(socket: UdpSocket, robot: IpAddr, state_size: usize) -> io::Result<Self> {
        assert!(
            state_size >= MESSAGE_ID,
            "a state begins with its message_id"
        );
        let socket = Socket::from(socket);
        socket.set_nonblocking(false)?;
        socket.set_read_timeout(Some(TICK))?;
        Ok(Self {
            socket,
            robot: robot.to_canonical(),
            newest: vec![0; state_size].into(),
            incoming: vec![0; state_size].into(),
            message_id: None,
            reply_to: None,
            wait: TICK,
            failed: false,
        })
    }

    /// Makes each [`receive`](Self::receive) wait for `wait` at most, a millisecond or more,
    /// instead of a [`TICK`].
    ///
    /// # Errors
    /// The system refuses the option.
    pub fn with_wait(mut self, wait: Duration) -> io::Result<Self> {
        self.wait = wait.max(MIN_WAIT);
        self.socket.set_read_timeout(Some(self.wait))?;
        Ok(self)
    }

    /// Returns the socket from which states come, for its options.
    pub(crate) fn socket(&self) -> &Socket {
        &self.socket
    }

    /// Returns the newest state's bytes; zeros before the first state.
    pub fn state(&self) -> &[u8] {
        &self.newest
    }

    /// Returns the `message_id` of the newest state, `[ms]` of the robot's clock.
    pub fn message_id(&self) -> Option<u64> {
        self.message_id
    }

    /// Waits for a datagram, up to [`TICK`] or the time given to [`with_wait`](Self::with_wait).
    /// Then reads the waiting datagrams, up to [`DRAIN_MAX`] in all.
    ///
    /// A receive that fails does not wait. After a failure, the next call therefore first sleeps
    /// for a millisecond, so that a lasting error does not keep the processor busy.
    pub fn receive(&mut self) -> Reception {
        if self.failed {
            sys::sleep_a_millisecond();
        }
        let reception = self.drain();
        self.failed = reception.error.is_some();
        reception
    }

    fn drain(&mut self) -> Reception {
        let mut reception = Reception::default();
        let mut flags = 0;
        for _ in 0..DRAIN_MAX {
            match sys::recv_from(&self.socket, &mut self.incoming, flags) {
                Ok((length, sender)) => self.sort(length, sender, &mut reception),
                Err(error) => {
                    match error.kind() {
                        // The socket was empty: after the wait, or at once.
                        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => {
                            if flags == 0 {
                                reception.waited = self.wait;
                            }
                        }
                        // A signal, or a stop of the process, interrupted the call.
                        io::ErrorKind::Interrupted => {}
                        _ => reception.error = error.raw_os_error(),
                    }
                    break;
                }
            }
            flags = libc::MSG_DONTWAIT;
        }
        reception
    }

    /// Decides whether to keep the datagram of `length` bytes in `incoming`.
    fn sort(&mut self, length: usize, sender: Option<SocketAddr>, reception: &mut Reception) {
        let Some(sender) = sender.filter(|sender| sender.ip().to_canonical() == self.robot) else {
            reception.foreign += 1;
            return;
        };
        if length < self.incoming.len() {
            reception.short += 1;
            reception.short_length = length;
            return;
        }
        let message_id = message_id(&self.incoming);
        match self.message_id {
            Some(newest) if message_id <= newest => {
                reception.stale += 1;
                return;
            }
            // If this number were accepted, every later state would count as stale.
            Some(newest) if message_id - newest > LEAP_MAX => {
                reception.leap = Some(message_id);
                return;
            }
            _ => {}
        }
        reception.skipped += u64::from(reception.fresh);
        reception.fresh = true;
        self.message_id = Some(message_id);
        self.reply_to = Some(sender.into());
        core::mem::swap(&mut self.newest, &mut self.incoming);
    }

    /// Sends a command to the sender of the newest state. Does not wait: a full send buffer is a
    /// failure.
    ///
    /// # Errors
    /// [`SendError`]; the next cycle may try with its own command.
    pub fn send(&self, command: &[u8]) -> Result<(), SendError> {
        let reply_to = self.reply_to.as_ref().ok_or(SendError::NobodyToAnswer)?;
        match self
            .socket
            .send_to_with_flags(command, reply_to, libc::MSG_DONTWAIT)
        {
            Ok(sent) if sent == command.len() => Ok(()),
            Ok(sent) => Err(SendError::Short {
                sent,
                length: command.len(),
            }),
            Err(error) => Err(SendError::Refused(error.raw_os_error().unwrap_or(0))),
        }
    }
}

/// Reason why a command was not sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SendError {
    /// No state has been received, so there is no address to answer.
    #[error("libfranka: could not send UDP data")]
    NobodyToAnswer,
    /// The system sent only a part. The text is libfranka's.
    #[error("libfranka: could not send UDP data")]
    Short {
        /// Number of bytes sent.
        sent: usize,
        /// Number of bytes of the command.
        length: usize,
    },
    /// The system refused; an errno value.
    #[error("libfranka: UDP send: {}", sys::error_text(*.0))]
    Refused(i32),
}

/// Largest number of datagrams that one call reads, so that a flood cannot delay the cycle. The
/// default receive buffer of Linux (212992 bytes) holds fewer states than that.
pub const DRAIN_MAX: usize = 256;

/// Largest step of a state's `message_id` above the newest one, `[ms]` of the robot's clock: 49
/// days. No connection outlives such a silence, so a number further ahead cannot be genuine.
pub const LEAP_MAX: u64 = u32::MAX as u64;

/// Size of the `message_id`, in bytes.
const MESSAGE_ID: usize = size_of::<u64>();

fn message_id(state: &[u8]) -> u64 {
    let id = state
        .first_chunk::<MESSAGE_ID>()
        .expect("`new` checked the size of a state");
    u64::from_le_bytes(*id)
}

#[cfg(test)]
mod tests;

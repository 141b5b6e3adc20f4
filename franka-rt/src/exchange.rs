//! UDP side of a connection: receives the robot's newest state, and sends one command back to the
//! sender of that state. Duplicate and overtaken states are dropped and counted.
//!
//! The robot sends one state per millisecond, so a delayed host finds several waiting states. Only
//! the newest one is answered. [`Exchange::receive`] waits for a datagram, then reads all that have
//! arrived. It keeps the state with the highest `message_id`. A state is dropped if its number is
//! not above the number of the last kept state, or too far above it to be genuine. Datagrams from
//! addresses other than the robot's are dropped and counted. Nothing allocates after
//! [`Exchange::new`].

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::time::Duration;

use socket2::{SockAddr, Socket};

use crate::sys;

/// Opens the socket that receives the states of `robot`, on all local addresses of the same family
/// (IPv4 or IPv6). The system chooses a free port, which the `Connect` request must contain. The
/// kernel keeps states that arrive before the control thread starts.
///
/// # Errors
/// Returns an error if the system provides no socket or port.
pub fn bind(robot: IpAddr) -> io::Result<UdpSocket> {
    // An IPv4-mapped IPv6 address counts as IPv4.
    match robot.to_canonical() {
        IpAddr::V4(_) => UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)),
        IpAddr::V6(_) => UdpSocket::bind((Ipv6Addr::UNSPECIFIED, 0)),
    }
}

/// Longest wait of [`Exchange::receive`]. Even if the robot is silent, the thread checks for orders
/// and requests to stop at least this often.
pub const TICK: Duration = Duration::from_millis(20);

/// Returns how long one call of [`Exchange::receive`] may wait, so that a silence of `link_timeout`
/// is noticed in time: a quarter of `link_timeout`, and at most a [`TICK`].
///
/// The thread notices a lost link with a delay of at most a quarter of the timeout plus two of the
/// kernel's clock ticks, because the kernel counts such waits in ticks. A tick is 4 ms at 250 Hz.
pub fn wait_for(link_timeout: Duration) -> Duration {
    (link_timeout / 4).clamp(MIN_WAIT, TICK)
}

/// Shortest wait. If a wait were rounded to zero, the receive would not wait, or would wait
/// forever.
const MIN_WAIT: Duration = Duration::from_millis(1);

/// Receives a robot's states and sends commands to the robot.
#[derive(Debug)]
pub struct Exchange {
    socket: Socket,
    robot: IpAddr,
    /// Newest state, in the first `state_size` bytes.
    newest: Box<[u8]>,
    /// Buffer for the next datagram, swapped with `newest` if the datagram is newer.
    incoming: Box<[u8]>,
    message_id: Option<u64>,
    /// Sender of `newest`, which receives the commands.
    reply_to: Option<SockAddr>,
    /// Longest time that each receive waits for a datagram.
    wait: Duration,
    /// True if the last receive failed. An empty socket does not count.
    failed: bool,
}

/// Result of one call of [`Exchange::receive`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reception {
    /// True if a newer state arrived. [`Exchange::state`] returns it.
    pub fresh: bool,
    /// Number of states that were newer than the previous state, but were skipped because an even
    /// newer state arrived.
    pub skipped: u64,
    /// Number of states that were not newer than the newest state: overtaken or duplicate states.
    pub stale: u64,
    /// Number of datagrams from addresses other than the robot's.
    pub foreign: u64,
    /// Number of datagrams from the robot that were too short for a state.
    pub short: u64,
    /// Length of the last short datagram, in bytes; 0 before the first one.
    pub short_length: usize,
    /// `message_id` of the last state that was dropped because it was more than [`LEAP_MAX`] above
    /// the newest; `None` if there was no such state.
    pub leap: Option<u64>,
    /// Length of the wait if no datagram arrived, otherwise zero.
    pub waited: Duration,
    /// `errno` of a receive that failed; `None` if the socket was only empty.
    pub error: Option<i32>,
}

impl Exchange {
    /// Returns an exchange on the bound `socket`. `robot` is the robot's address. `state_size` is
    /// the size of a state in bytes. In every protocol version, a state begins with its
    /// `message_id` (8 bytes, little-endian), which the size includes.
    ///
    /// # Errors
    /// Returns an error if the system refuses the options of the socket.
    ///
    /// # Panics
    /// Panics if `state_size` has no room for a `message_id`.
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

    /// Makes each [`receive`](Self::receive) wait for at most `wait` instead of a [`TICK`]. A
    /// `wait` below a millisecond counts as a millisecond.
    ///
    /// # Errors
    /// Returns an error if the system refuses the option.
    pub fn with_wait(mut self, wait: Duration) -> io::Result<Self> {
        self.wait = wait.max(MIN_WAIT);
        self.socket.set_read_timeout(Some(self.wait))?;
        Ok(self)
    }

    /// Returns the socket that receives states, to set its options.
    pub(crate) fn socket(&self) -> &Socket {
        &self.socket
    }

    /// Returns the bytes of the newest state; zeros before the first state.
    pub fn state(&self) -> &[u8] {
        &self.newest
    }

    /// Returns the `message_id` of the newest state, `[ms]` of the robot's clock; `None` before the
    /// first state.
    pub fn message_id(&self) -> Option<u64> {
        self.message_id
    }

    /// Waits for a datagram, for at most a [`TICK`] or the time passed to
    /// [`with_wait`](Self::with_wait). Then reads the waiting datagrams, up to [`DRAIN_MAX`] in
    /// total.
    ///
    /// A receive that fails does not wait, so a lasting error would keep the processor busy.
    /// Therefore, after a failure, the next call first sleeps for a millisecond.
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
                        // The socket was empty, after the wait or immediately.
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

    /// Keeps or drops the datagram of `length` bytes in `incoming`.
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

    /// Sends a command to the sender of the newest state. Does not wait, so a full send buffer is
    /// an error.
    ///
    /// # Errors
    /// Returns [`SendError`] if the command was not sent. The next cycle can still send its own
    /// command.
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
    /// No state has been received, so there is no address to send to.
    #[error("libfranka: could not send UDP data")]
    NobodyToAnswer,
    /// The system sent only a part of the command. The text is libfranka's.
    #[error("libfranka: could not send UDP data")]
    Short {
        /// Number of bytes sent.
        sent: usize,
        /// Length of the command in bytes.
        length: usize,
    },
    /// The system refused to send, with this `errno`.
    #[error("libfranka: UDP send: {}", sys::error_text(*.0))]
    Refused(i32),
}

/// Largest number of datagrams that one call reads, so that a flood cannot delay the cycle. The
/// default receive buffer of Linux (212992 bytes) holds fewer states.
pub const DRAIN_MAX: usize = 256;

/// Largest step of a new state's `message_id` above the newest, `[ms]` of the robot's clock: 49
/// days. No connection survives such a silence, so a larger step cannot be genuine.
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

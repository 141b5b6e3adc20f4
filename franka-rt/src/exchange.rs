//! The UDP side of a connection: the robot's newest state in, one command back to where that state came from.
//!
//! The robot sends one state per millisecond, and a host that was held up finds several of them waiting. The newest
//! one wins: [`Exchange::receive`] waits for a datagram, then takes all that are there and keeps the one with the
//! highest `message_id`, if that is above the last one kept. What did not come from the robot's address is dropped and
//! counted. Nothing here allocates after [`Exchange::new`].

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::time::Duration;

use socket2::{SockAddr, Socket};

use crate::sys;

/// Opens the socket that `robot` sends its states to: any address of the robot's family, IPv4 or IPv6, and a free port
/// (the one to announce in `Connect`). States that arrive before the thread starts wait in the kernel.
///
/// # Errors
/// If the system refuses a socket or a port.
pub fn bind(robot: IpAddr) -> io::Result<UdpSocket> {
    // An IPv4 address in the dress of IPv6 is one to the network.
    match robot.to_canonical() {
        IpAddr::V4(_) => UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)),
        IpAddr::V6(_) => UdpSocket::bind((Ipv6Addr::UNSPECIFIED, 0)),
    }
}

/// Time that [`Exchange::receive`] waits at most, and therefore the longest time until the thread sees an order, or
/// the wish that it stop, while the robot is silent.
pub const TICK: Duration = Duration::from_millis(20);

/// How long to wait for a state where silences of `link_timeout` have to be noticed: a quarter of it, a [`TICK`] at most.
///
/// So a loss shows late by a quarter, and by the kernel's clock tick (4 ms at 250 Hz), in which it counts such waits.
pub fn wait_for(link_timeout: Duration) -> Duration {
    (link_timeout / 4).clamp(MIN_WAIT, TICK)
}

/// The shortest wait: a shorter one would be none at all, or one without end.
const MIN_WAIT: Duration = Duration::from_millis(1);

/// Receives states and sends commands.
#[derive(Debug)]
pub struct Exchange {
    socket: Socket,
    robot: IpAddr,
    /// The newest state, in its first `state_size` bytes.
    newest: Box<[u8]>,
    /// Where the next datagram goes; changes places with `newest` if it is newer.
    incoming: Box<[u8]>,
    /// `message_id` of `newest`.
    message_id: Option<u64>,
    /// Sender of `newest`, whom a command answers.
    reply_to: Option<SockAddr>,
}

/// What one call of [`Exchange::receive`] found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reception {
    /// Whether there is a newer state than before; [`Exchange::state`] has it.
    pub fresh: bool,
    /// States that were newer than before and gave way to a still newer one.
    pub skipped: u64,
    /// States not newer than the best so far: late or duplicate ones.
    pub stale: u64,
    /// Datagrams from elsewhere than the robot.
    pub foreign: u64,
    /// Datagrams of the robot too short for a state.
    pub short: u64,
    /// Length in bytes of the last of these; 0 without one.
    pub short_length: usize,
    /// errno value of a receive that failed otherwise than by finding nothing.
    pub error: Option<i32>,
}

impl Exchange {
    /// Takes the bound `socket`, the robot's address and the size of a state in bytes, which includes the
    /// `message_id` (8 bytes, little-endian) that it begins with in every protocol version.
    ///
    /// # Errors
    /// If the system refuses the options of the socket.
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
        })
    }

    /// Waits for `wait` in each [`receive`](Self::receive), a millisecond at least, in place of a [`TICK`].
    ///
    /// # Errors
    /// If the system refuses the option.
    pub fn with_wait(self, wait: Duration) -> io::Result<Self> {
        self.socket.set_read_timeout(Some(wait.max(MIN_WAIT)))?;
        Ok(self)
    }

    /// Where states come from, for its options.
    pub(crate) fn socket(&self) -> &Socket {
        &self.socket
    }

    /// The newest state's bytes; zeros before the first one.
    pub fn state(&self) -> &[u8] {
        &self.newest
    }

    /// `message_id` of the newest state, `[ms]` of the robot's clock.
    pub fn message_id(&self) -> Option<u64> {
        self.message_id
    }

    /// Waits for a datagram, up to [`TICK`] or what [`with_wait`](Self::with_wait) was given, then takes those that are there,
    /// up to [`DRAIN_MAX`] in all.
    pub fn receive(&mut self) -> Reception {
        let mut reception = Reception::default();
        let mut flags = 0;
        for _ in 0..DRAIN_MAX {
            match sys::recv_from(&self.socket, &mut self.incoming, flags) {
                Ok((length, sender)) => self.sort(length, sender, &mut reception),
                Err(error) => {
                    reception.error = match error.kind() {
                        // Nothing there (at once, or after the wait), or a signal came between.
                        io::ErrorKind::WouldBlock
                        | io::ErrorKind::TimedOut
                        | io::ErrorKind::Interrupted => None,
                        _ => error.raw_os_error(),
                    };
                    break;
                }
            }
            flags = libc::MSG_DONTWAIT;
        }
        reception
    }

    /// Decides about the datagram of `length` bytes in `incoming`.
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
        if self.message_id.is_some_and(|newest| message_id <= newest) {
            reception.stale += 1;
            return;
        }
        reception.skipped += u64::from(reception.fresh);
        reception.fresh = true;
        self.message_id = Some(message_id);
        self.reply_to = Some(sender.into());
        core::mem::swap(&mut self.newest, &mut self.incoming);
    }

    /// Sends a command to the sender of the newest state. Does not wait: a full send buffer is a failure.
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

/// Why a command did not leave.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SendError {
    /// No state has been received, so nobody is to be answered.
    #[error("libfranka: could not send UDP data")]
    NobodyToAnswer,
    /// The system took only a part. The text is libfranka's.
    #[error("libfranka: could not send UDP data")]
    Short {
        /// Bytes taken.
        sent: usize,
        /// Bytes of the command.
        length: usize,
    },
    /// The system refused; an errno value.
    #[error("libfranka: UDP send: {}", sys::error_text(*.0))]
    Refused(i32),
}

/// Datagrams taken in one call at most, so that a flood cannot hold the cycle up. The default receive buffer of Linux
/// (212992 bytes) holds fewer states than that.
pub const DRAIN_MAX: usize = 256;

/// Size of the `message_id`, in bytes.
const MESSAGE_ID: usize = size_of::<u64>();

fn message_id(state: &[u8]) -> u64 {
    let id = state
        .first_chunk::<MESSAGE_ID>()
        .expect("`new` checked the size of a state");
    u64::from_le_bytes(*id)
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    const SIZE: usize = 64;

    fn state(message_id: u64) -> Vec<u8> {
        let mut state = vec![message_id as u8; SIZE];
        state[..8].copy_from_slice(&message_id.to_le_bytes());
        state
    }

    /// A robot on 127.0.0.1, a stranger on 127.0.0.2, and the exchange that both can reach.
    struct Bench {
        robot: UdpSocket,
        stranger: UdpSocket,
        exchange: Exchange,
    }

    impl Bench {
        fn new() -> Self {
            let robot = IpAddr::from([127, 0, 0, 1]);
            let socket = bind(robot).expect("a free port");
            let port = socket.local_addr().expect("bound").port();
            let connected = |from: [u8; 4]| {
                let socket = UdpSocket::bind((Ipv4Addr::from(from), 0)).expect("a free port");
                socket
                    .connect((Ipv4Addr::LOCALHOST, port))
                    .expect("an address");
                socket
            };
            let exchange = Exchange::new(socket, robot, SIZE).expect("options are accepted");
            Self {
                robot: connected([127, 0, 0, 1]),
                stranger: connected([127, 0, 0, 2]),
                exchange,
            }
        }

        /// Sends states in this order; loopback has them all queued on return.
        fn states(&self, message_ids: &[u64]) {
            for &id in message_ids {
                self.robot.send(&state(id)).expect("loopback");
            }
        }
    }

    #[test]
    fn the_newest_of_what_waits_wins_whatever_the_order() {
        let mut bench = Bench::new();
        bench.states(&[2]);
        assert!(bench.exchange.receive().fresh);
        bench.states(&[1, 4, 2, 3]); // the order of libfranka's own test
        let reception = bench.exchange.receive();
        assert_eq!(
            reception,
            Reception {
                fresh: true,
                stale: 3,
                ..Reception::default()
            }
        );
        assert_eq!(bench.exchange.message_id(), Some(4));
        assert_eq!(bench.exchange.state(), state(4));

        bench.states(&[5, 6, 7]);
        let reception = bench.exchange.receive();
        assert_eq!(
            reception,
            Reception {
                fresh: true,
                skipped: 2,
                ..Reception::default()
            }
        );
        assert_eq!(bench.exchange.state(), state(7));
    }

    #[test]
    fn old_states_alone_are_nothing_new() {
        let mut bench = Bench::new();
        bench.states(&[9]);
        assert!(bench.exchange.receive().fresh);
        bench.states(&[9, 8]);
        assert_eq!(
            bench.exchange.receive(),
            Reception {
                stale: 2,
                ..Reception::default()
            }
        );
        assert_eq!(bench.exchange.state(), state(9));
    }

    #[test]
    fn another_address_is_not_the_robot() {
        let mut bench = Bench::new();
        bench.stranger.send(&state(1_000)).expect("loopback");
        bench.states(&[3]);
        bench.stranger.send(&[1, 2, 3]).expect("loopback");
        let reception = bench.exchange.receive();
        assert_eq!(
            reception,
            Reception {
                fresh: true,
                foreign: 2,
                ..Reception::default()
            }
        );
        assert_eq!(bench.exchange.state(), state(3));
    }

    #[test]
    fn a_short_datagram_is_told_and_a_long_one_cut() {
        let mut bench = Bench::new();
        bench.robot.send(&[]).expect("loopback");
        bench.states(&[3]);
        bench.robot.send(&state(4)[..SIZE - 1]).expect("loopback");
        let reception = bench.exchange.receive();
        let told = Reception {
            fresh: true,
            short: 2,
            short_length: SIZE - 1,
            ..Reception::default()
        };
        assert_eq!(reception, told);
        assert_eq!(bench.exchange.message_id(), Some(3));

        let mut long = state(5);
        long.extend([0xee; 100]);
        bench.robot.send(&long).expect("loopback");
        assert!(bench.exchange.receive().fresh);
        assert_eq!(bench.exchange.state(), state(5));
    }

    #[test]
    fn silence_ends_the_wait_without_an_error() {
        let mut bench = Bench::new();
        let start = Instant::now();
        assert_eq!(bench.exchange.receive(), Reception::default());
        assert!(
            start.elapsed() >= TICK / 2,
            "it waited: {:?}",
            start.elapsed()
        );
    }

    #[test]
    fn the_wait_follows_the_link_timeout() {
        for (link_timeout, wait) in [(20, 5), (40, 10), (100, 20), (1000, 20)] {
            let wait = Duration::from_millis(wait);
            assert_eq!(wait_for(Duration::from_millis(link_timeout)), wait);
        }
        let Bench { exchange, .. } = Bench::new();
        let mut exchange = exchange
            .with_wait(Duration::from_millis(5))
            .expect("an option");
        // The best of ten, as any one may meet a busy machine; a tick would be 20 ms.
        let waited = |_| {
            let start = Instant::now();
            assert_eq!(exchange.receive(), Reception::default());
            start.elapsed()
        };
        let least = (0..10).map(waited).min().expect("ten");
        assert!(least >= Duration::from_millis(4), "it waited: {least:?}");
        assert!(least < Duration::from_millis(18), "no tick: {least:?}");
    }

    #[test]
    fn the_socket_is_of_the_family_of_the_robot() {
        let family = |robot: &str| {
            let socket = bind(robot.parse().expect("an address")).expect("a free port");
            socket.local_addr().expect("bound").is_ipv6()
        };
        assert!(!family("192.0.2.1"));
        assert!(!family("::ffff:192.0.2.1"), "an IPv4 address, mapped");
        assert!(family("::1"));
    }

    #[test]
    fn a_robot_on_ipv6_and_one_whose_address_is_mapped_are_known_and_answered() {
        let v6 = IpAddr::from(Ipv6Addr::LOCALHOST);
        let v4 = IpAddr::from(Ipv4Addr::LOCALHOST);
        let mapped = IpAddr::from(Ipv4Addr::LOCALHOST.to_ipv6_mapped());
        // Where the robot sends from, what it is known as, and the family of the socket that receives.
        for (from, known, socket) in [
            (v6, v6, v6),
            (v4, mapped, v4),
            // A socket of both families sees IPv4 senders as mapped ones.
            (v4, v4, v6),
            (v4, mapped, v6),
        ] {
            let socket = bind(socket).expect("a free port");
            let port = socket.local_addr().expect("bound").port();
            let robot = UdpSocket::bind((from, 0)).expect("a free port");
            robot.connect((from, port)).expect("an address");
            let mut exchange = Exchange::new(socket, known, SIZE).expect("options");
            robot.send(&state(1)).expect("loopback");
            assert!(exchange.receive().fresh, "{from} known as {known}");
            exchange.send(&[7]).expect("loopback");
            let mut answer = [0; 2];
            assert_eq!(robot.recv(&mut answer).expect("an answer"), 1);
        }
        // Another family is another host.
        let socket = bind(v6).expect("a free port");
        let port = socket.local_addr().expect("bound").port();
        let stranger = UdpSocket::bind((v4, 0)).expect("a free port");
        stranger.send_to(&state(1), (v4, port)).expect("loopback");
        let mut exchange = Exchange::new(socket, v6, SIZE).expect("options");
        assert_eq!(exchange.receive().foreign, 1);
    }

    #[test]
    fn a_flood_is_taken_in_portions() {
        let mut bench = Bench::new();
        // As large as an unprivileged process may have it, and the datagrams small: more fit than one call takes.
        bench
            .exchange
            .socket
            .set_recv_buffer_size(1 << 20)
            .expect("an option");
        for _ in 0..DRAIN_MAX + 20 {
            bench.stranger.send(&[0]).expect("loopback");
        }
        assert_eq!(bench.exchange.receive().foreign, DRAIN_MAX as u64);
        assert_eq!(bench.exchange.receive().foreign, 20);
    }

    #[test]
    fn a_command_answers_the_sender_of_the_newest_state() {
        let mut bench = Bench::new();
        assert_eq!(bench.exchange.send(&[1]), Err(SendError::NobodyToAnswer));
        bench.states(&[1]);
        // The same robot from another port, as after a restart of its process.
        let moved = UdpSocket::bind("127.0.0.1:0").expect("a free port");
        let port = bench
            .exchange
            .socket
            .local_addr()
            .expect("bound")
            .as_socket()
            .expect("IPv4")
            .port();
        moved
            .send_to(&state(2), ("127.0.0.1", port))
            .expect("loopback");
        bench.stranger.send(&state(3)).expect("loopback");
        assert!(bench.exchange.receive().fresh);
        bench.exchange.send(&[7, 8]).expect("loopback");
        moved
            .set_read_timeout(Some(Duration::from_secs(5)))
            .expect("an option");
        let mut command = [0; 8];
        assert_eq!(moved.recv(&mut command).expect("the command"), 2);
        assert_eq!(command[..2], [7, 8]);
    }

    #[test]
    fn a_refused_send_says_why() {
        let mut bench = Bench::new();
        bench.states(&[1]);
        assert!(bench.exchange.receive().fresh);
        let error = bench
            .exchange
            .send(&vec![0; 100_000])
            .expect_err("no datagram is that long");
        assert_eq!(error.to_string(), "libfranka: UDP send: Message too long");
    }
}

//! Tests of states and commands over loopback.

use std::os::fd::OwnedFd;
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

    /// Sends states in this order. When the function returns, loopback has queued them all.
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
fn a_number_impossibly_far_ahead_does_not_make_the_link_deaf() {
    let mut bench = Bench::new();
    bench.states(&[9, u64::MAX]);
    let reception = bench.exchange.receive();
    let expected = Reception {
        fresh: true,
        leap: Some(u64::MAX),
        ..Reception::default()
    };
    assert_eq!(reception, expected);
    assert_eq!(bench.exchange.message_id(), Some(9));
    bench.states(&[10, 10 + LEAP_MAX + 1, 10 + LEAP_MAX]);
    let reception = bench.exchange.receive();
    assert_eq!(
        (reception.fresh, reception.skipped, reception.leap),
        (true, 1, Some(11 + LEAP_MAX))
    );
    assert_eq!(bench.exchange.message_id(), Some(10 + LEAP_MAX));
}

#[test]
fn failing_receive_does_not_keep_the_processor_busy() {
    let mut bench = Bench::new();
    // This descriptor is not a socket, so every receive fails at once.
    let file = std::fs::File::open("/dev/null").expect("Linux has it");
    let working = std::mem::replace(&mut bench.exchange.socket, OwnedFd::from(file).into());
    let failed = Reception {
        error: Some(libc::ENOTSOCK),
        ..Reception::default()
    };
    let start = Instant::now();
    for _ in 0..20 {
        assert_eq!(bench.exchange.receive(), failed);
    }
    // A sleep may last longer, but never shorter. The first receive does not sleep.
    assert!(
        start.elapsed() >= Duration::from_millis(19),
        "{:?}",
        start.elapsed()
    );
    bench.exchange.socket = working;
    bench.states(&[1]);
    assert!(bench.exchange.receive().fresh, "it goes on");
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
    let silence = Reception {
        waited: TICK,
        ..Reception::default()
    };
    let start = Instant::now();
    assert_eq!(bench.exchange.receive(), silence);
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
    let wait = Duration::from_millis(5);
    let mut exchange = exchange.with_wait(wait).expect("an option");
    // The kernel rounds the wait up, by less than a tick.
    let option = exchange.socket.read_timeout().expect("an option");
    assert!(option >= Some(wait) && option < Some(TICK), "{option:?}");
    assert_eq!(exchange.receive().waited, wait);
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
fn ipv6_and_mapped_robot_addresses_are_known_and_answered() {
    let v6 = IpAddr::from(Ipv6Addr::LOCALHOST);
    let v4 = IpAddr::from(Ipv4Addr::LOCALHOST);
    let mapped = IpAddr::from(Ipv4Addr::LOCALHOST.to_ipv6_mapped());
    // Sending address of the robot, known address of the robot, and family of the receiving socket.
    for (from, known, socket) in [
        (v6, v6, v6),
        (v4, mapped, v4),
        // A socket of both families shows IPv4 senders as mapped addresses.
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
    // The buffer is as large as an unprivileged process may request. The datagrams are small, so
    // more fit than one call reads.
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
    // The robot sends from another port, as after a restart of its process.
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

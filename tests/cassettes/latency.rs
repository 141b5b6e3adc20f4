//! Delay that a tap adds to the time from a state to its command.

use std::io::{Read as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::time::{Duration, Instant};

use franka_proto::Version;
use franka_proto::client::Session;
use franka_record::cassette::{Device, Route, Tap};

use crate::recorded::anywhere;

/// Number of states, at a thousand per second, each answered at once.
const ROUNDS: usize = 5000;
const CYCLE: Duration = Duration::from_millis(1);

/// Prints times; no verdict depends on them. To be run alone:
/// `cargo nextest run -p franka-tests --test cassettes latency --run-ignored all --no-capture`
#[test]
#[ignore = "a measurement"]
fn round_trip_of_state_and_answer_is_measured() {
    let direct = round_trips(|robot| (robot, None));
    let path = std::env::temp_dir().join(format!("franka-latency-{}.mcap", std::process::id()));
    let tapped = round_trips(|robot| {
        let route = Route {
            device: Device::Robot,
            listen: anywhere(Device::Robot),
            robot,
        };
        let tap = Tap::start(&[route], &path).expect("a new file");
        (tap.address(Device::Robot).expect("a route"), Some(tap))
    });
    std::fs::remove_file(path).expect("written");
    for (name, times) in [("direct", &direct), ("tapped", &tapped)] {
        let at = |share: f64| times[(share * (times.len() - 1) as f64) as usize];
        println!("{name}: p50 {:?}, p99 {:?}", at(0.5), at(0.99));
    }
    assert_eq!(direct.len(), tapped.len());
}

/// Times from sending a state to receiving the answer, ascending.
fn round_trips(between: impl FnOnce(SocketAddr) -> (SocketAddr, Option<Tap>)) -> Vec<Duration> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a free port");
    let (address, tap) = between(listener.local_addr().expect("bound"));
    let client = std::thread::spawn(move || client(address));
    let (mut stream, _) = listener.accept().expect("a client");
    let mut hello = [0; 16];
    stream.read_exact(&mut hello).expect("Connect");
    let port = u16::from_le_bytes([hello[14], hello[15]]);
    let udp = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("a free port");
    let mut state = [0; 1377];
    let mut times = Vec::new();
    for id in 0..ROUNDS as u64 {
        state[..8].copy_from_slice(&id.to_le_bytes());
        let start = Instant::now();
        udp.send_to(&state, (Ipv4Addr::LOCALHOST, port))
            .expect("loopback");
        let mut answer = [0; 400];
        udp.recv(&mut answer).expect("an answer");
        times.push(start.elapsed());
        std::thread::sleep(CYCLE.saturating_sub(start.elapsed()));
    }
    drop(stream);
    client.join().expect("no panic");
    let report = tap.map(|tap| tap.finish().expect("a file"));
    println!("{report:?}");
    times.sort();
    times
}

/// A client that answers every state with a command.
fn client(address: SocketAddr) {
    let udp = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("a free port");
    let port = udp.local_addr().expect("bound").port();
    let mut stream = TcpStream::connect(address).expect("a robot");
    let hello = Session::new(Version::V10).connect(port);
    stream.write_all(hello.as_bytes()).expect("a robot");
    let mut state = [0; 1377];
    for _ in 0..ROUNDS {
        let (_, sender) = udp.recv_from(&mut state).expect("a state");
        let mut command = [0; 371];
        command[..8].copy_from_slice(&state[..8]);
        udp.send_to(&command, sender).expect("loopback");
    }
}

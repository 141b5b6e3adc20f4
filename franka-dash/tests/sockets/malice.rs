//! Malicious viewers, together with a viewer that moves the arm.

use std::io::{Read as _, Write as _};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use franka_async::state::RobotMode;
use franka_dash::Options;
use rand::rngs::SmallRng;
use rand::seq::IndexedRandom;
use rand::{Rng, SeedableRng};
use serde_json::json;

use crate::viewer::{Served, Viewer};

/// Requests that need the lease, and invalid requests.
const TEXTS: [&str; 20] = [
    r#"{"type":"take","name":"Mallory"}"#,
    r#"{"type":"release"}"#,
    r#"{"type":"alive"}"#,
    r#"{"type":"begin","motion":{"kind":"ready"},"speed":0.25}"#,
    r#"{"type":"begin","motion":{"kind":"joints","q":[9,9,9,9,9,9,9]},"speed":0.25}"#,
    r#"{"type":"hold","seq":1}"#,
    r#"{"type":"hold","seq":4294967295}"#,
    r#"{"type":"end"}"#,
    r#"{"type":"recover"}"#,
    r#"{"type":"seen","server_ms":0}"#,
    r#"{"type":"seen","server_ms":18446744073709551615}"#,
    r#"{"type":"speed","speed":0.25}"#,
    r#"{"type":"tune","tuning":{"end_effector":4,"joints":2,"damping":0.5,"force_cap":60,"compensation":false}}"#,
    r#"{"type":"gripper","action":{"kind":"stop"}}"#,
    r#"{"type":"record","on":true}"#,
    r#"{"type":"disturb","disturbance":{"kind":"user_stop","pressed":true}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"cut","milliseconds":10000}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"reflex"}}"#,
    "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[",
    "\u{0}\u{7f}",
];

/// Returns a WebSocket frame with this first byte, masked unless `bare` is true. The length may be
/// wrong.
fn frame(first: u8, length: u64, content: &[u8], bare: bool) -> Vec<u8> {
    let mask = if bare { 0 } else { 0x80 };
    let mut frame = vec![first];
    match length {
        0..126 => frame.push(mask | length as u8),
        126..0x1_0000 => {
            frame.push(mask | 126);
            frame.extend((length as u16).to_be_bytes());
        }
        _ => {
            frame.push(mask | 127);
            frame.extend(length.to_be_bytes());
        }
    }
    if !bare {
        // A zero mask leaves the content unchanged.
        frame.extend([0; 4]);
    }
    frame.extend(content);
    frame
}

/// Performs an attack, until it ends or the server closes the connection.
fn attack(address: SocketAddr, random: &mut SmallRng) -> std::io::Result<()> {
    let mut stream = TcpStream::connect(address)?;
    stream.set_read_timeout(Some(Duration::from_millis(20)))?;
    stream.set_write_timeout(Some(Duration::from_secs(5)))?;
    if random.random_bool(0.1) {
        let noise: Vec<u8> = (0..4000).map(|_| random.random()).collect();
        return stream.write_all(&noise);
    }
    let origin = match random.random_range(0..8) {
        0 => "Origin: http://evil.example\r\n",
        _ => "",
    };
    write!(
        stream,
        "GET /ws HTTP/1.1\r\nHost: {address}\r\n{origin}Connection: Upgrade\r\nUpgrade: websocket\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
    )?;
    let reads = random.random_bool(0.5);
    let mut heard = [0; 4096];
    for _ in 0..random.random_range(1..60) {
        let mut text = TEXTS.choose(random).expect("some").as_bytes().to_vec();
        for _ in 0..random.random_range(0..3) {
            let at = random.random_range(0..text.len());
            text[at] = random.random();
        }
        let length = text.len() as u64;
        let sent = match random.random_range(0..20) {
            0 => frame(0x82, length, &text, false),
            1 => frame(0x81, length, &text, true),
            2 => frame(random.random(), length, &text, false),
            3 => frame(0x81, 1 << 40, &text, false),
            4 => frame(0x01, length, &text, false),
            5 => frame(0x89, 0, &[], false),
            6 => frame(0x81, length + 9, &text, false),
            7 => {
                let much = vec![b'x'; 5000];
                frame(0x81, 5000, &much, false)
            }
            _ => frame(0x81, length, &text, false),
        };
        stream.write_all(&sent)?;
        if reads && stream.read(&mut heard).is_ok_and(|length| length == 0) {
            return Ok(());
        }
    }
    match random.random_range(0..3) {
        0 => stream.shutdown(Shutdown::Write),
        1 => stream.write_all(&frame(0x88, 2, &[3, 232], false)),
        _ => Ok(()),
    }
}

/// The only excluded request is the one allowed for every viewer: to stop the arm.
#[test]
fn hostile_viewers_change_nothing_for_the_one_that_jogs() {
    let seed: u64 = rand::rng().random();
    println!("seed {seed}");
    let served = Served::new(|running| {
        let options = Options::default().allow_motion().simulated(running);
        // The attackers keep the machine busy: the test checks that nothing else ends the hold.
        options.patience(Duration::from_secs(30))
    });
    let mut commander = Viewer::connect(served.address);
    commander.take();
    let under_way = AtomicUsize::new(HARMFUL);
    std::thread::scope(|scope| {
        let joint = json!({"kind": "joint", "joint": 1, "up": true});
        let start = served.robot.state().q[0];
        let moved = || served.robot.state().q[0] - start;
        let next = commander.hold_until(&joint, || moved() > 0.005);
        let before = moved();
        for number in 0..HARMFUL {
            let (under_way, address) = (&under_way, served.address);
            scope.spawn(move || {
                let mut random = SmallRng::seed_from_u64(seed.wrapping_add(number as u64));
                for _ in 0..ATTACKS {
                    // The server has closed the connection.
                    let _ = attack(address, &mut random);
                }
                under_way.fetch_sub(1, Ordering::Relaxed);
            });
        }
        let all_done = || under_way.load(Ordering::Relaxed) == 0 && moved() > before + 0.01;
        let held = commander.go_on_until(next, all_done);
        assert!(held.is_some(), "the hold has ended");
    });
    assert_eq!(commander.refused, 0);
    assert_eq!(commander.commander, Some(commander.number));
    commander.send(json!({"type": "end"}));
    served.wait_for_rest();
    let state = served.robot.state();
    assert_eq!(state.robot_mode, RobotMode::Idle);
    assert_eq!(served.robot.stats().lost.get(), 0);
    // The motion continues.
    let up = json!({"kind": "joint", "joint": 1, "up": false});
    commander.hold_until(&up, || served.robot.state().q[0] < state.q[0] - 0.005);
}

const HARMFUL: usize = 100;

/// Number of connections of each attacker.
const ATTACKS: usize = 3;

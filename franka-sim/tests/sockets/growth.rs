//! The memory of the process, which abuse must not increase.

use std::net::UdpSocket;
use std::time::{Duration, Instant};

use franka_proto::{MoveControllerMode, MoveGeneratorMode, MoveRequest, Request};

use crate::binary::Binary;
use crate::client::Client;
use crate::each_robot;
use crate::good::assert_served;
use crate::port::{Connection, SOON};

/// Performs one fast abuse of each kind, on every port.
fn round(binary: &Binary) {
    for port in binary.ports() {
        let hello = port.connect(port.version, 4711);
        for bytes in [
            &[0xff; 500][..],
            &port.announcing(u32::MAX, 0, 0),
            &port.connect(port.version + 1, 4711),
            &hello[..port.header()],
            &[],
        ] {
            let mut connection = port.dial();
            connection.send(bytes);
        }
        for end in [drop, Connection::reset] {
            let (mut connection, _udp) = port.shake_hands();
            let mut second = port.dial();
            second.send(&hello);
            connection.send(&port.message(port.stop, 1, &[]));
            connection.send(&port.announcing(500, port.setter, 2));
            end(connection);
        }
    }
    let mut client = Client::connect(binary);
    let (robot, _) = client.addresses();
    client.request(&Request::Move(MoveRequest::new(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointPosition,
    )));
    let stranger = UdpSocket::bind("127.0.0.2:0").expect("Linux");
    for length in [0, 371, 9000] {
        let bytes = vec![0xff; length];
        client.send_bytes(&bytes);
        stranger.send_to(&bytes, robot).expect("sent");
    }
}

/// Waits until the server has removed the connections of the last round.
fn settled(binary: &Binary, descriptors: usize) {
    let deadline = Instant::now() + SOON;
    while binary.descriptors() > descriptors {
        let open = binary.descriptors();
        assert!(Instant::now() < deadline, "{open} descriptors are open");
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn the_process_does_not_grow_with_the_number_of_abuses() {
    each_robot(|binary| {
        let descriptors = binary.descriptors();
        // In these rounds, buffers and tables reach their final size.
        for _ in 0..20 {
            round(binary);
        }
        settled(binary, descriptors);
        let before = binary.memory();
        for _ in 0..100 {
            round(binary);
        }
        settled(binary, descriptors);
        let after = binary.memory();
        assert!(
            after < before + GROWTH,
            "{before} KiB before, {after} KiB after 100 rounds"
        );
        assert_served(binary);
    });
}

#[test]
fn a_robot_that_has_served_takes_less_than_fifty_megabytes() {
    each_robot(|binary| {
        assert_served(binary);
        let memory = binary.memory_max();
        assert!(memory > 0 && memory * 1024 < 50_000_000, "{memory} KiB");
    });
}

/// Memory that an allocator may keep, `[KiB]`. A leak of 1 KiB per connection would show as 2000.
const GROWTH: usize = 512;

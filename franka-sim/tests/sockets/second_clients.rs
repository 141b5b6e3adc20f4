//! More than one client at a time, and clients that disappear without closing the connection.

use std::net::{SocketAddr, UdpSocket};

use crate::each_robot;
use crate::good::{assert_moves_during, assert_served};
use crate::port::{Connection, Port, receive};

/// Asserts that the connected client still receives answers and states.
fn assert_undisturbed(port: &Port, connection: &mut Connection, udp: &UdpSocket, id: u32) {
    connection.send(&port.message(port.stop, id, &[]));
    let answer = connection.read(port.header() + 1).expect("an answer");
    assert_eq!(answer[port.header()], 0, "{}", port.name);
    if port.name != "robot" {
        // This is the second byte of a status.
        connection.read(1).expect("the rest of the answer");
    }
    receive(udp, &mut []);
}

#[test]
fn a_second_client_is_refused_and_the_first_not_disturbed() {
    each_robot(|binary| {
        for port in binary.ports() {
            let (mut first, udp) = port.shake_hands();
            for id in 1..=10 {
                let mut second = port.dial();
                second.send(&port.connect(port.version, 4711));
                assert_undisturbed(port, &mut first, &udp, 2 * id);
                // The server must reset the connection, because a waiting client detects a reset at
                // once.
                second.expect_reset();
                assert_undisturbed(port, &mut first, &udp, 2 * id + 1);
            }
            // Second clients that violate the protocol, send nothing, or vanish must not disturb
            // the first client either.
            let mut garbage = port.dial();
            garbage.send(&[0xff; 100]);
            let silent: Vec<_> = (0..20).map(|_| port.dial()).collect();
            port.dial().reset();
            assert_undisturbed(port, &mut first, &udp, 100);
            assert_eq!(garbage.read_to_end(), b"");
            drop(silent);
            assert_undisturbed(port, &mut first, &udp, 101);
            binary.assert_logged(&format!("refused: the {} already has a client", port.name));
            drop(first);
            assert_served(binary);
        }
    });
}

#[test]
fn clients_that_crowd_at_the_door_do_not_disturb_a_motion() {
    each_robot(|binary| {
        let port = binary.robot();
        assert_moves_during(binary, || {
            for round in 0..50 {
                let mut connection = port.dial();
                match round % 3 {
                    0 => connection.send(&port.connect(port.version, 4711)),
                    1 => connection.send(&[0; 50]),
                    _ => connection.reset(),
                }
            }
        });
        assert_served(binary);
    });
}

/// A client that has lost its network cannot close the connection, so the kernel must detect the
/// loss.
#[test]
fn the_host_of_an_idle_client_is_asked_whether_it_is_there() {
    each_robot(|binary| {
        for port in binary.ports() {
            let (connection, _udp) = port.shake_hands();
            let name = |address: SocketAddr| format!("0100007F:{:04X}", address.port());
            let ends = [name(port.address), name(connection.address())];
            let sockets = std::fs::read_to_string("/proc/net/tcp").expect("Linux");
            let socket = sockets
                .lines()
                .map(|line| line.split_whitespace().collect::<Vec<_>>())
                .find(|words| words[1..3] == ends)
                .expect("the simulator's end of the connection");
            // An idle connection has only the keepalive timer.
            assert!(socket[5].starts_with("02:"), "{}: {socket:?}", port.name);
        }
    });
}

#[test]
fn a_client_that_leaves_makes_room_at_once() {
    each_robot(|binary| {
        for port in binary.ports() {
            for end in [drop, Connection::reset] {
                for _ in 0..5 {
                    let (connection, udp) = port.shake_hands();
                    // The states continue for a moment, to a closed port.
                    drop(udp);
                    end(connection);
                }
                assert_served(binary);
            }
        }
    });
}

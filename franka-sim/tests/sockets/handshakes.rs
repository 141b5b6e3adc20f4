//! Connections that never become a session.

use std::time::Instant;

use crate::binary::Binary;
use crate::each_robot;
use crate::good::assert_served;
use crate::port::{Connection, Port, SOON};

/// Runs `abuse` on each port of a simulator, and afterwards a good client.
fn each_port(binary: &Binary, abuse: impl Fn(&Port)) {
    for port in binary.ports() {
        abuse(port);
        assert_served(binary);
    }
}

#[test]
fn a_first_message_that_is_none_closes_the_connection() {
    each_robot(|binary| {
        each_port(binary, |port| {
            let stop = port.message(port.stop, 0, &[]);
            for first in [
                vec![0xff; 100],
                vec![0; 100],
                b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".to_vec(),
                port.announcing(0, 0, 0),
                port.announcing(port.header() as u32 - 1, 0, 0),
                port.announcing(1025, 0, 0),
                port.announcing(u32::MAX, 0, 0),
                // These bytes are no handshake, or an incomplete handshake.
                stop,
                port.message(0, 0, &[]),
                port.message(0, 0, &[10, 0, 1]),
                port.message(99, 0, &[0; 4]),
            ] {
                let mut connection = port.dial();
                connection.send(&first);
                assert_eq!(connection.read_to_end(), b"", "{first:?}");
                binary.assert_alive();
            }
        });
        binary.assert_logged("client of the robot disconnected");
    });
}

#[test]
fn another_version_is_answered_and_closed() {
    each_robot(|binary| {
        each_port(binary, |port| {
            for version in [0, port.version - 1, port.version + 1, u16::MAX] {
                let mut connection = port.dial();
                connection.send(&port.connect(version, 4711));
                let answer = connection.read_to_end();
                let payload = &answer[port.header()..];
                assert_eq!(payload[0], 1, "kIncompatibleLibraryVersion");
                let own = port.version.to_le_bytes();
                assert_eq!(payload[payload.len() - 2..], own, "{}", port.name);
            }
        });
    });
}

#[test]
fn silent_connections_keep_no_client_out_and_are_closed() {
    each_robot(|binary| {
        for port in binary.ports() {
            let mut silent: Vec<_> = (0..100).map(|_| port.dial()).collect();
            // The other connections are still open.
            assert_served(binary);
            let begun = Instant::now();
            for connection in &mut silent {
                assert_eq!(connection.read_to_end(), b"");
            }
            assert!(begun.elapsed() < SOON, "it stays open");
        }
        binary.assert_logged("connections to the robot have sent no message");
        binary.assert_logged("connection to the vacuum gripper closed: no message arrived");
    });
}

#[test]
fn a_handshake_that_breaks_off_keeps_no_client_out() {
    each_robot(|binary| {
        for port in binary.ports() {
            let hello = port.connect(port.version, 4711);
            let begin = |length: usize| {
                let mut broken = port.dial();
                broken.send(&hello[..length]);
                broken
            };
            let lengths = [1, port.header() - 1, port.header(), hello.len() - 1];
            // The good client must be served during the silence.
            let mut silent = lengths.map(begin);
            assert_served(binary);
            for broken in &mut silent {
                assert_eq!(broken.read_to_end(), b"");
            }
            // The connection ends with a close or with a reset.
            for end in [drop, Connection::reset] {
                lengths.map(begin).into_iter().for_each(end);
                assert_served(binary);
            }
        }
    });
}

#[test]
fn a_handshake_may_come_byte_by_byte_and_name_any_port() {
    each_robot(|binary| {
        each_port(binary, |port| {
            let mut slow = port.dial();
            slow.trickle(&port.connect(port.version, 4711));
            let answer = slow.read(port.header() + 1).expect("an answer");
            assert_eq!(answer[port.header()], 0, "kSuccess");
            drop(slow);
            // States can reach neither port 0 nor a closed port.
            for udp_port in [0, 1, 9] {
                let begun = Instant::now();
                loop {
                    let mut connection = port.dial();
                    connection.send(&port.connect(port.version, udp_port));
                    if connection.read(port.header() + 1).is_some() {
                        break;
                    }
                    assert!(begun.elapsed() < SOON, "{} accepts no client", port.name);
                }
            }
        });
    });
}

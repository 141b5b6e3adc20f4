//! Sessions with a client that violates the protocol.

use franka_proto::RobotState;

use crate::each_robot;
use crate::good::assert_served;
use crate::port::{Connection, receive};

#[test]
fn a_message_that_is_none_ends_the_session() {
    each_robot(|binary| {
        for port in binary.ports() {
            let stop = port.stop;
            for (what, bytes) in [
                ("no message", vec![0xff; 200]),
                ("zeros", vec![0; 200]),
                ("a size of nothing", port.announcing(0, stop, 1)),
                (
                    "a size below the header's",
                    port.announcing(port.header() as u32 - 1, stop, 1),
                ),
                ("a size above the bound", port.announcing(1025, stop, 1)),
                ("4 GiB", port.announcing(u32::MAX, stop, 1)),
                ("a second Connect", port.connect(port.version, 4711)),
                ("an unknown command", port.message(14, 1, &[])),
                ("a far unknown command", port.message(0xfffe, 1, &[])),
                (
                    "less than the parameters",
                    port.message(port.setter, 1, &[0; 3]),
                ),
                ("no parameters", port.message(port.setter, 1, &[])),
            ] {
                let (mut connection, _udp) = port.shake_hands();
                connection.send(&bytes);
                assert_eq!(connection.read_to_end(), b"", "{}: {what}", port.name);
                assert_served(binary);
            }
            binary.assert_logged(&format!("client of the {} disconnected", port.name));
        }
    });
}

#[test]
fn a_message_that_breaks_off_ends_the_session() {
    each_robot(|binary| {
        for port in binary.ports() {
            let setter = port.message(port.setter, 1, &[0; 400]);
            for length in [1, port.header() + 1] {
                // After silence, the session continues for some time, and then ends.
                let (mut connection, udp) = port.shake_hands();
                connection.send(&setter[..length]);
                receive(&udp, &mut []);
                assert_served(binary);
                assert_eq!(connection.read_to_end(), b"", "{length} bytes");
                for end in [drop, Connection::reset] {
                    let (mut connection, _udp) = port.shake_hands();
                    connection.send(&setter[..length]);
                    end(connection);
                    assert_served(binary);
                }
            }
            binary.assert_logged(&format!(
                "client of the {} disconnected in the middle",
                port.name
            ));
        }
    });
}

#[test]
fn unusual_message_is_answered() {
    each_robot(|binary| {
        for port in binary.ports() {
            let (mut connection, _udp) = port.shake_hands();
            let status = |connection: &mut Connection, id: u32| {
                // A status has one byte on the robot's stream, and two bytes on the other streams.
                let length = port.header() + if port.name == "robot" { 1 } else { 2 };
                let answer = connection.read(length).expect("an answer");
                let place = port.header() - 8;
                assert_eq!(answer[place..place + 4], id.to_le_bytes(), "{}", port.name);
                answer[port.header()]
            };
            // The message arrives byte by byte.
            connection.trickle(&port.message(port.stop, 1, &[]));
            assert_eq!(status(&mut connection, 1), 0);
            // The message is longer than needed.
            connection.send(&port.message(port.stop, 2, &[0xff; 64]));
            assert_eq!(status(&mut connection, 2), 0);
            // An id is used again after its answer, and ids decrease.
            for id in [2, 2, 1, 0, u32::MAX] {
                connection.send(&port.message(port.stop, id, &[]));
                assert_eq!(status(&mut connection, id), 0);
            }
            // Many requests come at once, and the client reads all answers.
            let burst: Vec<u8> = (10..60)
                .flat_map(|id| port.message(port.stop, id, &[]))
                .collect();
            connection.send(&burst);
            for id in 10..60 {
                assert_eq!(status(&mut connection, id), 0);
            }
            drop(connection);
            assert_served(binary);
        }
    });
}

#[test]
fn a_flood_of_requests_holds_up_no_state() {
    each_robot(|binary| {
        let port = binary.robot();
        let (mut connection, udp) = port.shake_hands();
        let count = 30_000;
        let flood: Vec<u8> = (1..=count)
            .flat_map(|id| port.message(port.stop, id, &[]))
            .collect();
        let mut writer = connection.another();
        let newest = || {
            let mut bytes = [0; RobotState::MAX_SIZE];
            let length = receive(&udp, &mut bytes).0;
            let state = RobotState::decode(binary.version(), &bytes[..length]);
            state.expect("a state").message_id
        };
        let before = newest();
        let answers = count as usize * (port.header() + 1);
        std::thread::scope(|scope| {
            scope.spawn(|| writer.send(&flood));
            let reading = scope.spawn(|| connection.read(answers));
            while !reading.is_finished() {
                newest();
            }
            let answered = reading.join().expect("no panic");
            assert!(answered.is_some(), "every request is answered");
        });
        // The thread processes 32 requests between two states. A slow reader misses some of these
        // states, and may see an old state at the end.
        let (states, due) = (newest() - before, u64::from(count / 64));
        assert!(states > due, "{states} states, at least {due} expected");
        drop((connection, writer));
        assert_served(binary);
    });
}

//! Datagrams to the robot's UDP port that are not commands of its client.

use std::net::UdpSocket;

use franka_proto::{
    MoveControllerMode, MoveGeneratorMode, MoveStatus, RobotCommand, RobotError, Status,
};

use crate::client::Client;
use crate::each_robot;
use crate::good::{assert_moves, assert_moves_during, assert_served};
use crate::port::receive;

/// Addresses of senders on the client's host, and on another host.
const SOURCES: [&str; 2] = ["127.0.0.1:0", "127.0.0.2:0"];

/// Commands from other sockets must have no effect, even from the client's host.
#[test]
fn only_the_socket_that_the_client_announced_commands() {
    each_robot(|binary| {
        let mut client = Client::connect(binary);
        client.start(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointVelocity,
        );
        let foreign = SOURCES.map(|source| UdpSocket::bind(source).expect("Linux"));
        let q = client.state.q;
        for _ in 0..200 {
            let mut faster = client.holding();
            faster.dq_c[0] = client.state.dq_d[0] + 0.005;
            for socket in &foreign {
                client.send_from(socket, &faster);
            }
            client.send(&client.holding());
            client.next_state();
        }
        assert!(client.state.motion_running());
        assert!(client.state.errors.is_empty(), "{:?}", client.state.errors);
        assert!((client.state.q[0] - q[0]).abs() < 1e-3);
        drop(client);
        assert_served(binary);
    });
}

/// Lengths near the lengths of commands and states, and the largest length of a UDP datagram.
const LENGTHS: [usize; 9] = [0, 1, 8, 369, 370, 371, 1377, 2373, 65_507];

#[test]
fn garbage_disturbs_no_client_in_a_motion_or_without_one() {
    each_robot(|binary| {
        // The states come from this address for all clients.
        let targets = binary.ports().each_ref().map(|port| {
            let (_connection, udp) = port.shake_hands();
            receive(&udp, &mut []).1
        });
        let spray = || {
            for source in SOURCES {
                let socket = UdpSocket::bind(source).expect("Linux");
                for length in LENGTHS {
                    for byte in [0x00, 0x7f, 0xff] {
                        for target in targets {
                            socket.send_to(&vec![byte; length], target).expect("sent");
                        }
                    }
                }
            }
        };
        spray();
        assert_served(binary);
        assert_moves_during(binary, spray);
        assert_served(binary);
    });
}

#[test]
fn a_flood_is_over_when_it_is_over() {
    each_robot(|binary| {
        let (robot, _) = Client::connect(binary).addresses();
        let socket = UdpSocket::bind(SOURCES[0]).expect("a port");
        for _ in 0..100_000 {
            // If the buffer is full, it drops further datagrams.
            let _ = socket.send_to(&[0xff; 371], robot);
        }
        assert_served(binary);
    });
}

#[test]
fn commands_that_answer_no_newest_state_do_not_count() {
    each_robot(|binary| {
        let mut client = Client::connect(binary);
        let id = client.start(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointPosition,
        );
        let elsewhere = |client: &Client, message_id| RobotCommand {
            message_id,
            q_c: [1.0; 7],
            ..client.holding()
        };
        for _ in 0..50 {
            let newest = client.state.message_id;
            for wrong in [
                0,
                1,
                newest - 1,
                newest + 2,
                newest + 1000,
                u64::MAX - 1,
                u64::MAX,
            ] {
                client.send(&elsewhere(&client, wrong));
            }
            client.send(&client.holding());
            // A second answer to the same state does not count either.
            client.send(&elsewhere(&client, newest));
            client.next_state();
        }
        assert!(client.state.motion_running());
        assert!(client.state.errors.is_empty());

        // Without the client's own commands, these datagrams count as silence.
        let status = loop {
            client.send(&elsewhere(&client, u64::MAX));
            client.next_state();
            if !client.state.motion_running() {
                break client.status(id);
            }
        };
        assert_eq!(status, Status::Move(MoveStatus::ReflexAborted));
        let reason = client.state.reflex_reason;
        assert_eq!(reason, RobotError::CommunicationConstraintsViolation.into());
        drop(client);
        assert_served(binary);
        assert_moves(binary);
    });
}

#[test]
fn commands_without_a_motion_change_nothing() {
    each_robot(|binary| {
        let mut client = Client::connect(binary);
        let q = client.state.q;
        for _ in 0..200 {
            client.send(&RobotCommand {
                message_id: client.state.message_id,
                q_c: [0.5; 7],
                dq_c: [1.0; 7],
                tau_J_d: [50.0; 7],
                motion_generation_finished: true,
                ..RobotCommand::default()
            });
            client.next_state();
        }
        assert!(!client.state.motion_running());
        assert!(client.state.errors.is_empty());
        for (now, before) in client.state.q.iter().zip(q) {
            assert!((now - before).abs() < 1e-3, "{:?}", client.state.q);
        }
        drop(client);
        assert_served(binary);
    });
}

//! Clients that violate the protocol, or disconnect, in the middle of a motion.

use franka_proto::{
    CommandId, MoveControllerMode, MoveGeneratorMode, MoveRequest, MoveStatus, Request, Status,
};

use crate::client::Client;
use crate::each_robot;
use crate::good::{assert_moves, assert_served, recover};
use crate::port::Connection;

const CONTROLLER: MoveControllerMode = MoveControllerMode::JointImpedance;
const GENERATOR: MoveGeneratorMode = MoveGeneratorMode::JointPosition;

fn motion() -> Request {
    Request::Move(MoveRequest::new(CONTROLLER, GENERATOR))
}

#[test]
fn a_client_may_vanish_before_its_motion_is_answered() {
    each_robot(|binary| {
        for end in [drop, Connection::reset] {
            for _ in 0..3 {
                let mut client = Client::connect(binary);
                client.request(&motion());
                end(client.connection);
                assert_served(binary);
            }
            // The second case is a motion that has begun.
            let mut client = Client::connect(binary);
            client.start(CONTROLLER, GENERATOR);
            end(client.connection);
            assert_served(binary);
        }
        assert_moves(binary);
    });
}

#[test]
fn a_client_may_leave_the_protocol_while_it_moves() {
    each_robot(|binary| {
        let port = binary.robot();
        for bytes in [
            vec![0xff; 100],
            port.connect(port.version, 4711),
            port.announcing(u32::MAX, port.stop, 9),
            // The id is the id of the motion, which still has no answer.
            port.message(port.stop, 1, &[]),
        ] {
            let mut client = Client::connect(binary);
            assert_eq!(client.start(CONTROLLER, GENERATOR), CommandId(1));
            client.connection.send(&bytes);
            // The client may still receive the end of its motion.
            client.connection.read_to_end();
            assert_served(binary);
            recover(binary);
        }
        assert_moves(binary);
    });
}

#[test]
fn a_client_may_go_silent_while_it_moves() {
    each_robot(|binary| {
        let mut client = Client::connect(binary);
        let id = client.start(CONTROLLER, GENERATOR);
        // Twenty states without an answer are too many.
        let status = client.status(id);
        assert_eq!(status, Status::Move(MoveStatus::ReflexAborted));
        drop(client);
        assert_served(binary);
        assert_moves(binary);
    });
}

#[test]
fn motions_in_a_row_preempt_each_other() {
    each_robot(|binary| {
        let mut client = Client::connect(binary);
        let ids: Vec<_> = (0..20).map(|_| client.request(&motion())).collect();
        for &id in &ids[..ids.len() - 1] {
            let mut status = client.status(id);
            if status == Status::Move(MoveStatus::MotionStarted) {
                status = client.status(id);
            }
            assert_eq!(status, Status::Move(MoveStatus::Preempted));
        }
        drop(client);
        assert_served(binary);
    });
}

#[test]
fn non_finite_and_huge_parameters_are_invalid_arguments() {
    each_robot(|binary| {
        let mut client = Client::connect(binary);
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut request = MoveRequest::new(CONTROLLER, GENERATOR);
            request.maximum_path_deviation.rotation = bad;
            let id = client.request(&Request::Move(request));
            let invalid = Status::Move(MoveStatus::InvalidArgumentRejected);
            assert_eq!(client.status(id), invalid, "{bad}");
            for setter in setters(bad) {
                let id = client.request(&setter);
                let status = client.status(id);
                assert!(!status.is_success(), "{setter:?}");
            }
        }
        for huge in [1e6, 1e20, 1e300] {
            for setter in setters(huge) {
                let id = client.request(&setter);
                let status = client.status(id);
                // No force reaches such a threshold, so it is harmless.
                let is_harmless = matches!(setter, Request::SetCollisionBehavior(_));
                assert_eq!(status.is_success(), is_harmless, "{setter:?}");
            }
            let state = client.next_state();
            assert!(
                state
                    .q
                    .iter()
                    .chain(&state.dq)
                    .all(|value| value.is_finite())
            );
        }
        drop(client);
        assert_served(binary);
        assert_moves(binary);
    });
}

/// Returns every setter of both versions, with this number in one place.
fn setters(bad: f64) -> [Request; 6] {
    let torque = [20.0; 7];
    let mut force = [20.0; 6];
    force[5] = bad;
    let mut frame = [0.0; 16];
    for i in 0..4 {
        frame[5 * i] = 1.0;
    }
    frame[13] = bad;
    [
        Request::SetCollisionBehavior(franka_proto::CollisionBehavior::uniform(
            torque, torque, force, force,
        )),
        Request::SetJointImpedance([3000.0, 3000.0, 3000.0, bad, 3000.0, 3000.0, 3000.0]),
        Request::SetCartesianImpedance(force),
        Request::SetEEToK(frame),
        Request::SetNEToEE(frame),
        Request::SetLoad(franka_proto::Load {
            m_load: bad,
            ..franka_proto::Load::default()
        }),
    ]
}

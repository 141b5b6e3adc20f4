//! Commands of a motion that contain a non-finite number, in every field of every generator.

use franka_proto::{
    MoveControllerMode, MoveGeneratorMode, MoveStatus, RobotCommand, RobotMode, Status,
};

use crate::client::Client;
use crate::each_robot;
use crate::good::{assert_moves, assert_served};

const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// A motion, and its invalid commands: one command for each place of the invalid number.
struct BadCommands {
    controller: MoveControllerMode,
    generator: MoveGeneratorMode,
    places: usize,
    spoil: fn(&mut RobotCommand, usize, f64),
}

const BAD_COMMANDS: [BadCommands; 6] = [
    BadCommands {
        controller: MoveControllerMode::JointImpedance,
        generator: MoveGeneratorMode::JointPosition,
        places: 7,
        spoil: |command, place, bad| command.q_c[place] = bad,
    },
    BadCommands {
        controller: MoveControllerMode::JointImpedance,
        generator: MoveGeneratorMode::JointVelocity,
        places: 7,
        spoil: |command, place, bad| command.dq_c[place] = bad,
    },
    BadCommands {
        controller: MoveControllerMode::CartesianImpedance,
        generator: MoveGeneratorMode::CartesianPosition,
        places: 16,
        spoil: |command, place, bad| command.O_T_EE_c[place] = bad,
    },
    BadCommands {
        controller: MoveControllerMode::JointImpedance,
        generator: MoveGeneratorMode::CartesianPosition,
        places: 2,
        spoil: |command, place, bad| {
            let mut elbow = [0.0, -1.0];
            elbow[place] = bad;
            command.elbow_c = Some(elbow);
        },
    },
    BadCommands {
        controller: MoveControllerMode::JointImpedance,
        generator: MoveGeneratorMode::CartesianVelocity,
        places: 6,
        spoil: |command, place, bad| command.O_dP_EE_c[place] = bad,
    },
    BadCommands {
        controller: MoveControllerMode::ExternalController,
        generator: MoveGeneratorMode::JointVelocity,
        places: 7,
        spoil: |command, place, bad| command.tau_J_d[place] = bad,
    },
];

#[test]
fn non_finite_command_ends_motion_and_disturbs_no_client() {
    each_robot(|binary| {
        for trial in &BAD_COMMANDS {
            for place in 0..trial.places {
                let bad = BAD[place % BAD.len()];
                // For torques alone, the generator differs between the versions.
                let generator = match trial.controller {
                    MoveControllerMode::ExternalController => binary.version().torque_generator(),
                    _ => trial.generator,
                };
                let what = format!("{generator:?}, place {place}, {bad}");
                let mut client = Client::connect(binary);
                let id = client.start(trial.controller, generator);
                let status = loop {
                    let mut command = client.holding();
                    (trial.spoil)(&mut command, place, bad);
                    client.send(&command);
                    client.next_state();
                    if !client.state.motion_running() {
                        break client.status(id);
                    }
                };
                // Invalid input is refused; a matrix that is not a pose causes a reflex.
                let refusals = [
                    Status::Move(MoveStatus::InputErrorAborted),
                    Status::Move(MoveStatus::ReflexAborted),
                ];
                assert!(refusals.contains(&status), "{what}: {status:?}");
                let state = client.next_state();
                assert!(state.q.iter().all(|q| q.is_finite()), "{what}");
                assert!(state.O_T_EE_c.iter().all(|x| x.is_finite()), "{what}");
                if state.robot_mode == RobotMode::Reflex {
                    let recovery = client.request(&franka_proto::Request::AutomaticErrorRecovery);
                    assert!(client.status(recovery).is_success(), "{what}");
                }
                drop(client);
                assert_served(binary);
            }
        }
        assert_moves(binary);
    });
}

#[test]
fn requests_of_the_end_effectors_with_non_finite_numbers_fail() {
    each_robot(|binary| {
        let [_, hand, vacuum] = binary.ports();
        let numbers =
            |numbers: &[f64]| -> Vec<u8> { numbers.iter().flat_map(|n| n.to_le_bytes()).collect() };
        let mut requests = Vec::new();
        for bad in BAD {
            requests.push((hand, 3, numbers(&[bad, 0.1])));
            requests.push((hand, 3, numbers(&[0.0, bad])));
            for place in 0..5 {
                let mut grasp = [0.02, 0.005, 0.005, 0.1, 40.0];
                grasp[place] = bad;
                requests.push((hand, 2, numbers(&grasp)));
            }
        }
        for timeout in [i64::MIN, -1] {
            let timeout = timeout.to_le_bytes();
            requests.push((vacuum, 2, timeout.to_vec()));
            requests.push((vacuum, 1, [&[10, 0], &timeout[..]].concat()));
        }
        // This profile does not exist.
        requests.push((vacuum, 1, [&[10, 4], &[0; 8][..]].concat()));
        for (port, command, payload) in requests {
            let (mut connection, _udp) = port.shake_hands();
            connection.send(&port.message(command, 1, &payload));
            let answer = connection.read(port.header() + 2).expect("an answer");
            let failed = [1, 0];
            assert_eq!(
                answer[port.header()..],
                failed,
                "{}: {payload:?}",
                port.name
            );
        }
        assert_served(binary);
    });
}

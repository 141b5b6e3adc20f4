//! Commands of a motion with numbers that are none, in every field of every generator.

use franka_proto::{
    MoveControllerMode, MoveGeneratorMode, MoveStatus, RobotCommand, RobotMode, Status,
};

use crate::client::Client;
use crate::each_robot;
use crate::good::{assert_moves, assert_served};

const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// A motion, and its commands with a bad number, one for each place.
struct Trial {
    controller: MoveControllerMode,
    generator: MoveGeneratorMode,
    places: usize,
    spoil: fn(&mut RobotCommand, usize, f64),
}

const TRIALS: [Trial; 6] = [
    Trial {
        controller: MoveControllerMode::JointImpedance,
        generator: MoveGeneratorMode::JointPosition,
        places: 7,
        spoil: |command, place, bad| command.q_c[place] = bad,
    },
    Trial {
        controller: MoveControllerMode::JointImpedance,
        generator: MoveGeneratorMode::JointVelocity,
        places: 7,
        spoil: |command, place, bad| command.dq_c[place] = bad,
    },
    Trial {
        controller: MoveControllerMode::CartesianImpedance,
        generator: MoveGeneratorMode::CartesianPosition,
        places: 16,
        spoil: |command, place, bad| command.O_T_EE_c[place] = bad,
    },
    Trial {
        controller: MoveControllerMode::JointImpedance,
        generator: MoveGeneratorMode::CartesianPosition,
        places: 2,
        spoil: |command, place, bad| {
            let mut elbow = [0.0, -1.0];
            elbow[place] = bad;
            command.elbow_c = Some(elbow);
        },
    },
    Trial {
        controller: MoveControllerMode::JointImpedance,
        generator: MoveGeneratorMode::CartesianVelocity,
        places: 6,
        spoil: |command, place, bad| command.O_dP_EE_c[place] = bad,
    },
    Trial {
        controller: MoveControllerMode::ExternalController,
        generator: MoveGeneratorMode::JointVelocity,
        places: 7,
        spoil: |command, place, bad| command.tau_J_d[place] = bad,
    },
];

#[test]
fn numbers_that_are_none_end_the_motion_and_harm_nobody() {
    each_robot(|binary| {
        for trial in &TRIALS {
            for place in 0..trial.places {
                let bad = BAD[place % BAD.len()];
                let what = format!("{:?}, place {place}, {bad}", trial.generator);
                let mut client = Client::connect(binary);
                let id = client.start(trial.controller, trial.generator);
                let status = loop {
                    let mut command = client.holding();
                    (trial.spoil)(&mut command, place, bad);
                    client.send(&command);
                    client.next_state();
                    if !client.state.motion_running() {
                        break client.status(id);
                    }
                };
                // Refused as input; where it is a matrix that is no pose, as that.
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

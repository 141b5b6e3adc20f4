//! The ends of a motion.

use franka_proto::{
    ControllerMode, MotionGeneratorMode, MoveControllerMode, MoveRequest, MoveStatus, Reply,
    RobotError, RobotMode, StopStatus, Version,
};
use franka_rt::control::{Callback, Finish, JointVelocities, Shaper, Torques};
use franka_rt::driver::Program;
use franka_rt::lifecycle::{END_TIMEOUT, MotionError, Stage};

use crate::for_each_version;
use crate::pair::Pair;

const DQ: JointVelocities = JointVelocities([0.125; 7]);
const TAU: Torques = Torques([0.5; 7]);

/// A motion at a constant velocity, with or without our own torques, for this many cycles.
fn moving(version: Version, external: bool, cycles: u32) -> (Program, MoveRequest) {
    let mut cycle = 0;
    let callback = Callback::motion::<JointVelocities, _>(version, move |_, _| {
        cycle += 1;
        if cycle < cycles {
            DQ.into()
        } else {
            DQ.finish()
        }
    });
    let callback = callback.with_shaper(Shaper::new(version, false, 1000.0));
    let callback = if external {
        callback.with_torques(|_, _| TAU)
    } else {
        callback
    };
    let request = callback.request(version, MoveControllerMode::JointImpedance);
    (Program::Callback(Box::new(callback)), request)
}

#[test]
fn scenario_9_a_finished_motion_succeeds() {
    for_each_version(|version| {
        // The robot's reply may come before or after its states show the end.
        for said_first in [false, true] {
            let mut pair = Pair::connected(version);
            let (program, request) = moving(version, false, 3);
            let motion = pair.begin(program, request);
            assert!(!motion.first.expect("an answer").motion_generation_finished);
            assert!(!pair.step().expect("an answer").motion_generation_finished);
            // The last command is repeated, each time for the newest state, while the states show
            // the motion.
            for _ in 0..4 {
                let last = pair.step().expect("an answer");
                assert_eq!(last.message_id, pair.robot.state.message_id);
                assert_eq!(last.dq_c, DQ.0);
                assert!(last.motion_generation_finished && !last.torque_command_finished);
            }
            if said_first {
                pair.robot.reply_move(motion.id, MoveStatus::Success);
                pair.settle();
                assert_eq!(pair.client.outcome(motion.work), None);
                pair.robot.rest();
                assert_eq!(pair.step(), None);
            } else {
                pair.robot.rest();
                assert_eq!(pair.step(), None);
                assert_eq!(pair.client.outcome(motion.work), None);
                pair.robot.reply_move(motion.id, MoveStatus::Success);
                pair.settle();
            }
            assert!(pair.outcome(motion.work).is_ok());
            pair.assert_idle();
        }
    });
}

#[test]
fn scenario_9_a_user_stop_while_a_motion_finishes() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let (program, request) = moving(version, false, 1);
        let motion = pair.begin(program, request);
        assert!(motion.first.expect("an answer").motion_generation_finished);
        pair.robot.rest();
        pair.robot
            .reply_move(motion.id, MoveStatus::EmergencyAborted);
        pair.step();
        let error = pair.control_error(motion.work);
        assert_eq!(
            error.to_string(),
            "libfranka: Move command aborted: User Stop pressed!"
        );
        pair.assert_idle();
    });
}

#[test]
fn scenario_9_a_motion_that_is_finished_at_speed() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        pair.robot.state.control_command_success_rate = 0.5;
        let (program, request) = moving(version, false, 2);
        let motion = pair.begin(program, request);
        pair.step();
        pair.robot.rest();
        pair.robot.state.robot_mode = RobotMode::Reflex;
        pair.robot.state.reflex_reason =
            RobotError::JointMotionGeneratorVelocityDiscontinuity.into();
        pair.robot.reply_move(motion.id, MoveStatus::ReflexAborted);
        pair.step();
        let error = pair.control_error(motion.work);
        assert_eq!(error.stage, Stage::Finishing);
        assert_eq!(
            error.to_string(),
            "Motion finished commanded, but the robot is still moving! \
             [\"joint_motion_generator_velocity_discontinuity\"]\n\
             control_command_success_rate: 0.5"
        );
    });
}

#[test]
fn scenario_10_torque_motion_ends_when_modes_are_gone() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let (program, request) = moving(version, true, 2);
        let motion = pair.begin(program, request);
        let last = pair.step().expect("an answer");
        assert!(last.motion_generation_finished && !last.torque_command_finished);
        assert_eq!((last.dq_c, last.tau_J_d), (DQ.0, TAU.0));
        pair.robot.state.motion_generator_mode = MotionGeneratorMode::Idle;
        pair.robot.state.controller_mode = ControllerMode::JointImpedance;
        assert_eq!(pair.robot.state.robot_mode, RobotMode::Move);
        assert_eq!(pair.step(), None);
        pair.robot.reply_move(motion.id, MoveStatus::Success);
        pair.settle();
        assert!(pair.outcome(motion.work).is_ok());
        pair.assert_idle();
    });
}

#[test]
fn scenario_11_a_cancelled_motion_is_stopped() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let (program, request) = moving(version, false, 100);
        let motion = pair.begin(program, request);
        pair.client.cancel(motion.work);
        pair.settle();
        pair.robot.obey_stop(motion.id);
        assert_eq!(pair.step(), None);
        assert_eq!(pair.error(motion.work), MotionError::Stopped);
        pair.assert_idle();
    });
}

/// The stop resolves when the arm rests, and the motion resolves as stopped. The answer to the
/// `Move` may come late.
#[test]
fn scenario_11_a_stop_resolves_itself_and_the_motion() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let (program, request) = moving(version, false, 100);
        let motion = pair.begin(program, request);
        let stop = pair.client.stop().expect("something moves");
        let again = pair.client.stop().expect("and still does");
        pair.settle();
        let id = pair.robot.expect_stop();
        assert_eq!(pair.robot.take_request(), None, "one stop is enough");
        pair.robot.reply(id, Reply::StopMove(StopStatus::Success));
        pair.robot.rest();
        for _ in 0..20 {
            assert_eq!(pair.step(), None);
            assert_eq!(pair.client.outcome(motion.work), None);
        }
        pair.robot.reply_move(motion.id, MoveStatus::Preempted);
        pair.settle();
        assert_eq!(pair.error(motion.work), MotionError::Stopped);
        assert!(pair.outcome(stop).is_ok() && pair.outcome(again).is_ok());
        pair.assert_idle();
    });
}

/// libfranka throws when the stop is refused, and abandons the motion. This driver waits for the
/// end of the motion. It requests the stop once more, sends no more commands, and then reports that
/// the robot neither ran nor stopped the motion.
#[test]
fn scenario_11_a_stop_that_is_refused() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let (program, request) = moving(version, false, 1_000_000);
        let motion = pair.begin(program, request);
        pair.client.cancel(motion.work);
        pair.settle();
        let refused = Reply::StopMove(StopStatus::CommandNotPossibleRejected);
        let stop = pair.robot.expect_stop();
        pair.robot.reply(stop, refused);
        let patience = END_TIMEOUT.as_millis() as u64;
        for _ in 1..patience {
            assert!(pair.step().is_some());
        }
        assert_eq!(pair.robot.take_request(), None);
        pair.step();
        let stop = pair.robot.expect_stop();
        pair.robot.reply(stop, refused);
        for _ in 0..patience - 1 {
            assert_eq!(pair.step(), None);
            assert_eq!(pair.client.outcome(motion.work), None);
        }
        pair.step();
        let what = "the robot neither ran nor stopped the motion";
        assert_eq!(pair.error(motion.work), MotionError::Protocol { what });

        // Without commands the robot ends the motion after all, and accepts the next.
        pair.robot.reply_move(motion.id, MoveStatus::ReflexAborted);
        pair.robot.rest();
        pair.step();
        pair.assert_idle();
        let (program, request) = moving(version, false, 1);
        let next = pair.begin(program, request);
        pair.succeed(&next);
    });
}

#[test]
fn scenario_12_reflex_ends_motion_with_reason_and_log() {
    for_each_version(|version| {
        for said_first in [false, true] {
            for (lost, rate) in [
                (0, "0.875"),
                (4, "0.84 packets lost in a row in the last sample: 4"),
            ] {
                let mut pair = Pair::connected(version);
                pair.robot.state.control_command_success_rate = 0.875;
                let (program, request) = moving(version, false, 100);
                let motion = pair.begin(program, request);
                let begun = pair.robot.state.message_id;
                for _ in 0..3 {
                    assert!(pair.step().is_some());
                }
                pair.robot.state.motion_generator_mode = MotionGeneratorMode::Idle;
                pair.robot.state.robot_mode = RobotMode::Reflex;
                pair.robot.state.reflex_reason = RobotError::JointPositionLimitsViolation.into();
                pair.robot.state.errors = RobotError::JointPositionLimitsViolation.into();
                pair.robot.state.control_command_success_rate = 0.0;
                pair.robot.state.message_id += lost;
                if said_first {
                    pair.robot.reply_move(motion.id, MoveStatus::ReflexAborted);
                    pair.settle();
                    assert_eq!(pair.step(), None);
                } else {
                    assert_eq!(pair.step(), None);
                    pair.robot.reply_move(motion.id, MoveStatus::ReflexAborted);
                    pair.settle();
                }
                let error = pair.control_error(motion.work);
                assert!(error.is_reflex());
                assert_eq!(
                    error.to_string(),
                    format!(
                        "libfranka: Move command aborted: motion aborted by reflex! \
                         [\"joint_position_limits_violation\"]\n\
                         control_command_success_rate: {rate}"
                    )
                );
                let times: Vec<_> = error
                    .log
                    .iter()
                    .map(|entry| entry.state.message_id)
                    .collect();
                let mut expected: Vec<_> = (begun..begun + 4).collect();
                expected.push(begun + 4 + lost);
                assert_eq!(times, expected);
                let last = error.log.iter().next_back().expect("entries");
                assert!(
                    last.state
                        .reflex_reason
                        .contains(RobotError::JointPositionLimitsViolation)
                );
                assert_eq!(
                    (last.command.message_id, last.command.dq_c),
                    (begun + 3, DQ.0)
                );
                pair.assert_idle();
            }
        }
    });
}

/// A motion has also ended if only its controller has gone.
#[test]
fn scenario_12_any_mode_that_changes_ends_the_motion() {
    for_each_version(|version| {
        for change in [
            |pair: &mut Pair| pair.robot.state.controller_mode = ControllerMode::Other,
            |pair: &mut Pair| {
                pair.robot.state.motion_generator_mode = MotionGeneratorMode::CartesianVelocity;
            },
            |pair: &mut Pair| pair.robot.state.robot_mode = RobotMode::UserStopped,
        ] {
            let mut pair = Pair::connected(version);
            let (program, request) = moving(version, true, 100);
            let motion = pair.begin(program, request);
            change(&mut pair);
            assert_eq!(pair.step(), None);
            pair.robot.reply_move(motion.id, MoveStatus::ReflexAborted);
            pair.settle();
            assert!(pair.control_error(motion.work).is_reflex());
            pair.robot.rest();
            assert_eq!(pair.step(), None);
            pair.assert_idle();
        }
    });
}

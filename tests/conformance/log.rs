//! The last cycles of a motion.

use franka_proto::{MoveControllerMode, MoveStatus, RobotCommand, RobotError, RobotMode, Version};
use franka_rt::control::{Callback, JointVelocities, Shaper};
use franka_rt::driver::Program;
use franka_rt::lifecycle::ControlError;

use crate::for_each_version;
use crate::pair::Pair;

/// Runs a motion of this many cycles with different commands; a reflex ends it in the last cycle.
/// Returns the error, and the commands as the robot received them.
fn reflex_after(
    pair: &mut Pair,
    version: Version,
    cycles: u64,
) -> (ControlError, Vec<RobotCommand>) {
    let mut speed = 0.0;
    let callback = Callback::motion(version, move |_, _| {
        speed += 1.0 / 1024.0;
        JointVelocities([speed; 7])
    });
    let callback = callback.with_shaper(Shaper::new(version, false, 1000.0));
    let request = callback.request(version, MoveControllerMode::JointImpedance);
    let motion = pair.begin(Program::Callback(Box::new(callback)), request);
    let mut commands = vec![motion.first.expect("an answer")];
    for _ in 2..cycles {
        commands.push(pair.step().expect("an answer"));
    }
    pair.robot.rest();
    pair.robot.state.robot_mode = RobotMode::Reflex;
    pair.robot.state.reflex_reason = RobotError::JointVelocityViolation.into();
    pair.robot.reply_move(motion.id, MoveStatus::ReflexAborted);
    assert_eq!(pair.step(), None);
    let error = pair.control_error(motion.work);
    pair.assert_idle();
    (error, commands)
}

/// Asserts that the log pairs each state with the command sent for the previous one; `commands` are
/// the last ones.
fn assert_paired(error: &ControlError, last_state: u64, commands: &[RobotCommand]) {
    assert_eq!(error.log.len(), commands.len());
    let first = last_state + 1 - commands.len() as u64;
    for ((entry, command), id) in error.log.iter().zip(commands).zip(first..) {
        assert_eq!(entry.state.message_id, id);
        assert_eq!(entry.command, *command);
        assert_eq!(command.message_id, id - 1);
    }
}

#[test]
fn scenario_14_the_log_has_the_last_cycles() {
    for_each_version(|version| {
        let mut pair = Pair::with_log_size(version, 5);
        let (error, commands) = reflex_after(&mut pair, version, 11);
        assert_eq!(commands.len(), 10, "the last state has no answer");
        assert_paired(&error, pair.robot.state.message_id, &commands[5..]);
    });
}

#[test]
fn scenario_14_the_log_has_one_motion_only() {
    for_each_version(|version| {
        let mut pair = Pair::with_log_size(version, 5);
        reflex_after(&mut pair, version, 11);
        for _ in 0..7 {
            assert_eq!(pair.step(), None);
        }
        let (error, commands) = reflex_after(&mut pair, version, 4);
        // The first state of a motion comes before any command.
        let first = error.log.iter().next().expect("entries");
        assert_eq!(first.command, RobotCommand::default());
        let last_state = pair.robot.state.message_id;
        assert_eq!(first.state.message_id, last_state - 3);
        assert_eq!(error.log.len(), 4);
        for (entry, command) in error.log.iter().skip(1).zip(&commands) {
            assert_eq!(entry.command, *command);
            assert_eq!(entry.state.message_id, command.message_id + 1);
        }
    });
}

/// The success rate is from the last entry but one, so it needs two entries.
#[test]
fn scenario_14_a_log_may_be_short_or_absent() {
    let text = "libfranka: Move command aborted: motion aborted by reflex! \
                [\"joint_velocity_violation\"]";
    for_each_version(|version| {
        for (cycles, rate) in [
            (0, ""),
            (1, ""),
            (2, "\ncontrol_command_success_rate: 0.25"),
            (50, "\ncontrol_command_success_rate: 0.25"),
        ] {
            let mut pair = Pair::with_log_size(version, cycles);
            pair.robot.state.control_command_success_rate = 0.25;
            let (error, _) = reflex_after(&mut pair, version, 11);
            assert_eq!(error.log.len(), cycles.min(11));
            assert_eq!(error.to_string(), format!("{text}{rate}"));
            let lines = error.log.to_csv().lines().count();
            assert_eq!(lines, if cycles == 0 { 0 } else { cycles.min(11) + 1 });
        }
    });
}

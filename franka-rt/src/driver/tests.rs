//! The driver beside states and programs that a test makes up.

use franka_model::{Model, READY};
use franka_proto::{ControllerMode, MotionGeneratorMode, RobotMode, RobotState, Version};

use super::*;
use crate::control::{ActiveControl, Callback, Torques};
use crate::law::Gains;
use crate::session::{Budget, Goal, GoalId, Target, TargetSession, Then, Tolerance};
use crate::shaping::{InvalidCommand, Shaper};
use crate::slot;

const MODES: Modes = Modes {
    generator: MotionGeneratorMode::None,
    controller: ControllerMode::ExternalController,
};

fn moving(time: u64) -> RobotState {
    RobotState {
        message_id: time,
        q: READY.into(),
        motion_generator_mode: MODES.generator,
        controller_mode: MODES.controller,
        robot_mode: RobotMode::Move,
        ..RobotState::default()
    }
}

fn armed(target: Target) -> Driver {
    let (mut goals, reader) = slot::slot();
    goals.write(&Goal {
        id: GoalId(1),
        target,
        then: Then::Finish,
        budget: Budget::of(Model::fr3().joint_limits()),
        gains: Gains::joint(),
        tolerance: Tolerance::default(),
    });
    let mut driver = Driver::new(Version::V10);
    driver.on_order(Order::Arm {
        motion: MotionId(1),
        modes: MODES,
        program: Program::Target(Box::new(TargetSession::new(
            Model::fr3().clone().into(),
            reader,
        ))),
        log: ControlLog::with_capacity(5),
        ticket: None,
    });
    driver
}

#[test]
fn a_state_that_is_not_finite_gets_no_answer_and_does_no_harm() {
    let mut target: [f64; 7] = READY.into();
    target[0] += 0.1;
    for spoil in [
        |state: &mut RobotState| state.q[3] = f64::NAN,
        |state: &mut RobotState| state.dq[0] = f64::INFINITY,
        |state: &mut RobotState| state.tau_J_d[6] = f64::NAN,
    ] {
        let mut driver = armed(Target::Joints(target));
        let mut time = 100;
        for step in 0..60 {
            time += 1;
            let mut state = moving(time);
            let bad = step < 2 || step % 7 == 0;
            if bad {
                spoil(&mut state);
            }
            let command = driver.on_state(&state);
            assert_eq!(command.is_none(), bad, "cycle {step}");
            if let Some(command) = command {
                assert!(command.tau_J_d.iter().all(|tau| tau.is_finite()));
            }
        }
        let mut state = moving(time + 1);
        state.q[3] = f64::NAN;
        state.robot_mode = RobotMode::Reflex;
        assert!(driver.on_state(&state).is_none());
        assert!(driver.is_watching(), "a reflex is seen all the same");
    }
}

/// A state at rest, after a motion.
fn resting(time: u64) -> RobotState {
    RobotState {
        message_id: time,
        ..RobotState::default()
    }
}

fn armed_with(program: Program) -> Driver {
    let mut driver = Driver::new(Version::V10);
    driver.on_order(Order::Arm {
        motion: MotionId(1),
        modes: MODES,
        program,
        log: ControlLog::with_capacity(5),
        ticket: None,
    });
    driver
}

fn torques(function: impl FnMut(u64) -> f64 + Send + 'static) -> Program {
    let mut function = function;
    let callback = Callback::torques(Version::V10, move |state: &RobotState, _| {
        Torques([function(state.message_id); 7])
    });
    let shaper = Shaper::new(Version::V10, false, 1000.0);
    Program::Callback(Box::new(callback.with_shaper(shaper)))
}

#[test]
fn a_program_that_fails_leaves_the_motion_without_commands_until_the_robot_ends_it() {
    let mut driver = armed_with(torques(|time| if time < 103 { 1.0 } else { f64::NAN }));
    assert!(driver.on_state(&moving(101)).is_some());
    assert!(driver.on_state(&moving(102)).is_some());
    assert!(driver.on_state(&moving(103)).is_none());
    assert_eq!(driver.record().activity, Activity::Silent);
    assert!(matches!(driver.take_event(), Some(Event::Started { .. })));
    let Some(Event::Failed { motion, failure }) = driver.take_event() else {
        panic!("it has failed")
    };
    assert_eq!(motion, MotionId(1));
    assert!(matches!(
        failure,
        Failure::Invalid(InvalidCommand::NotFinite)
    ));
    for time in 104..110 {
        assert!(driver.on_state(&moving(time)).is_none());
        assert!(driver.take_event().is_none());
        assert!(!driver.is_watching());
    }
    assert!(driver.on_state(&resting(110)).is_none());
    let Some(Event::Ended(ended)) = driver.take_event() else {
        panic!("it has ended")
    };
    assert_eq!(ended.ending, Ending::Aborted);
    assert_eq!(ended.log.len(), 5, "it is noted to the end");
    assert!(driver.is_watching());
}

#[test]
fn a_motion_told_to_be_silent_gets_no_more_commands_in_any_phase() {
    let silence = || Order::Silence {
        motion: MotionId(1),
    };
    let mut armed = armed_with(torques(|_| 1.0));
    armed.on_order(silence());
    assert!(armed.is_watching());
    assert!(
        matches!(armed.take_event(), Some(Event::Ended(ended)) if ended.ending == Ending::Disarmed)
    );
    assert!(armed.on_state(&moving(101)).is_none());

    let mut running = armed_with(torques(|_| 1.0));
    assert!(running.on_state(&moving(101)).is_some());
    running.on_order(Order::Silence {
        motion: MotionId(2),
    });
    assert!(running.on_state(&moving(102)).is_some(), "another is meant");
    running.on_order(silence());
    assert!(running.on_state(&moving(103)).is_none());
    assert!(running.on_state(&resting(104)).is_none());
    assert!(running.is_watching());

    let mut finishing = armed_with(Program::Active(ActiveControl));
    assert!(finishing.on_state(&moving(101)).is_none());
    let command = Command::torques(Version::V10, Torques([0.0; 7]));
    assert!(finishing.write(&command, true).is_ok());
    assert!(finishing.on_state(&moving(102)).is_some());
    finishing.on_order(silence());
    assert!(finishing.on_state(&moving(103)).is_none());
}

#[test]
fn what_is_written_answers_the_newest_state_and_is_logged_with_the_next() {
    let mut driver = armed_with(Program::Active(ActiveControl));
    let command = |tau| Command::torques(Version::V10, Torques([tau; 7]));
    assert_eq!(
        driver.write(&command(1.0), false),
        Err(WriteError::NotRunning)
    );
    assert!(driver.on_state(&moving(101)).is_none());
    assert_eq!(
        driver
            .write(&command(1.0), false)
            .map(|sent| sent.message_id),
        Ok(101)
    );
    assert!(driver.on_state(&moving(104)).is_none());
    assert_eq!(
        driver
            .write(&command(2.0), false)
            .map(|sent| sent.message_id),
        Ok(104)
    );
    // The last one goes out at once, and again with every state.
    assert!(driver.on_state(&moving(105)).is_none());
    let last = driver.write(&command(3.0), true).expect("it fits");
    assert!(last.torque_command_finished);
    assert_eq!(
        driver.write(&command(4.0), true),
        Err(WriteError::NotRunning)
    );
    let again = driver.on_state(&moving(106)).expect("an answer");
    assert_eq!((again.message_id, again.tau_J_d), (106, [3.0; 7]));
    assert!(again.torque_command_finished);
    assert!(driver.on_state(&resting(107)).is_none());
    let ended = core::iter::from_fn(|| driver.take_event()).last();
    let Some(Event::Ended(ended)) = ended else {
        panic!("{ended:?}")
    };
    assert_eq!(ended.ending, Ending::Finished);
    let logged: Vec<_> = ended
        .log
        .iter()
        .map(|entry| {
            (
                entry.state.message_id,
                entry.command.message_id,
                entry.command.tau_J_d[0],
            )
        })
        .collect();
    assert_eq!(
        logged,
        [
            (101, 0, 0.0),
            (104, 101, 1.0),
            (105, 104, 2.0),
            (106, 105, 3.0),
            (107, 106, 3.0)
        ]
    );
}

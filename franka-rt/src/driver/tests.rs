//! Tests of the driver with artificial states and programs.

use std::sync::Arc;

use franka_model::{Model, READY};
use franka_proto::{ControllerMode, MotionGeneratorMode, RobotMode, RobotState, Version};
use nalgebra::Isometry3;

use super::*;
use crate::control::{
    ActiveControl, AsynchronousPositions, AsynchronousTarget, Callback, Modes, Shaper, Torques,
};
use crate::law::Gains;
use crate::session::{Backend, Goal, GoalId, OnArrival, Target, TargetSession};
use crate::shaping::InvalidCommand;
use crate::stats::{Arrival, CycleTimes};
use crate::triple_buffer::triple_buffer;

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

fn session(target: Target, backend: Backend) -> Program {
    let (mut goals, reader) = triple_buffer();
    let limits = Model::fr3().joint_limits();
    goals.write(Goal {
        gains: Gains::joint(),
        ..Goal::new(GoalId(1), target, OnArrival::ReportAndFinish, limits)
    });
    let session = TargetSession::new(Model::fr3().clone().into(), Version::V10, reader);
    Program::Target(Box::new(session.with_backend(backend)))
}

/// Returns a joint target, a tenth of a radian from the ready posture.
fn nearby() -> Target {
    let mut target: [f64; 7] = READY.into();
    target[0] += 0.1;
    Target::Joints(target)
}

/// Runs a cycle whose phases take no time.
fn answer(driver: &mut Driver, state: &RobotState) -> Option<RobotCommand> {
    let command = driver.on_state(state);
    let sent = command.map(|_| times(state.message_id, 0, 0));
    driver.after_send(state, &Arrival::default(), sent.as_ref());
    driver.prepare();
    if let Some(sent) = sent {
        driver.note_cycle(&sent);
    }
    command
}

fn times(time: u64, late: u64, turnaround: u64) -> CycleTimes {
    let us = Duration::from_micros;
    CycleTimes::new(time, us(late), us(turnaround))
}

#[test]
fn a_state_that_is_not_finite_gets_no_answer_and_does_no_harm() {
    for spoil in [
        |state: &mut RobotState| state.q[3] = f64::NAN,
        |state: &mut RobotState| state.dq[0] = f64::INFINITY,
        |state: &mut RobotState| state.tau_J_d[6] = f64::NAN,
    ] {
        let mut driver = armed_with(session(nearby(), Backend::Torques));
        let mut time = 100;
        for step in 0..60 {
            time += 1;
            let mut state = moving(time);
            let bad = step < 2 || step % 7 == 0;
            if bad {
                spoil(&mut state);
            }
            let command = answer(&mut driver, &state);
            assert_eq!(command.is_none(), bad, "cycle {step}");
            if let Some(command) = command {
                assert!(command.tau_J_d.iter().all(|tau| tau.is_finite()));
            }
        }
        let mut state = moving(time + 1);
        state.q[3] = f64::NAN;
        state.robot_mode = RobotMode::Reflex;
        assert!(answer(&mut driver, &state).is_none());
        assert!(driver.is_watching(), "a reflex is seen all the same");
    }
}

#[test]
fn a_setpoint_that_is_not_finite_gets_no_answer_either() {
    let pose = Isometry3::translation(0.3, 0.0, 0.5);
    let rigid: [f64; 16] = core::array::from_fn(|i| pose.to_homogeneous().as_slice()[i]);
    for backend in Backend::ROBOT_CONTROLLERS {
        let is_cartesian = backend.is_cartesian();
        let target = if is_cartesian { Target::Rest } else { nearby() };
        for (spoil, read) in [
            (
                (|state| state.q_d[3] = f64::NAN) as fn(&mut RobotState),
                true,
            ),
            (|state| state.dq_d[0] = f64::INFINITY, true),
            (|state| state.ddq_d[6] = f64::NAN, true),
            (|state| state.O_T_EE_c[12] = f64::NAN, is_cartesian),
            (|state| state.elbow_c[0] = f64::NAN, is_cartesian),
        ] {
            let mut driver = armed_with(session(target, backend));
            for step in 0..60 {
                let mut state = RobotState {
                    q_d: READY.into(),
                    O_T_EE_c: rigid,
                    elbow_c: [READY[2], -1.0],
                    ..moving(101 + step)
                };
                let bad = step < 2 || step % 7 == 0;
                if bad {
                    spoil(&mut state);
                }
                let command = answer(&mut driver, &state);
                assert_eq!(command.is_none(), bad && read, "{backend}, {step}");
                let sent = command.unwrap_or_default();
                let joints = sent.q_c.iter().chain(&sent.dq_c);
                let numbers = joints.chain(&sent.O_T_EE_c).chain(&sent.O_dP_EE_c);
                assert!(numbers.copied().all(f64::is_finite), "{backend}, {step}");
            }
        }
    }
}

/// The velocities are finite, but the Coriolis torques are not.
#[test]
fn session_with_non_finite_command_fails_and_sends_nothing() {
    let mut driver = armed_with(session(nearby(), Backend::Torques));
    assert!(answer(&mut driver, &moving(101)).is_some());
    let wild = RobotState {
        dq: [1e200; 7],
        ..moving(102)
    };
    assert_eq!(answer(&mut driver, &wild), None);
    assert_eq!(driver.record().activity, Activity::Silent);
    assert!(matches!(driver.take_event(), Some(Event::Started { .. })));
    assert!(matches!(
        driver.take_event(),
        Some(Event::Failed {
            failure: Failure::Invalid(InvalidCommand::NotFinite),
            ..
        })
    ));
    assert_eq!(answer(&mut driver, &moving(103)), None);
}

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
        times: Arc::default(),
        observer: None,
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
fn failed_program_sends_no_commands_until_motion_ends() {
    let mut driver = armed_with(torques(|time| if time < 103 { 1.0 } else { f64::NAN }));
    assert!(answer(&mut driver, &moving(101)).is_some());
    assert!(answer(&mut driver, &moving(102)).is_some());
    assert!(answer(&mut driver, &moving(103)).is_none());
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
        assert!(answer(&mut driver, &moving(time)).is_none());
        assert!(driver.take_event().is_none());
        assert!(!driver.is_watching());
    }
    assert!(answer(&mut driver, &resting(110)).is_none());
    let Some(Event::Ended(ended)) = driver.take_event() else {
        panic!("it has ended")
    };
    assert_eq!(ended.ending, Ending::Aborted);
    assert_eq!(ended.log.len(), 5, "it is noted to the end");
    assert!(driver.is_watching());
}

#[test]
fn non_finite_asynchronous_target_fails_the_motion() {
    let (positions, mut targets) = AsynchronousPositions::new();
    let mut driver = armed_with(Program::Asynchronous(positions));
    let mut target = AsynchronousTarget {
        q: [0.1; 7],
        finished: false,
    };
    targets.write(target);
    let sent = answer(&mut driver, &moving(101)).expect("a command");
    assert_eq!(sent.q_c, [0.1; 7]);
    target.q[4] = f64::NAN;
    targets.write(target);
    assert!(answer(&mut driver, &moving(102)).is_none());
    assert_eq!(driver.record().activity, Activity::Silent);
    let failed = core::iter::from_fn(|| driver.take_event()).last();
    let Some(Event::Failed { failure, .. }) = failed else {
        panic!("{failed:?}")
    };
    assert!(matches!(
        failure,
        Failure::Invalid(InvalidCommand::NotFinite)
    ));
    target.q[4] = 0.1;
    targets.write(target);
    assert!(answer(&mut driver, &moving(103)).is_none(), "nothing later");
}

#[test]
fn an_abandoned_program_gets_no_more_states_in_any_phase() {
    let abandon = || Order::Abandon {
        motion: MotionId(1),
    };
    let mut armed = armed_with(torques(|_| 1.0));
    armed.on_order(abandon());
    let quiet = u64::from(UNWANTED_STATES);
    for id in 101..100 + quiet {
        assert!(answer(&mut armed, &resting(id)).is_none());
    }
    assert!(answer(&mut armed, &moving(100 + quiet)).is_none());
    for id in 101 + quiet..=100 + 2 * quiet {
        assert!(!armed.is_watching(), "the robot began it all the same");
        assert!(armed.take_event().is_none());
        assert!(answer(&mut armed, &resting(id)).is_none());
    }
    assert!(armed.is_watching());
    assert!(
        matches!(armed.take_event(), Some(Event::Ended(ended)) if ended.ending == Ending::Disarmed)
    );

    let mut running = armed_with(torques(|_| 1.0));
    assert!(answer(&mut running, &moving(101)).is_some());
    running.on_order(Order::Abandon {
        motion: MotionId(2),
    });
    assert!(
        answer(&mut running, &moving(102)).is_some(),
        "another is meant"
    );
    running.on_order(abandon());
    assert!(answer(&mut running, &moving(103)).is_none());
    assert!(answer(&mut running, &resting(104)).is_none());
    assert!(running.is_watching());

    let mut finishing = armed_with(Program::Active(ActiveControl));
    assert!(answer(&mut finishing, &moving(101)).is_none());
    let command = Command::torques(Version::V10, Torques([0.0; 7]));
    assert!(finishing.write(&command, true).is_ok());
    assert!(answer(&mut finishing, &moving(102)).is_some());
    finishing.on_order(abandon());
    assert!(answer(&mut finishing, &moving(103)).is_none());
}

#[test]
fn written_command_answers_newest_state_and_is_logged_next() {
    let mut driver = armed_with(Program::Active(ActiveControl));
    let command = |tau| Command::torques(Version::V10, Torques([tau; 7]));
    assert_eq!(
        driver.write(&command(1.0), false),
        Err(WriteError::NotRunning)
    );
    assert!(answer(&mut driver, &moving(101)).is_none());
    assert_eq!(
        driver
            .write(&command(1.0), false)
            .map(|sent| sent.message_id),
        Ok(101)
    );
    assert!(answer(&mut driver, &moving(104)).is_none());
    assert_eq!(
        driver
            .write(&command(2.0), false)
            .map(|sent| sent.message_id),
        Ok(104)
    );
    // The last command is sent at once, and again with every state.
    assert!(answer(&mut driver, &moving(105)).is_none());
    let last = driver.write(&command(3.0), true).expect("it fits");
    assert!(last.torque_command_finished);
    assert_eq!(
        driver.write(&command(4.0), true),
        Err(WriteError::NotRunning)
    );
    let again = answer(&mut driver, &moving(106)).expect("an answer");
    assert_eq!((again.message_id, again.tau_J_d), (106, [3.0; 7]));
    assert!(again.torque_command_finished);
    assert!(answer(&mut driver, &resting(107)).is_none());
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

fn ended(driver: &mut Driver) -> Ended {
    let last = core::iter::from_fn(|| driver.take_event()).last();
    match last {
        Some(Event::Ended(ended)) => ended,
        other => panic!("{other:?}"),
    }
}

#[test]
fn motion_counts_lost_and_skipped_states_until_its_end() {
    let mut driver = armed_with(torques(|_| 1.0));
    let state = |time, rate| RobotState {
        control_command_success_rate: rate,
        ..moving(time)
    };
    driver.on_skipped(3); // Skipped before the motion runs, so not counted.
    assert!(answer(&mut driver, &state(101, 0.0)).is_some());
    assert!(answer(&mut driver, &state(102, 1.0)).is_some());
    driver.on_skipped(2);
    assert!(answer(&mut driver, &state(108, 0.75)).is_some());
    assert_eq!(driver.record().skipped, 5);
    driver.on_skipped(9); // More than the gap: the robot counts wrongly.
    assert!(answer(&mut driver, &state(110, 0.5)).is_some());
    let running = *driver.statistics().expect("it runs");
    assert_eq!((running.lost_states, running.skipped_states), (3, 3));
    assert_eq!(running.success_rate_newest, 0.5);
    driver.on_skipped(1);
    assert!(answer(&mut driver, &resting(113)).is_none());
    assert!(driver.statistics().is_none());
    let ended = ended(&mut driver);
    let statistics = ended.statistics;
    assert_eq!((statistics.cycles, statistics.commands), (5, 4));
    assert_eq!((statistics.lost_states, statistics.skipped_states), (4, 4));
    assert_eq!(statistics.success_rate_avg(), 0.75);
    assert_eq!(statistics.duration_ms(), 12);
    assert_eq!(ended.times.turnaround.count(), 4);
}

#[test]
fn the_record_of_a_cycle_has_its_times_and_the_motion_its_worst() {
    let mut driver = armed_with(torques(|_| 1.0));
    let mut cycle = |time, late, turnaround| {
        let state = moving(time);
        assert!(driver.on_state(&state).is_some());
        let sent = times(time, late, turnaround);
        let arrival = Arrival {
            interval: Some(Duration::from_micros(1000 + late)),
            late: sent.late,
        };
        driver.after_send(&state, &arrival, Some(&sent));
        driver.note_cycle(&sent);
        *driver.record()
    };
    let calm = cycle(101, 3, 40);
    assert_eq!(
        (calm.late, calm.turnaround),
        (Duration::from_micros(3), Duration::from_micros(40))
    );
    assert_eq!(calm.slack, Some(times(101, 3, 40).slack));
    assert!(cycle(102, 900, 110).slack < calm.slack);
    cycle(103, 5, 300);
    let statistics = driver.statistics().expect("it runs");
    assert_eq!(statistics.worst_cycle(), Some(times(102, 900, 110)));
    assert_eq!(statistics.slack_min(), Some(times(102, 900, 110).slack));
    assert_eq!(statistics.worst_turnaround, Duration::from_micros(300));
    assert_eq!(statistics.overruns, 1);
    assert!(answer(&mut driver, &resting(104)).is_none());
    let ended = ended(&mut driver);
    assert_eq!(
        ended.times.interval.max(),
        Some(Duration::from_micros(1900))
    );
    assert_eq!(ended.times.interval.count(), 3);
    assert_eq!(driver.record().slack, None);
}

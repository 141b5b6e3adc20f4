//! The start of a motion, the next one, and two at once.

use franka_model::READY;
use franka_proto::{MoveControllerMode, MoveGeneratorMode, MoveRequest, MoveStatus, Version};
use franka_rt::control::{ActiveControl, Callback, Finish, JointVelocities};
use franka_rt::driver::{Activity, Program};
use franka_rt::lifecycle::{MotionError, NewMotion};
use franka_rt::session::{Goal, OnArrival, Target};

use crate::for_each_version;
use crate::pair::{self, Pair};

const BUSY: &str = "libfranka robot: Cannot perform this operation while another control or read \
                    operation is running.";

/// Every kind of motion of a version.
fn requests(version: Version) -> impl Iterator<Item = MoveRequest> {
    let controllers = [
        MoveControllerMode::JointImpedance,
        MoveControllerMode::CartesianImpedance,
        MoveControllerMode::ExternalController,
    ];
    let generators = [
        MoveGeneratorMode::JointPosition,
        MoveGeneratorMode::JointVelocity,
        MoveGeneratorMode::CartesianPosition,
        MoveGeneratorMode::CartesianVelocity,
        MoveGeneratorMode::None,
    ];
    let generators = generators.into_iter().filter(move |&generator| {
        generator != MoveGeneratorMode::None || version.torque_generator() == generator
    });
    generators.flat_map(move |generator| {
        let with = move |controller| MoveRequest::new(controller, generator);
        controllers.into_iter().map(with)
    })
}

fn active() -> Program {
    Program::Active(ActiveControl)
}

/// A motion at rest, for this many cycles.
fn standing(version: Version, cycles: u32) -> (Program, MoveRequest) {
    let mut cycle = 0;
    let callback = Callback::motion::<JointVelocities, _>(version, move |_, _| {
        cycle += 1;
        let still = JointVelocities([0.0; 7]);
        if cycle < cycles {
            still.into()
        } else {
            still.finish()
        }
    });
    let request = callback.request(version, MoveControllerMode::JointImpedance);
    (Program::Callback(Box::new(callback)), request)
}

/// A motion under target control.
fn to_ready(pair: &mut Pair) -> Goal {
    let limits = pair::model(pair.client.version()).joint_limits();
    let target = Target::Joints(READY.into());
    Goal::new(
        pair.client.next_goal(),
        target,
        OnArrival::ReportAndFinish,
        limits,
    )
}

/// A second start is refused before anything is sent, with the same error as during a motion of
/// another caller. libfranka 0.21 has the text `Attempted to start multiple motions!` for callers
/// that bypass its lock; here that is not possible.
#[test]
fn scenario_3_motion_runs_in_present_modes_and_only_once() {
    for_each_version(|version| {
        for request in requests(version) {
            let mut pair = Pair::connected(version);
            let (work, id) = pair.ask(active(), request);
            pair.robot.run(&request);
            pair.robot.send_next();
            pair.robot.reply_move(id, MoveStatus::MotionStarted);
            pair.cycle();
            assert_eq!(pair.client.record.activity, Activity::Running);
            for second in requests(version) {
                let error = pair.client.control(active(), second).unwrap_err();
                assert_eq!(error.to_string(), BUSY);
            }
            pair.settle();
            assert_eq!(pair.robot.take_request(), None);
            assert_eq!(pair.client.outcome(work), None);
        }
    });
}

/// The robot's reply may come before or after its states show the modes.
#[test]
fn scenario_3_first_state_with_the_modes_is_answered() {
    for_each_version(|version| {
        for states_first in [false, true] {
            let mut pair = Pair::connected(version);
            let (program, request) = standing(version, 5);
            let (work, id) = pair.ask(program, request);
            if !states_first {
                pair.robot.reply_move(id, MoveStatus::MotionStarted);
                pair.settle();
            }
            assert_eq!(pair.step(), None, "the modes are not shown");
            pair.robot.run(&request);
            let command = pair.step().expect("an answer at once");
            assert_eq!(command.message_id, pair.robot.state.message_id);
            if states_first {
                pair.robot.reply_move(id, MoveStatus::MotionStarted);
                pair.settle();
            }
            assert!(pair.step().is_some());
            assert_eq!(pair.client.outcome(work), None);
        }
    });
}

/// libfranka throws a `CommandException` for a refusal in the first answer and a `ControlException`
/// for one in the second. Here both are [`MotionError::Rejected`], with libfranka's text.
#[test]
fn scenario_8_a_refusal_after_the_start_was_reported() {
    for_each_version(|version| {
        for (started, status, text) in [
            (
                true,
                MoveStatus::CommandNotPossibleRejected,
                "libfranka: Move command rejected: command not possible in the current mode (\"Idle\")!",
            ),
            (
                true,
                MoveStatus::StartAtSingularPoseRejected,
                "libfranka: Move command rejected: cannot start at singular pose!",
            ),
            (
                false,
                MoveStatus::CommandNotPossibleRejected,
                "libfranka: Move command rejected: command not possible in the current mode (\"Idle\")!",
            ),
        ] {
            let mut pair = Pair::connected(version);
            let (program, request) = standing(version, 5);
            let (work, id) = pair.ask(program, request);
            if started {
                pair.robot.reply_move(id, MoveStatus::MotionStarted);
                pair.settle();
                assert_eq!(pair.step(), None);
                assert_eq!(pair.client.outcome(work), None);
            }
            pair.robot.reply_move(id, status);
            assert_eq!(pair.step(), None);
            let error = pair.error(work);
            assert!(matches!(error, MotionError::Rejected(_)), "{error:?}");
            assert_eq!(error.to_string(), text);
            pair.assert_idle();
        }
    });
}

#[test]
fn scenario_13_motion_starts_after_one_ended_by_a_reflex() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let (program, request) = standing(version, 100);
        let motion = pair.begin(program, request);
        pair.robot.rest();
        pair.robot.reply_move(motion.id, MoveStatus::ReflexAborted);
        assert_eq!(pair.step(), None);
        assert!(pair.control_error(motion.work).is_reflex());
        pair.assert_idle();

        let (program, request) = standing(version, 2);
        let motion = pair.begin(program, request);
        assert!(pair.step().expect("an answer").motion_generation_finished);
        pair.succeed(&motion);
    });
}

#[test]
fn scenario_13_three_motions_in_a_row() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let mut ids = Vec::new();
        for cycles in [1, 2, 3] {
            let (program, request) = standing(version, cycles);
            let motion = pair.begin(program, request);
            let mut last = motion.first.expect("an answer");
            for _ in 1..cycles {
                assert!(!last.motion_generation_finished);
                last = pair.step().expect("an answer");
            }
            assert!(last.motion_generation_finished);
            pair.succeed(&motion);
            ids.push(motion.id);
        }
        ids.dedup();
        assert_eq!(ids.len(), 3);
    });
}

/// Callers on all threads share the state machine under test. States can be read at any time, in
/// both versions: reading one takes no lock.
#[test]
fn scenario_16_the_second_caller_is_refused_while_a_motion_runs() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        let (program, request) = standing(version, 100);
        let motion = pair.begin(program, request);
        let (second, other) = standing(version, 100);
        let error = pair.client.control(second, other).unwrap_err();
        assert_eq!(error, MotionError::Busy);
        assert_eq!(error.to_string(), BUSY);
        let goal = to_ready(&mut pair);
        let error = pair.client.begin(NewMotion::to(goal)).unwrap_err();
        assert_eq!(error, MotionError::Busy);
        pair.settle();
        assert_eq!(pair.robot.take_request(), None);

        // The first motion continues, and its states can be read.
        assert!(pair.step().is_some());
        let newest = pair.robot.state.message_id;
        assert_eq!(pair.client.state.message_id, newest);
        assert_eq!(pair.client.outcome(motion.work), None);
    });
}

/// A newer goal supersedes a goal; a control function does not.
#[test]
fn scenario_16_a_control_function_does_not_supersede_a_goal() {
    for_each_version(|version| {
        let mut pair = Pair::connected(version);
        pair.robot.state.q = READY.into();
        pair.robot.state.O_T_EE = core::array::from_fn(|i| if i % 5 == 0 { 1.0 } else { 0.0 });
        pair.robot.state.F_T_EE = pair.robot.state.O_T_EE;
        pair.step();
        let goal = to_ready(&mut pair);
        assert_eq!(pair.client.begin(NewMotion::to(goal)), Ok(goal.id));
        let (program, request) = standing(version, 100);
        let error = pair.client.control(program, request).unwrap_err();
        assert_eq!(error, MotionError::Busy);
    });
}

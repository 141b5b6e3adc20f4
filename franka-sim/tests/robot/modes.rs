use franka_model::{Frame, JointVector, READY};
use franka_proto::{
    Errors, MoveControllerMode, MoveGeneratorMode, MoveStatus, RecoveryStatus, Request,
    RobotCommand, RobotError as E, RobotMode, SetterStatus, Status,
};
use franka_sim::{Config, Tool, Touch};
use nalgebra::Vector3;

use crate::pair::{Pair, positions, ramp, torques};

const NOT_POSSIBLE: Status = Status::Move(MoveStatus::CommandNotPossibleRejected);

fn push(joint: usize, torque: f64) -> Touch {
    let mut torques = JointVector::zeros();
    torques[joint] = torque;
    Touch::torque(torques)
}

/// Causes an error from which a test can recover.
fn fail(pair: &mut Pair) {
    pair.start_joints();
    let mut q = READY;
    q[0] += 0.2;
    pair.tick(Some(positions(&q)));
    assert_eq!(pair.state.robot_mode, RobotMode::Reflex);
}

#[test]
fn the_mode_is_automatic_error_recovery_until_the_reply() {
    let mut pair = Pair::fr3();
    fail(&mut pair);
    assert_eq!(pair.ask_to_move(), NOT_POSSIBLE);
    let id = pair.request(&Request::AutomaticErrorRecovery);
    pair.tick(None);
    while pair.statuses(id).is_empty() {
        assert_eq!(pair.state.robot_mode, RobotMode::AutomaticErrorRecovery);
        assert!(!pair.state.errors.is_empty());
        assert_eq!(pair.ask_to_move(), NOT_POSSIBLE);
        pair.tick(None);
    }
    assert_eq!(
        pair.statuses(id),
        [Status::Recovery(RecoveryStatus::Success)]
    );
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
    assert!(pair.state.errors.is_empty());
    assert!(!pair.state.reflex_reason.is_empty(), "which is history");
}

#[test]
fn the_reply_to_a_recovery_comes_when_the_arm_is_at_rest() {
    let mut pair = Pair::fr3();
    pair.start(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::JointVelocity,
    );
    for cycle in 0..400 {
        let mut command = RobotCommand::default();
        command.dq_c[0] = 1.8 * ramp(f64::from(cycle) * 1e-3, 0.35);
        pair.tick(Some(command));
    }
    assert!(pair.state.dq[0] > 1.7);
    // The command of the next cycle ends the motion.
    pair.robot.trip(E::PowerLimitViolation);
    assert!(pair.recover() > 150, "it takes longer to stop");
    assert!(pair.robot.dq().amax() < 0.01, "{}", pair.robot.dq());
    pair.tick(None);
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
}

#[test]
fn an_arm_outside_its_limits_takes_a_manual_recovery() {
    let manual = Status::Recovery(RecoveryStatus::ManualErrorRecoveryRequiredRejected);
    let outside = || {
        let mut pair = Pair::fr3();
        let mut q = READY;
        q[0] = 2.93;
        pair.robot.place(&q);
        pair.robot.trip(E::JointPositionLimitsViolation);
        assert_eq!(pair.ask(&Request::AutomaticErrorRecovery), manual);
        pair
    };
    // First case: recovery in Desk.
    let mut pair = outside();
    pair.robot.recover_manually();
    let mut fastest = 0.0_f64;
    for _ in 0..2000 {
        pair.tick(None);
        fastest = fastest.max(pair.state.dq[0].abs());
    }
    assert!(fastest > 0.02 && fastest < 0.25, "{fastest}");
    assert!(pair.q()[0] < 2.9007, "{}", pair.q()[0]);
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
    pair.start_joints();

    // Second case: a person guides the arm back, and then the client recovers the robot.
    let mut pair = outside();
    assert!(pair.robot.guide(true));
    let hand = pair.robot.touch(push(0, -3.0));
    while pair.robot.q()[0] > 2.85 {
        pair.tick(None);
        assert_eq!(pair.state.robot_mode, RobotMode::Guiding);
    }
    pair.robot.release(hand);
    pair.robot.guide(false);
    pair.tick(None);
    assert_eq!(pair.state.robot_mode, RobotMode::Reflex, "errors stay");
    pair.idle(300);
    pair.recover();
}

#[test]
fn user_stop_ends_motion_and_recovery_and_allows_none() {
    let mut pair = Pair::fr3();
    let id = pair.start_torques();
    pair.tick(Some(RobotCommand::default()));
    pair.robot.press_user_stop(true);
    pair.tick(Some(RobotCommand::default()));
    assert_eq!(pair.state.robot_mode, RobotMode::UserStopped);
    assert_eq!(pair.outcome(id), MoveStatus::EmergencyAborted);
    assert_eq!(pair.ask_to_move(), NOT_POSSIBLE);
    let not_now = Status::Recovery(RecoveryStatus::CommandNotPossibleRejected);
    assert_eq!(pair.ask(&Request::AutomaticErrorRecovery), not_now);
    pair.robot.press_user_stop(false);
    pair.tick(None);
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);

    fail(&mut pair);
    let id = pair.request(&Request::AutomaticErrorRecovery);
    pair.idle(10);
    pair.robot.press_user_stop(true);
    pair.tick(None);
    let stopped = Status::Recovery(RecoveryStatus::EmergencyAborted);
    assert_eq!(pair.statuses(id), [stopped]);
    pair.robot.press_user_stop(false);
    pair.tick(None);
    assert_eq!(pair.state.robot_mode, RobotMode::Reflex);
}

#[test]
fn a_guided_arm_carries_itself_and_goes_where_it_is_pushed() {
    let mut pair = Pair::fr3();
    assert!(pair.robot.guide(true));
    pair.idle(500);
    assert_eq!(pair.state.robot_mode, RobotMode::Guiding);
    assert!((pair.q() - READY).amax() < 1e-3, "it sinks");
    assert_eq!(pair.ask_to_move(), NOT_POSSIBLE);
    let sideways = Vector3::new(0.0, 8.0, 0.0);
    pair.robot.touch(Touch::force(sideways).lasting(500));
    let before = pair.position();
    pair.idle(500);
    let moved = pair.position()[1] - before[1];
    assert!(moved > 0.03, "{moved}");
    pair.idle(1000);
    pair.robot.guide(false);
    pair.idle(100);
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
    assert!(pair.robot.dq().amax() < 1e-2);
    let stays = pair.position();
    pair.idle(500);
    assert!((pair.position()[1] - stays[1]).abs() < 1e-3);
    pair.start_joints();
}

#[test]
fn guiding_moves_only_what_set_guiding_mode_has_unlocked() {
    let pushed = |guiding_mode: [bool; 6]| {
        let mut pair = Pair::new(with_hand(READY));
        let status = pair.ask(&Request::SetGuidingMode {
            guiding_mode,
            nullspace: false,
        });
        assert_eq!(status, Status::Setter(SetterStatus::Success));
        assert!(pair.robot.guide(true));
        let before = Vector3::from(pair.position());
        let diagonal = Vector3::new(6.0, 6.0, 0.0);
        pair.robot.touch(Touch::force(diagonal));
        pair.idle(500);
        Vector3::from(pair.position()) - before
    };
    // The hand's x axis points forwards, and its y axis points to the right.
    let x_only = pushed([true, false, false, false, false, false]);
    assert!(x_only.x > 0.02 && x_only.y.abs() < 0.005, "{x_only}");
    let y_only = pushed([false, true, false, false, false, false]);
    assert!(y_only.y > 0.02 && y_only.x.abs() < 0.005, "{y_only}");
    let none = pushed([false; 6]);
    assert!(none.norm() < 0.005, "{none}");
}

#[test]
fn a_joint_that_is_guided_out_of_its_range_is_stopped() {
    let mut pair = Pair::fr3();
    let mut q = READY;
    q[0] = 2.895;
    pair.robot.place(&q);
    assert!(pair.robot.guide(true));
    pair.robot.touch(push(0, 4.0).lasting(3000));
    for _ in 0..3000 {
        pair.tick(None);
        if pair.state.robot_mode != RobotMode::Guiding {
            break;
        }
    }
    assert_eq!(pair.state.errors, E::JointMoveInWrongDirection.into());
    assert_eq!(pair.state.robot_mode, RobotMode::Reflex);
    pair.robot.let_go();
    pair.idle(500);
    assert!(pair.q()[0] < 2.945, "{}", pair.q()[0]);
}

#[test]
fn closed_brakes_are_the_mode_other_and_hold_whatever_pushes() {
    let mut pair = Pair::fr3();
    let id = pair.start_torques();
    pair.tick(Some(RobotCommand::default()));
    pair.robot.close_brakes();
    pair.tick(None);
    assert_eq!(pair.state.robot_mode, RobotMode::Other);
    assert_eq!(pair.outcome(id), MoveStatus::Aborted);
    assert_eq!(pair.ask_to_move(), NOT_POSSIBLE);
    assert!(!pair.robot.guide(true));
    pair.idle(300);
    pair.robot
        .touch(Touch::force(Vector3::new(0.0, 0.0, -150.0)).lasting(500));
    pair.idle(500);
    assert!((pair.q() - READY).amax() < 0.01, "{}", pair.q() - READY);
    pair.robot.open_brakes();
    pair.idle(500);
    assert_eq!(pair.state.robot_mode, RobotMode::Idle);
    pair.start_joints();
}

#[test]
fn safety_function_has_own_statuses_on_protocol_10_only() {
    for (mut pair, preempted, rejected, setter, recovery) in [
        (
            Pair::fr3(),
            MoveStatus::PreemptedDueToActivatedSafetyFunctions,
            MoveStatus::CommandRejectedDueToActivatedSafetyFunctions,
            SetterStatus::CommandRejectedDueToActivatedSafetyFunctions,
            RecoveryStatus::CommandRejectedDueToActivatedSafetyFunctions,
        ),
        (
            Pair::fer(),
            MoveStatus::EmergencyAborted,
            MoveStatus::CommandNotPossibleRejected,
            SetterStatus::CommandNotPossibleRejected,
            RecoveryStatus::CommandNotPossibleRejected,
        ),
    ] {
        let id = pair.start_torques();
        pair.tick(Some(RobotCommand::default()));
        pair.robot.activate_safety_function(true);
        pair.tick(None);
        assert_eq!(pair.outcome(id), preempted);
        assert_eq!(pair.state.robot_mode, RobotMode::UserStopped);
        assert_eq!(pair.ask_to_move(), Status::Move(rejected));
        let stiffness = Request::SetJointImpedance([1000.0; 7]);
        assert_eq!(pair.ask(&stiffness), Status::Setter(setter));
        let recover = Request::AutomaticErrorRecovery;
        assert_eq!(pair.ask(&recover), Status::Recovery(recovery));
        pair.robot.activate_safety_function(false);
        pair.idle(200);
        assert_eq!(pair.ask_to_move(), Status::Move(MoveStatus::MotionStarted));
    }
}

#[test]
fn too_much_power_is_an_error() {
    let mut config = Config::default();
    config.unpublished.power = 20.0;
    let mut pair = Pair::new(config);
    let id = pair.start_joints();
    let mut errors = Errors::NONE;
    for cycle in 0..800 {
        let mut q = READY;
        // This motion is upwards, against gravity.
        q[3] += 0.5 * ramp(f64::from(cycle) * 1e-3, 0.7);
        pair.tick(Some(positions(&q)));
        errors = errors.union(pair.state.errors);
    }
    assert_eq!(errors, E::PowerLimitViolation.into());
    assert_eq!(pair.outcome(id), MoveStatus::ReflexAborted);
}

#[test]
fn a_controller_that_makes_a_joint_shake_is_an_error() {
    let mut pair = Pair::fr3();
    let id = pair.start_torques();
    // The last joint, which is light, oscillates with 42 Hz, as with a damper of the wrong phase.
    let mut tau = JointVector::zeros();
    for cycle in 0..400 {
        let phase = core::f64::consts::TAU * 42.0 * f64::from(cycle) * 1e-3;
        tau[6] = 3.7 * (f64::from(cycle) / 100.0).min(1.0) * phase.sin();
        pair.tick(Some(torques(&tau)));
        if pair.state.robot_mode != RobotMode::Move {
            break;
        }
    }
    pair.assert_reflex(id, &[E::InstabilityDetected]);
}

/// Folds the forearm back towards the base with joint 4, at up to 0.4 rad/s.
fn fold(pair: &mut Pair, by: f64, cycles: u32) {
    let start = JointVector::from(pair.state.q_d);
    for cycle in 0..cycles {
        let mut q = start;
        q[3] += by * ramp(f64::from(cycle) * 1e-3, f64::from(cycles) * 1e-3);
        pair.tick(Some(positions(&q)));
        if pair.state.robot_mode != RobotMode::Move {
            break;
        }
    }
}

fn with_hand(q: JointVector) -> Config {
    Config {
        q,
        tool: Tool::hand(),
        ..Config::default()
    }
}

/// Joint positions of a folded arm, with the hand near the base.
fn folded() -> JointVector {
    JointVector::from([0.0, -1.2, 0.0, -2.55, 0.0, 1.4, 0.785])
}

#[test]
fn the_arm_stops_before_it_hits_itself_and_may_leave() {
    let shape = franka_model::collision::Shape::vendor().with_hand();
    let distance = |pair: &Pair| shape.at(pair.robot.q()).nearest_pair().distance;
    let mut pair = Pair::new(with_hand(folded()));
    assert!(distance(&pair) > 0.05, "{}", distance(&pair));
    let id = pair.start_joints();
    fold(&mut pair, -0.45, 3000);
    pair.assert_reflex(id, &[E::SelfCollisionAvoidanceViolation]);
    pair.idle(500);
    let stopped = distance(&pair);
    assert!(stopped > 0.02 && stopped < 0.05, "{stopped}");
    pair.recover();
    pair.tick(None);

    // The arm may leave the margin, but it may not go further into it.
    let mut again = Pair::new(with_hand(*pair.robot.q()));
    let id = again.start_joints();
    fold(&mut again, -0.1, 1000);
    again.assert_reflex(id, &[E::SelfCollisionAvoidanceViolation]);
    pair.start_joints();
    fold(&mut pair, 0.3, 2000);
    assert_eq!(
        pair.state.robot_mode,
        RobotMode::Move,
        "{}",
        pair.state.errors
    );
    assert!(distance(&pair) > 0.05);
}

#[test]
fn a_push_on_any_link_moves_the_arm_and_a_grip_holds_it() {
    let mut pair = Pair::fr3();
    assert!(pair.robot.guide(true));
    let grip = pair.robot.touch(Touch::hold());
    pair.robot
        .touch(Touch::force(Vector3::new(0.0, 10.0, 0.0)).at(Frame::Joint4));
    let before = Vector3::from(pair.position());
    pair.idle(800);
    let held = Vector3::from(pair.position()) - before;
    assert!(held.norm() < 5e-3, "{held}");
    // The elbow still yields to the push.
    assert!((pair.q() - READY).amax() > 0.05, "{}", pair.q() - READY);
    pair.robot.release(grip);
    assert!(!pair.robot.release(grip));
    pair.idle(500);
    let moved = Vector3::from(pair.position()) - before;
    assert!(moved.norm() > 0.01, "{moved}");
}

//! Unpublished behaviour of the robot: for each question, the documented default and another
//! choice.

use franka_model::{JointVector, READY, RobotKind, Twist};
use franka_proto::{
    CollisionBehavior, Filters, MoveControllerMode, MoveGeneratorMode, MoveStatus, Request,
    RobotCommand, RobotError as E, RobotMode, SetterStatus, Status, Version,
};
use franka_sim::config::{ErrorBits, Extrapolation, FirstCycles, ForceAxes, Setters};
use franka_sim::end_effector::STATE_PERIOD;
use franka_sim::{Config, Touch, Unpublished};

use crate::pair::{Pair, finished, positions, ramp, stay, torques};

fn assuming(change: impl FnOnce(&mut Unpublished)) -> Pair {
    let mut config = Config::default();
    change(&mut config.unpublished);
    Pair::new(config)
}

#[test]
fn start_pose_tolerances() {
    let first = |mut pair: Pair, offset: f64| {
        pair.start_joints();
        let mut q = READY;
        q[0] += offset;
        pair.tick(Some(positions(&q)));
        pair.state
            .errors
            .contains(E::JointPositionMotionGeneratorStartPoseInvalid)
    };
    assert!(!first(Pair::fr3(), 0.09));
    assert!(first(Pair::fr3(), 0.11));
    assert!(first(assuming(|u| u.start.joint = 0.01), 0.02));

    let first = |mut pair: Pair, shift: f64| {
        pair.start(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::CartesianPosition,
        );
        let mut command = stay(&pair.state);
        command.O_T_EE_c[13] += shift;
        pair.tick(Some(command));
        pair.state
            .errors
            .contains(E::CartesianPositionMotionGeneratorStartPoseInvalid)
    };
    assert!(!first(Pair::fr3(), 0.04));
    assert!(first(Pair::fr3(), 0.06));
    assert!(!first(assuming(|u| u.start.translation = 0.1), 0.06));
}

#[test]
fn the_singularity_criterion() {
    let start = |mut pair: Pair| {
        let id = pair.request(&Request::Move(franka_proto::MoveRequest::new(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::CartesianVelocity,
        )));
        pair.tick(None);
        pair.statuses(id)
            .contains(&Status::Move(MoveStatus::StartAtSingularPoseRejected))
    };
    assert!(!start(Pair::fr3()));
    assert!(start(assuming(|u| u.singular = 0.5)));
}

#[test]
fn extrapolation_of_orientation() {
    let turn = |extrapolation| {
        let mut pair = assuming(|u| u.extrapolation = extrapolation);
        pair.start(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::CartesianVelocity,
        );
        for cycle in 0..100 {
            let mut command = RobotCommand::default();
            command.O_dP_EE_c[5] = 0.2 * ramp(f64::from(cycle) * 1e-3, 0.2);
            pair.tick(Some(command));
        }
        let before = pair.state.O_dP_EE_c[5];
        pair.tick(None);
        (before, pair.state.O_dP_EE_c[5], pair.state.robot_mode)
    };
    let default = Unpublished::default().extrapolation;
    assert_eq!(default, Extrapolation::BaseAxes);
    let (before, after, _) = turn(default);
    assert!(after > before);
    // For a rotation about a constant axis, both extrapolations are equal.
    assert_eq!(turn(Extrapolation::BodyAxes).1, after);
    let (_, _, mode) = turn(Extrapolation::Held);
    assert_eq!(mode, RobotMode::Reflex, "which costs a step in velocity");
}

#[test]
fn filters_of_the_robots_own() {
    // The velocity rises to 0.1 rad/s within a tenth of a second.
    let drive = |mut pair: Pair| {
        pair.start(
            MoveControllerMode::JointImpedance,
            MoveGeneratorMode::JointVelocity,
        );
        let mut command = RobotCommand::default();
        for cycle in 0..60 {
            command.dq_c[0] = 0.1 * ramp(f64::from(cycle) * 1e-3, 0.1);
            pair.tick(Some(command));
        }
        command.dq_c[0] - pair.state.dq_d[0]
    };
    assert!(drive(Pair::fr3()).abs() < 1e-7);
    let lag = drive(assuming(|u| u.command_filter = Some(20.0)));
    assert!(lag > 1e-3, "{lag}");
    let mut fer = Pair::fer();
    assert_eq!(
        fer.ask(&Request::SetFilters(Filters::uniform(20.0))),
        Status::Setter(SetterStatus::Success)
    );
    let set = drive(fer);
    assert!((set - lag).abs() < 1e-5, "{set} {lag}");
}

#[test]
fn the_success_rates_denominator_before_100_cycles() {
    let rate = |first_cycles| {
        let mut pair = assuming(|u| u.first_cycles = first_cycles);
        pair.start_joints();
        for _ in 0..10 {
            pair.tick(Some(positions(&READY)));
        }
        pair.state.control_command_success_rate
    };
    assert_eq!(rate(Unpublished::default().first_cycles), 1.0);
    assert_eq!(rate(FirstCycles::SoFar), 1.0);
    assert!((rate(FirstCycles::Window) - 0.1).abs() < 1e-6);
}

#[test]
fn reflex_reason_is_cleared_at_move_as_configured() {
    for (mut pair, cleared) in [
        (Pair::fr3(), true),
        (assuming(|u| u.move_clears_reason = false), false),
    ] {
        pair.robot.trip(E::JointReflex);
        pair.recover();
        pair.tick(None);
        assert!(pair.state.reflex_reason.contains(E::JointReflex));
        pair.start_joints();
        assert_eq!(pair.state.reflex_reason.is_empty(), cleared);
    }
}

#[test]
fn the_set_of_bits_per_violation() {
    let jump = |error_bits| {
        let mut pair = assuming(|u| u.error_bits = error_bits);
        pair.start_joints();
        pair.tick(Some(positions(&READY)));
        let mut q = READY;
        q[1] += 0.05;
        pair.tick(Some(positions(&q)));
        pair.state.errors
    };
    assert_eq!(jump(Unpublished::default().error_bits).len(), 3);
    assert_eq!(
        jump(ErrorBits::First),
        E::JointMotionGeneratorVelocityLimitsViolation.into()
    );
}

#[test]
fn the_hands_state_rate() {
    use franka_proto::gripper;
    use franka_sim::{Fingers, Hand};
    let count = |mut hand: Hand| {
        assert!(hand.connect());
        let mut client = gripper::Client::new(gripper::Version::V3);
        let hello = client.connect(4711);
        hand.receive(hello.as_bytes()).expect("a handshake");
        (0..1000).filter(|_| hand.tick().is_some()).count()
    };
    assert_eq!(
        count(Hand::new(Fingers::new())),
        1000 / STATE_PERIOD as usize
    );
    assert_eq!(count(Hand::new(Fingers::new()).with_state_period(5)), 200);
}

#[test]
fn setters_in_reflex_guiding_and_user_stopped() {
    let request = Request::SetJointImpedance([1000.0; 7]);
    let ask = |setters: Option<Setters>| {
        let mut pair = assuming(|u| u.setters = setters.unwrap_or(u.setters));
        pair.robot.trip(E::JointReflex);
        let reflex = pair.ask(&request);
        pair.recover();
        pair.robot.guide(true);
        let guiding = pair.ask(&request);
        pair.robot.guide(false);
        pair.idle(100);
        pair.robot.press_user_stop(true);
        let stopped = pair.ask(&request);
        pair.robot.press_user_stop(false);
        pair.robot.close_brakes();
        [reflex, guiding, stopped, pair.ask(&request)]
    };
    assert_eq!(ask(None), [Status::Setter(SetterStatus::Success); 4]);
    let never = Setters {
        reflex: false,
        guiding: false,
        user_stopped: false,
        other: false,
    };
    let refused = Status::Setter(SetterStatus::CommandNotPossibleRejected);
    assert_eq!(ask(Some(never)), [refused; 4]);
}

#[test]
fn the_largest_load_and_frames_that_setters_take() {
    let load = |m_load: f64| {
        Request::SetLoad(franka_proto::Load {
            m_load,
            ..franka_proto::Load::default()
        })
    };
    let success = Status::Setter(SetterStatus::Success);
    let invalid = Status::Setter(SetterStatus::InvalidArgumentRejected);
    assert_eq!(Pair::fr3().ask(&load(10.0)), success);
    assert_eq!(Pair::fr3().ask(&load(10.1)), invalid);
    let mut pair = assuming(|u| u.setter_bounds.mass = 20.0);
    assert_eq!(pair.ask(&load(10.1)), success);
}

#[test]
fn the_axes_of_force_thresholds() {
    // Only the threshold along y is low. The hand is turned by 45 degrees relative to the base.
    let mut q = READY;
    q[6] += std::f64::consts::FRAC_PI_4;
    let thresholds = CollisionBehavior::uniform(
        [100.0; 7],
        [100.0; 7],
        [100.0; 6],
        [100.0, 10.0, 100.0, 100.0, 100.0, 100.0],
    );
    let stops = |axes: Option<ForceAxes>, x: f64, y: f64| {
        let mut config = Config {
            q,
            tool: franka_sim::Tool::hand(),
            ..Config::default()
        };
        config.unpublished.thresholds = thresholds;
        config.unpublished.force_axes = axes.unwrap_or(config.unpublished.force_axes);
        let mut pair = Pair::new(config);
        pair.start_joints();
        pair.robot
            .touch(Touch::force(nalgebra::Vector3::new(x, y, 0.0)));
        for _ in 0..300 {
            pair.tick(Some(positions(&q)));
        }
        pair.state.errors.contains(E::CartesianReflex)
    };
    // 12 N along the base's y are 8.5 N along each axis of the hand.
    assert!(stops(None, 0.0, 12.0));
    assert!(!stops(Some(ForceAxes::Stiffness), 0.0, 12.0));
    // 16 N along the base's x exceed only the threshold of 10 N along the hand's y.
    assert!(!stops(None, 16.0, 0.0));
    assert!(stops(Some(ForceAxes::Stiffness), 16.0, 0.0));
}

#[test]
fn the_velocity_at_which_torques_may_finish() {
    let finish = |mut pair: Pair| {
        let id = pair.start_torques();
        let mut tau = JointVector::zeros();
        while pair.robot.dq()[6] < 0.3 {
            tau[6] = (tau[6] + 0.5).min(3.0);
            pair.tick(Some(torques(&tau)));
        }
        let mut last = finished(torques(&tau));
        // Protocol 5 has no flag for torques.
        last.torque_command_finished = pair.robot.version() == Version::V10;
        pair.tick(Some(last));
        (pair.outcome(id), pair.state.errors)
    };
    let discontinuity = E::JointMotionGeneratorVelocityDiscontinuity.into();
    assert_eq!(
        finish(Pair::fr3()),
        (MoveStatus::ReflexAborted, discontinuity)
    );
    let (status, errors) = finish(Pair::fer());
    assert_eq!((status, errors), (MoveStatus::ReflexAborted, discontinuity));
    let (status, errors) = finish(assuming(|u| u.finish_velocity = f64::INFINITY));
    assert_eq!((status, errors.is_empty()), (MoveStatus::Success, true));
}

#[test]
fn the_internal_controllers_gains_when_not_set() {
    let mut torque = JointVector::zeros();
    torque[0] = 6.0;
    let give = |mut pair: Pair| {
        pair.start_joints();
        pair.robot.touch(Touch::torque(torque));
        for _ in 0..1500 {
            pair.tick(Some(positions(&READY)));
        }
        pair.robot.q()[0]
    };
    let default = give(Pair::fr3());
    assert!((default - 6.0 / 3000.0).abs() < 1e-4, "{default}");
    let soft = give(assuming(|u| u.joint_stiffness = JointVector::repeat(600.0)));
    assert!((soft - 6.0 / 600.0).abs() < 5e-4, "{soft}");

    let give = |mut pair: Pair| {
        pair.start(
            MoveControllerMode::CartesianImpedance,
            MoveGeneratorMode::JointPosition,
        );
        let height = pair.position()[2];
        pair.robot
            .touch(Touch::force(nalgebra::Vector3::new(0.0, 0.0, -9.0)));
        for _ in 0..1500 {
            pair.tick(Some(positions(&READY)));
        }
        height - pair.position()[2]
    };
    let default = give(Pair::fr3());
    assert!((default - 9.0 / 3000.0).abs() < 3e-4, "{default}");
    let stiffness = Twist::new(300.0, 300.0, 300.0, 300.0, 300.0, 300.0);
    let soft = give(assuming(|u| u.cartesian_stiffness = stiffness));
    assert!((soft - 9.0 / 300.0).abs() < 3e-3, "{soft}");
}

#[test]
fn default_collision_thresholds() {
    let push = |mut pair: Pair, force: f64| {
        pair.start_joints();
        pair.robot
            .touch(Touch::force(nalgebra::Vector3::new(0.0, 0.0, -force)));
        for _ in 0..400 {
            pair.tick(Some(positions(&READY)));
        }
        pair.state.errors.contains(E::CartesianReflex)
    };
    assert!(!push(Pair::fr3(), 35.0));
    assert!(push(Pair::fr3(), 45.0));
    let low = CollisionBehavior::uniform([100.0; 7], [100.0; 7], [5.0; 6], [10.0; 6]);
    assert!(push(assuming(|u| u.thresholds = low), 15.0));
}

#[test]
fn the_gain_of_the_observer() {
    let after_10_ms = |mut pair: Pair| {
        pair.robot
            .touch(Touch::force(nalgebra::Vector3::new(0.0, 5.0, 0.0)));
        pair.idle(10);
        -pair.state.O_F_ext_hat_K[1]
    };
    let default = after_10_ms(Pair::fr3());
    assert!(
        (default - 5.0 * (1.0 - (-1.0_f64).exp())).abs() < 0.5,
        "{default}"
    );
    let slow = after_10_ms(assuming(|u| u.observer_gain = 10.0));
    assert!(slow < 1.0, "{slow}");
}

#[test]
fn the_margin_of_self_collision() {
    let config = |margin: f64| {
        let mut config = Config {
            kind: RobotKind::Fr3,
            q: JointVector::from([0.0, -1.2, 0.0, -2.55, 0.0, 1.4, 0.785]),
            tool: franka_sim::Tool::hand(),
            ..Config::default()
        };
        config.unpublished.self_collision.margin = margin;
        config
    };
    let shape = franka_model::collision::Shape::vendor().with_hand();
    let nearest = |margin: f64| {
        let mut pair = Pair::new(config(margin));
        pair.start_joints();
        let start = JointVector::from(pair.state.q_d);
        for cycle in 0..3000 {
            let mut q = start;
            q[3] -= 0.45 * ramp(f64::from(cycle) * 1e-3, 3.0);
            pair.tick(Some(positions(&q)));
            if pair.state.robot_mode != RobotMode::Move {
                break;
            }
        }
        assert!(
            pair.state
                .errors
                .contains(E::SelfCollisionAvoidanceViolation)
        );
        shape.at(pair.robot.q()).nearest_pair().distance
    };
    let default = nearest(Unpublished::default().self_collision.margin);
    assert!((default - 0.049).abs() < 2e-3, "{default}");
    let early = nearest(0.055);
    assert!((early - 0.054).abs() < 2e-3, "{early}");
}

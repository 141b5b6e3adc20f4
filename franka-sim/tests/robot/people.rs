//! Actions of a person next to the robot, on every plant.

use franka_model::{Frame, Load, Wrench};
use nalgebra::{Matrix3, Vector3};

use crate::pair::*;
use crate::plants::robots;
use franka_sim::arm::StateGeometry;
use franka_sim::{Arm, Touch};

fn for_each_robot(test: impl Fn(&str, &mut Pair)) {
    for (name, mut pair) in robots(&Config::default()) {
        test(&name, &mut pair);
    }
}

fn hand(pair: &Pair) -> Vector3<f64> {
    let pose = &pair.state.O_T_EE;
    Vector3::new(pose[12], pose[13], pose[14])
}

fn elbow(pair: &Pair) -> Vector3<f64> {
    let frames = Default::default();
    let pose = pair.model().pose(Frame::Joint4, &pair.q(), &frames);
    Vector3::new(pose.m14, pose.m24, pose.m34)
}

#[test]
fn swaying_push_moves_the_elbow_but_not_the_gripped_hand() {
    for_each_robot(|name, pair| {
        assert!(pair.robot.guide(true));
        let grip = pair.robot.touch(Touch::hold());
        let (elbow_before, hand_before) = (elbow(pair), hand(pair));
        let sway = |t: f64| Wrench::new(0.0, 10.0 * (6.0 * t).sin(), 0.0, 0.0, 0.0, 0.0);
        let push = Touch::over_time(sway).at(Frame::Joint4).lasting(1000);
        pair.robot.touch(push);
        let (mut least, mut most) = (0.0_f64, 0.0_f64);
        for _ in 0..1500 {
            pair.tick(None);
            let sideways = (elbow(pair) - elbow_before).y;
            (least, most) = (least.min(sideways), most.max(sideways));
            let off = (hand(pair) - hand_before).norm();
            assert!(off < 5e-3, "{name}: the hand moves by {off} m");
        }
        assert!(most - least > 0.03, "{name}: {least} m to {most} m");
        assert!(pair.robot.release(grip) && !pair.robot.release(grip));
    });
}

#[test]
fn spring_pulls_wall_stops_and_block_holds_a_joint() {
    for_each_robot(|name, pair| {
        assert!(pair.robot.guide(true));
        let start = hand(pair);
        let goal = start + Vector3::new(0.0, 0.05, 0.05);
        let spring = pair.robot.touch(Touch::spring(goal, 400.0));
        pair.idle(4000);
        let off = (hand(pair) - goal).norm();
        assert!(off < 2e-3, "{name}: {off} m off the point");
        pair.robot.release(spring);

        let ground = goal - Vector3::new(0.0, 0.0, 0.03);
        pair.robot.touch(Touch::wall(ground, Vector3::z()));
        pair.robot
            .touch(Touch::force(Vector3::new(0.0, 0.0, -10.0)));
        pair.idle(4000);
        let deep = ground.z - hand(pair).z;
        // The force is 10 N, and the wall yields by a millimetre under 20 N.
        assert!((deep - 0.5e-3).abs() < 0.2e-3, "{name}: {deep} m deep");
        pair.robot.let_go();

        pair.robot.touch(Touch::block(1));
        let before = pair.q()[0];
        pair.robot.touch(Touch::torque(axis(0) * 20.0).lasting(300));
        pair.idle(300);
        let turned = (pair.q()[0] - before).abs();
        assert!(turned < 2e-3, "{name}: joint 1 turns by {turned} rad");
    });
}

#[test]
fn user_stop_and_brakes_end_motions_and_allow_new_ones() {
    for_each_robot(|name, pair| {
        let id = pair.start_joints();
        let mut q_c = pair.q_d();
        let start = q_c;
        for cycle in 0..200 {
            q_c[0] = start[0] + 0.2 * ramp(f64::from(cycle) * 1e-3, 1.0);
            pair.tick(Some(positions(&q_c)));
        }
        pair.robot.press_user_stop(true);
        pair.tick(None);
        assert_eq!(pair.state.robot_mode, RobotMode::UserStopped, "{name}");
        assert_eq!(pair.outcome(id), MoveStatus::EmergencyAborted, "{name}");
        pair.idle(500);
        assert!(pair.robot.dq().amax() < 1e-3, "{name}");
        pair.robot.press_user_stop(false);
        pair.tick(None);
        assert_eq!(pair.state.robot_mode, RobotMode::Idle, "{name}");

        pair.robot.close_brakes();
        let before = *pair.robot.q();
        pair.robot.touch(Touch::torque(axis(3) * 50.0).lasting(500));
        pair.idle(500);
        assert_eq!(pair.state.robot_mode, RobotMode::Other, "{name}");
        let turned = (pair.robot.q() - before).amax();
        assert!(
            turned < 5e-3,
            "{name}: closed brakes give way by {turned} rad"
        );
        pair.robot.open_brakes();
        pair.idle(500);
        pair.start_joints();
        let hold = pair.q_d();
        pair.tick(Some(positions(&hold)));
        assert_eq!(pair.state.robot_mode, RobotMode::Move, "{name}");
    });
}

#[test]
fn any_error_can_be_tripped_and_recovered_from() {
    for_each_robot(|name, pair| {
        for error in RobotError::ALL {
            let id = pair.start_torques();
            pair.tick(Some(RobotCommand::default()));
            pair.robot.trip(error);
            pair.tick(Some(RobotCommand::default()));
            pair.assert_reflex(id, &[error]);
            let recovery = pair.request(&Request::AutomaticErrorRecovery);
            pair.idle(200);
            let success = Status::Recovery(franka_proto::RecoveryStatus::Success);
            assert_eq!(pair.statuses(recovery), [success], "{name}: {error}");
            assert_eq!(pair.state.robot_mode, RobotMode::Idle, "{name}: {error}");
        }
    });
}

#[test]
fn payload_change_at_rest_is_felt_until_declared() {
    for_each_robot(|name, pair| {
        let load = Load {
            mass: 0.5,
            com: Vector3::new(0.0, 0.0, 0.05),
            inertia: Matrix3::identity() * 1e-3,
        };
        let weight = load.mass * 9.81;
        let expect = |pair: &mut Pair, expected: f64| {
            pair.idle(1500);
            let felt = pair.state.O_F_ext_hat_K[2];
            assert!(
                (felt - expected).abs() < 0.1,
                "{name}: {felt} N, not {expected} N"
            );
        };
        pair.robot.attach(load);
        // The hand supports the load.
        expect(pair, weight);
        let mut inertia = [0.0; 9];
        inertia.copy_from_slice(load.inertia.as_slice());
        pair.request(&Request::SetLoad(franka_proto::Load {
            m_load: load.mass,
            F_x_Cload: load.com.into(),
            I_load: inertia,
        }));
        expect(pair, 0.0);
        pair.robot.attach(Load::NONE);
        expect(pair, -weight);
    });
}

#[test]
fn fitted_arm_keeps_posture_and_load_of_the_former_one() {
    for_each_robot(|name, pair| {
        let kind = pair.robot.config().kind;
        let load = Load {
            mass: 0.5,
            com: Vector3::new(0.0, 0.0, 0.05),
            inertia: Matrix3::identity() * 1e-3,
        };
        pair.robot.attach(load);
        pair.idle(1500);
        let felt = |pair: &Pair| pair.state.O_F_ext_hat_K[2];
        let before = felt(pair);
        let motion = pair.start_joints();
        let q = *pair.robot.q();
        pair.robot.fit(Arm::bad(kind));
        assert_eq!(*pair.robot.q(), q, "{name}");
        // The geometry of the states does not change, because clients have read it.
        let mut fitted = Arm::bad(kind);
        fitted.body.state_geometry = StateGeometry::DESCRIBED;
        assert_eq!(pair.robot.config().arm, Some(fitted), "{name}");
        pair.idle(1500);
        assert_eq!(pair.outcome(motion), MoveStatus::Preempted, "{name}");
        assert_eq!(pair.state.robot_mode, RobotMode::Idle, "{name}");
        // This is the undeclared part of a bad arm's load.
        let more = felt(pair) - before;
        assert!(more.abs() > 0.3, "{name}: {more} N");
        pair.robot.fit(Arm::ideal(kind));
        pair.idle(1500);
        let off = felt(pair) - before;
        assert!(off.abs() < 0.1, "{name}: {off} N");
    });
}

fn axis(joint: usize) -> JointVector {
    JointVector::from_fn(|i, _| if i == joint { 1.0 } else { 0.0 })
}

#[test]
fn moving_spring_leads_the_hand_and_tells_its_force() {
    for_each_robot(|name, pair| {
        assert!(pair.robot.guide(true));
        let start = hand(pair);
        let path = move |t: f64| start + Vector3::new(0.0, 0.1 * t, 0.0);
        let lead = pair.robot.touch(Touch::carry(path, 2000.0));
        pair.idle(1000);
        let off = hand(pair) - path(1.0);
        assert!(off.norm() < 3e-3, "{name}: {off}");
        let felt = pair.robot.felt(lead).expect("it has not ended");
        // This is the force at the end of the millisecond, not its mean.
        let expected = off.y * -2000.0;
        assert!(
            (felt.y - expected).abs() < 1.0,
            "{name}: {felt} of {expected}"
        );

        pair.robot.let_go();
        assert_eq!(pair.robot.felt(lead), None, "{name}");
        let push = Wrench::new(1.0, -2.0, 3.0, 0.1, 0.2, -0.1);
        let push = (pair.robot.touch(Touch::wrench(push)), push);
        pair.idle(10);
        assert_eq!(pair.robot.felt(push.0), Some(push.1), "{name}");
    });
}

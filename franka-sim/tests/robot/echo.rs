use franka_model::{Frame, JointVector, Model, READY, RobotKind, Wrench};
use franka_proto::{MoveControllerMode, MoveGeneratorMode, RobotCommand, RobotMode, RobotState};
use franka_sim::arm::{Arm, Family};
use franka_sim::{Config, Tool, Touch, Unpublished};
use nalgebra::Vector3;

use crate::pair::{Pair, positions, ramp, torques};

/// Moves the hand 6 cm upwards within a second, and calls `see` with every state and its command.
fn rise(pair: &mut Pair, elbow: bool, mut see: impl FnMut(&RobotState, &RobotCommand)) {
    pair.start(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::CartesianPosition,
    );
    let start = pair.state;
    for cycle in 0..1100 {
        let share = ramp(f64::from(cycle) * 1e-3, 1.0);
        let mut command = RobotCommand {
            O_T_EE_c: start.O_T_EE_c,
            elbow_c: elbow.then(|| [start.elbow_c[0] + 0.05 * share, start.elbow_c[1]]),
            ..RobotCommand::default()
        };
        command.O_T_EE_c[14] += 0.06 * share;
        pair.tick(Some(command));
        assert_eq!(
            pair.state.robot_mode,
            RobotMode::Move,
            "{}",
            pair.state.errors
        );
        see(&pair.state, &command);
    }
}

#[test]
fn q_d_of_cartesian_motion_is_the_ik_of_the_command() {
    let mut pair = Pair::fr3();
    let model = Model::fr3();
    rise(&mut pair, false, |state, command| {
        let pose = model.pose(
            Frame::EndEffector,
            &JointVector::from(state.q_d),
            &Default::default(),
        );
        assert!((pose[(2, 3)] - command.O_T_EE_c[14]).abs() < 1e-6);
        assert!((state.O_T_EE_c[14] - command.O_T_EE_c[14]).abs() < 1e-6);
        assert!((state.O_T_EE_d[14] - command.O_T_EE_c[14]).abs() < 1e-6);
    });
    // The measured joints lag behind the desired joints.
    assert!((JointVector::from(pair.state.q_d) - READY).amax() > 0.05);
}

#[test]
fn twists_and_accelerations_of_the_command_are_told() {
    let mut pair = Pair::fr3();
    let (mut last, mut fastest) = (pair.state, 0.0_f64);
    rise(&mut pair, true, |state, _| {
        let velocity = (state.O_T_EE_c[14] - last.O_T_EE_c[14]) * 1e3;
        assert!((state.O_dP_EE_c[2] - velocity).abs() < 3e-4);
        let acceleration = (state.O_dP_EE_c[2] - last.O_dP_EE_c[2]) * 1e3;
        assert!((state.O_ddP_EE_c[2] - acceleration).abs() < 3e-3);
        assert!((state.O_dP_EE_d[2] - state.O_dP_EE_c[2]).abs() < 1e-3);
        let elbow = (state.elbow_c[0] - last.elbow_c[0]) * 1e3;
        assert!((state.delbow_c[0] - elbow).abs() < 3e-4);
        let elbow = (state.delbow_c[0] - last.delbow_c[0]) * 1e3;
        assert!((state.ddelbow_c[0] - elbow).abs() < 3e-3);
        fastest = fastest.max(state.delbow_c[0]);
        last = *state;
    });
    assert!(fastest > 0.05, "{fastest}");
}

#[test]
fn lost_commands_leave_an_elbow_that_rests_where_it_is() {
    let mut pair = Pair::fr3();
    pair.start(
        MoveControllerMode::JointImpedance,
        MoveGeneratorMode::CartesianPosition,
    );
    let start = pair.state;
    for cycle in 0..400 {
        let mut command = RobotCommand {
            O_T_EE_c: start.O_T_EE_c,
            elbow_c: Some(start.elbow_c),
            ..RobotCommand::default()
        };
        command.O_T_EE_c[13] += 0.05 * ramp(f64::from(cycle) * 1e-3, 1.0);
        let lost = cycle >= 200 && cycle % 50 < 3;
        pair.tick((!lost).then_some(command));
        assert_eq!(
            pair.state.robot_mode,
            RobotMode::Move,
            "{}",
            pair.state.errors
        );
        let turned = (pair.state.q_d[2] - start.elbow_c[0]).abs();
        assert!(turned < 1e-6, "{cycle}: by {turned} rad");
    }
}

#[test]
fn o_t_ee_d_is_of_desired_joints_outside_cartesian_motion() {
    let mut pair = Pair::fr3();
    pair.start_joints();
    // The push moves the arm off its path.
    pair.robot
        .touch(Touch::force(Vector3::new(0.0, 0.0, -15.0)));
    for _ in 0..500 {
        pair.tick(Some(positions(&READY)));
    }
    let desired = Model::fr3().pose(Frame::EndEffector, &READY, &Default::default());
    assert!((pair.state.O_T_EE_d[14] - desired[(2, 3)]).abs() < 1e-6);
    assert!((pair.state.O_T_EE[14] - desired[(2, 3)]).abs() > 1e-4);
}

#[test]
fn the_torque_rate_is_that_of_the_measured_torque() {
    let mut pair = Pair::fr3();
    pair.start_torques();
    let mut tau = JointVector::zeros();
    let mut last = pair.state;
    for _ in 0..50 {
        tau[3] += 0.5;
        pair.tick(Some(torques(&tau)));
        let rate = (pair.state.tau_J[3] - last.tau_J[3]) * 1e3;
        assert!((pair.state.dtau_J[3] - rate).abs() < 0.02, "{rate}");
        last = pair.state;
    }
    assert!(last.dtau_J[3] > 50.0);
}

#[test]
fn motor_position_differs_by_torque_over_stiffness() {
    let mut pair = Pair::fr3();
    pair.idle(10);
    let state = &pair.state;
    for i in 0..7 {
        let wound = state.theta[i] - state.q[i];
        assert!((wound - state.tau_J[i] / 1e4).abs() < 1e-6, "{i}: {wound}");
    }
    assert!(state.theta[3] - state.q[3] > 1e-3);
    let swing = JointVector::from([8.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    pair.start_torques();
    pair.tick(Some(torques(&(swing / 10.0))));
    for k in 2..=10 {
        pair.tick(Some(torques(&(swing * f64::from(k) / 10.0))));
    }
    assert!(pair.state.dtheta[0] != 0.0 && pair.state.dtheta[0] != pair.state.dq[0]);
}

#[test]
fn gravity_and_the_end_effector_of_desk_are_told() {
    let pair = Pair::new(Config {
        tool: Tool::hand(),
        ..Config::default()
    });
    let state = &pair.state;
    assert_eq!(state.O_ddP_O, [0.0, 0.0, f64::from(-9.81_f32)]);
    assert!((state.m_ee - 0.73).abs() < 1e-6, "{}", state.m_ee);
    assert!(state.I_ee[0] > 0.0 && state.F_x_Cee[2] > 0.0);
    assert!((state.F_T_EE[14] - 0.1034).abs() < 1e-7);
    assert!((state.F_T_NE[0] - core::f64::consts::FRAC_1_SQRT_2).abs() < 1e-7);
}

#[test]
fn accelerometers_feel_gravity_and_their_own_motion() {
    let norm = |v: [f32; 3]| f64::from((v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt());
    let mut pair = Pair::fr3();
    pair.idle(10);
    for (top, bottom) in pair
        .state
        .accelerometer_top
        .iter()
        .zip(&pair.state.accelerometer_bottom)
    {
        assert!((norm(*top) - 9.81).abs() < 1e-3 && (norm(*bottom) - 9.81).abs() < 1e-3);
    }
    let mut most = 0.0_f64;
    pair.start_joints();
    for cycle in 0..600 {
        let mut q = READY;
        q[0] += 0.2 * ramp(f64::from(cycle) * 1e-3, 0.5);
        pair.tick(Some(positions(&q)));
        // Board 5 is about 0.2 m from the axis of joint 1, whose acceleration is up to 4.6 rad/s².
        most = most.max(norm(pair.state.accelerometer_top[5]));
    }
    assert!(most > 9.85, "{most}");
}

#[test]
fn contact_does_not_show_where_nothing_touches() {
    let mut pair = Pair::fr3();
    pair.start_joints();
    for cycle in 0..600 {
        let mut q = READY;
        q[0] += 0.2 * ramp(f64::from(cycle) * 1e-3, 0.5);
        pair.tick(Some(positions(&q)));
        let felt = Wrench::from(pair.state.O_F_ext_hat_K).amax();
        assert!(felt < 1.0, "{cycle}: {felt}");
    }
}

#[test]
fn fields_that_joint_setpoints_do_not_use_are_zero() {
    for kind in RobotKind::ALL {
        let unused = |state: &RobotState| {
            let pose = state.O_T_EE_c == [0.0; 16] && state.O_dP_EE_c == [0.0; 6];
            let elbow = state.elbow_c == [0.0; 2] && state.delbow_c == [0.0; 2];
            (pose && elbow, state.tau_J_d == [0.0; 7])
        };
        let mut pair = Pair::of(kind);
        assert!(!unused(&pair.state).0, "outside of motions it is a pose");
        pair.start_joints();
        // The controller holds the arm against a push.
        pair.robot
            .push_end_effector(Wrench::new(0.0, 4.0, 0.0, 0.0, 0.0, 0.0), 200);
        for _ in 0..100 {
            pair.tick(Some(positions(&READY)));
        }
        assert_eq!(unused(&pair.state), (true, true), "{kind:?}");

        let mut pair = Pair::new(Config {
            kind,
            unpublished: Unpublished {
                zero_fields: false,
                ..Unpublished::default()
            },
            ..Config::default()
        });
        pair.start_joints();
        pair.tick(Some(positions(&READY)));
        assert!(!unused(&pair.state).0, "{kind:?}");
    }
}

#[test]
fn motor_position_includes_the_offsets_of_the_session() {
    let mut arm = Arm::ideal(RobotKind::Fr3);
    arm.sensors.motor_offset = JointVector::from([-3.8e-3, 0.0, 1e-3, 2e-3, 0.0, 0.0, 2.6e-3]);
    let offset = arm.sensors.motor_offset;
    let mut pair = Pair::new(Config {
        arm: Some(arm),
        ..Config::default()
    });
    pair.idle(10);
    let state = &pair.state;
    for i in 0..7 {
        let wound = state.theta[i] - state.q[i] - offset[i];
        assert!((wound - state.tau_J[i] / 1e4).abs() < 1e-6, "{i}: {wound}");
    }
    let family = Family::realistic();
    let drawn = |kind, seed| Arm::sample(kind, seed, &family).sensors.motor_offset;
    let fr3 = drawn(RobotKind::Fr3, 1);
    assert!(fr3.min() >= -3.8e-3 && fr3.max() <= 2.6e-3 && fr3.amax() > 1e-4);
    assert_ne!(fr3, drawn(RobotKind::Fr3, 2));
    assert_eq!(drawn(RobotKind::Fer, 1), JointVector::zeros());
}

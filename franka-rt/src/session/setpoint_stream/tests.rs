//! Robots that integrate velocities to another position than the reference.

use std::sync::Arc;

use franka_model::{Model, READY};
use nalgebra::Vector3;

use super::*;
use crate::session::geometry::corrected;
use crate::session::{
    Backend, Goal, GoalId, OnArrival, SessionCommand, SessionEvent, Settlement, TargetSession,
};
use crate::together::Gate;
use crate::triple_buffer::triple_buffer;

fn resting() -> RobotState {
    let rigid = transform::array(&Isometry3::identity());
    let mut state = RobotState {
        q: READY.into(),
        q_d: READY.into(),
        F_T_EE: rigid,
        EE_T_K: rigid,
        elbow_c: elbow(&READY),
        ..RobotState::default()
    };
    let tool = crate::session::end_effector_of(&state).expect("a rigid one");
    state.O_T_EE_c = transform::array(&pose_of(Model::fr3(), &tool, &READY));
    state
}

/// Turns joint 1 by 0.3 rad with velocities. The integrated motion is too short by the share
/// `slip`, and once steps back by `step`. Returns the final distance from the target, `[rad]`, and
/// the robot's last command.
fn turned(slip: f64, step: f64) -> (f64, [f64; 7]) {
    let mut q: [f64; 7] = READY.into();
    q[0] += 0.3;
    let (mut goals, reader) = triple_buffer();
    let limits = Model::fr3().joint_limits();
    let finish = OnArrival::ReportAndFinish;
    goals.write(Goal::new(GoalId(1), q.into(), finish, limits));
    let model = Arc::new(Model::fr3().clone());
    let mut session = TargetSession::new(model, Version::V10, reader)
        .with_backend(Backend::joint_impedance(Setpoints::JointVelocities));
    let (mut state, mut settled) = (resting(), None);
    for cycle in 0..10_000 {
        state.message_id += 1;
        let mut event = None;
        let answer = session.answer(Gate::Open, &state, &mut event);
        session.prepare();
        let SessionCommand::Setpoint(MotionCommand::JointVelocities(JointVelocities(sent))) =
            answer.answer
        else {
            panic!("it sends joint velocities")
        };
        if let Some(SessionEvent::Settled { settlement, .. }) = event {
            settled = Some(settlement);
        }
        if answer.finished {
            assert!(
                matches!(settled, Some(Settlement::Arrived(_))),
                "{settled:?}"
            );
            return (
                (JointVector::from(q) - JointVector::from(state.q_d)).amax(),
                sent,
            );
        }
        let (before, dq) = (state.dq_d, sent);
        state.ddq_d = core::array::from_fn(|i| (dq[i] - before[i]) / CYCLE);
        state.dq_d = dq;
        for (q, dq) in state.q_d.iter_mut().zip(&dq) {
            *q += dq * (1.0 - slip) * CYCLE;
        }
        state.q_d[0] -= if cycle == 300 { step } else { 0.0 };
        (state.q, state.dq) = (state.q_d, dq);
    }
    panic!("it does not end: {settled:?}")
}

#[test]
fn velocities_end_at_target_despite_integration_drift() {
    for (slip, step) in [
        (0.0, 0.0),
        (1e-4, 0.0),
        (1e-2, 0.0),
        (0.0, 1e-5),
        (0.0, 1e-3),
    ] {
        let (off, last) = turned(slip, step);
        assert!(off < 3e-6, "{slip}, {step}: {off} rad beside");
        assert_eq!(last, [0.0; 7], "{slip}, {step}");
    }
}

#[test]
fn twists_make_up_for_a_small_drift_and_go_on_from_a_large_one() {
    let (model, reference) = (Model::fr3(), Reference::at_rest(READY));
    for (off, is_made_up_for) in [(1e-7, true), (2e-6, true), (1e-5, false)] {
        let mut state = resting();
        let ee = crate::session::end_effector_of(&state).expect("a rigid one");
        let mut stream = SetpointStream::new(
            Controller::JointImpedance,
            Setpoints::CartesianVelocities,
            Version::V10,
            model.joint_limits(),
        );
        assert!(
            stream.echo(model, &ee, &reference, &state).is_some(),
            "the first"
        );
        let _ = stream.command(model, &ee, &reference, false, &state);
        state.O_T_EE_c[13] -= off;
        let anew = stream.echo(model, &ee, &reference, &state).is_some();
        assert_eq!(anew, !is_made_up_for, "{off} m");
        let (command, _) = stream.command(model, &ee, &reference, false, &state);
        let MotionCommand::CartesianVelocities(twist) = command else {
            panic!("it sends twists")
        };
        let expected = match off {
            2e-6 => 10.0 * (2e-6 - 3e-7),
            _ => 0.0,
        };
        assert!((twist.O_dP_EE[1] - expected).abs() < 1e-9, "{twist:?}");
    }
}

/// After a lost command, the robot is at the place of the reference, but moves at another velocity.
#[test]
fn velocities_go_on_from_those_of_the_robot() {
    let model = Model::fr3();
    for setpoints in [Setpoints::JointVelocities, Setpoints::CartesianVelocities] {
        for (moves, is_taken_over) in [(0.0, false), (1e-6, false), (1e-3, true)] {
            let mut state = resting();
            let ee = crate::session::end_effector_of(&state).expect("a rigid one");
            let limits = model.joint_limits();
            let controller = Controller::CartesianImpedance;
            let mut stream = SetpointStream::new(controller, setpoints, Version::V10, limits);
            let reference = Reference::at_rest(READY);
            let _ = stream.echo(model, &ee, &reference, &state);
            let _ = stream.command(model, &ee, &reference, false, &state);
            (state.dq_d[2], state.O_dP_EE_c[0]) = (moves, moves);
            let anew = stream.echo(model, &ee, &reference, &state);
            assert_eq!(anew.is_some(), is_taken_over, "{setpoints}, {moves}");
            let dq = anew.map_or(0.0, |reference| reference.dq[2]);
            assert_eq!(dq, if is_taken_over { moves } else { 0.0 });
        }
    }
}

/// The robot's poses differ from the model's poses. The robot fills in the commanded fields, or
/// leaves them at zero.
#[test]
fn cartesian_setpoints_begin_and_go_on_where_the_robot_is() {
    let model = Model::fr3();
    let off = Isometry3::new(
        Vector3::new(2e-4, -1e-4, 3e-4),
        Vector3::new(0.0, 1e-3, 0.0),
    );
    for setpoints in [Setpoints::CartesianPoses, Setpoints::CartesianVelocities] {
        for is_filled in [true, false] {
            let mut state = resting();
            let mut ee = crate::session::end_effector_of(&state).expect("a rigid one");
            let hand = ee;
            let robots = off * pose_of(model, &ee, &READY);
            (state.O_T_EE, state.O_T_EE_d) = (transform::array(&robots), transform::array(&robots));
            state.elbow_d = state.elbow_c;
            (state.O_T_EE_c, state.elbow_c) = match is_filled {
                true => (state.O_T_EE_d, state.elbow_d),
                false => ([0.0; 16], [0.0; 2]),
            };
            let controller = Controller::JointImpedance;
            let limits = model.joint_limits();
            let mut stream = SetpointStream::new(controller, setpoints, Version::V10, limits);
            let mut reference = Reference::at_rest(READY);
            for cycle in 0..5 {
                let anew = stream.echo(model, &ee, &reference, &state);
                assert_eq!(anew.is_some(), cycle == 0, "{setpoints}, cycle {cycle}");
                if let Some(anew) = anew {
                    reference = anew;
                    let correction = stream.correction(model, &hand, &reference.q, &state);
                    ee = corrected(&hand, &correction.expect("of Cartesian setpoints"));
                }
                match stream.command(model, &ee, &reference, false, &state).0 {
                    MotionCommand::CartesianPose(pose) => {
                        let pose = transform::isometry_from_array(&pose.O_T_EE).expect("rigid");
                        assert!(twist(&pose, &robots).amax() < 1e-12, "cycle {cycle}");
                    }
                    MotionCommand::CartesianVelocities(velocities) => {
                        let most = Twist::from(velocities.O_dP_EE).amax();
                        assert!(most < 1e-9, "cycle {cycle}: {most}");
                    }
                    other => panic!("{other:?}"),
                }
            }
        }
    }
}

//! Tests of the order, the reference values and the refusals of the steps.

use franka_model::transform;
use nalgebra::{Isometry3, Vector3};
use proptest::prelude::*;

use super::*;
use crate::control::MotionCommand;
use crate::shaping::{FilterFault, Signal, VelocityBounds};

const OFF: f64 = MAX_CUTOFF_FREQUENCY;

/// Returns a state at rest with an elbow, in a posture that both robots can reach.
fn at_rest() -> RobotState {
    let pose = Isometry3::new(Vector3::new(0.4, 0.1, 0.5), Vector3::new(3.0, 0.2, -0.1));
    RobotState {
        q_d: [0.1, -0.7, 0.0, -2.3, 0.0, 1.6, 0.8],
        tau_J_d: [3.0; 7],
        O_T_EE_c: transform::array(&pose),
        elbow_c: [0.1, -1.0],
        ..RobotState::default()
    }
}

/// Returns the pose of the state, moved and turned a little.
fn nudged(state: &RobotState) -> CartesianPose {
    let pose = transform::isometry_from_array(&state.O_T_EE_c).expect("a pose");
    let nudge = Isometry3::new(Vector3::new(1e-3, 0.0, 0.0), Vector3::new(0.0, 0.0, 1e-3));
    CartesianPose {
        O_T_EE: transform::array(&(nudge * pose)),
        elbow: Some([0.2, -1.0]),
    }
}

#[test]
fn without_filter_and_limiter_a_valid_command_passes_as_it_is() {
    let state = at_rest();
    for version in Version::ALL {
        let shaper = Shaper::new(version, false, OFF);
        let tau = Torques([1e3; 7]);
        assert_eq!(shaper.torques(&tau, &state), Ok(tau));
        let q = JointPositions([3.0; 7]);
        assert_eq!(shaper.joint_positions(&q, &state, false), Ok(q));
        let dq = JointVelocities([-9.0; 7]);
        assert_eq!(shaper.joint_velocities(&dq, &state), Ok(dq));
        let pose = nudged(&state);
        assert_eq!(shaper.cartesian_pose(&pose, &state, false), Ok(pose));
        let twist = CartesianVelocities {
            O_dP_EE: [7.0; 6],
            elbow: Some([0.3, 1.0]),
        };
        assert_eq!(shaper.cartesian_velocities(&twist, &state), Ok(twist));
    }
}

#[test]
fn the_filter_comes_before_the_limiter() {
    let mut state = at_rest();
    state.tau_J_d = [0.0; 7];
    let shaper = Shaper::new(Version::V5, true, 100.0);
    // The filter reduces the torque to 0.386 N m, which is inside the rate. After a limiter, the
    // filter would start from 0.999999.
    let gentle = shaper.torques(&Torques([1.0; 7]), &state).expect("finite");
    assert!((gentle.0[0] - 0.385_869_545_095_037_5).abs() < 1e-15);
    let harsh = shaper.torques(&Torques([10.0; 7]), &state).expect("finite");
    assert!((harsh.0[0] - 0.999_999).abs() < 1e-15);
}

#[test]
fn first_position_or_pose_is_its_own_past_in_protocol_10() {
    let state = at_rest();
    let q = JointPositions(state.q_d.map(|q| q + 0.01));
    let pose = nudged(&state);
    let (v5, v10) = (
        Shaper::new(Version::V5, true, 100.0),
        Shaper::new(Version::V10, true, 100.0),
    );

    let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15);
    let first = v10.joint_positions(&q, &state, true).expect("finite");
    assert!(close(&first.0, &q.0));
    let first = v10.cartesian_pose(&pose, &state, true).expect("a pose");
    assert!(close(&first.O_T_EE, &pose.O_T_EE) && first.elbow == pose.elbow);

    assert_ne!(v10.joint_positions(&q, &state, false), Ok(q));
    assert_eq!(
        v5.joint_positions(&q, &state, true),
        v5.joint_positions(&q, &state, false)
    );
    assert_eq!(
        v5.cartesian_pose(&pose, &state, true),
        v5.cartesian_pose(&pose, &state, false)
    );
    // The first twist gets no such treatment: its elbow is always compared with the state.
    let twist = CartesianVelocities {
        O_dP_EE: [0.0; 6],
        elbow: pose.elbow,
    };
    let shaped = v10.cartesian_velocities(&twist, &state).expect("finite");
    let elbow = shaped.elbow.expect("an elbow was given");
    assert!(0.1 < elbow[0] && elbow[0] < 0.100_01 && elbow[1] == -1.0);
}

/// Returns the state of a robot that does not fill the commanded fields.
fn unfilled(state: &RobotState) -> RobotState {
    RobotState {
        O_T_EE_d: state.O_T_EE_c,
        elbow_d: state.elbow_c,
        O_T_EE_c: [0.0; 16],
        elbow_c: [0.0; 2],
        ..*state
    }
}

#[test]
fn cartesian_shaping_uses_desired_pose_if_none_commanded() {
    let state = at_rest();
    let zeros = unfilled(&state);
    for version in Version::ALL {
        let shaper = Shaper::new(version, true, 100.0);
        let pose = nudged(&state);
        let shaped = shaper.cartesian_pose(&pose, &state, false);
        assert!(shaped.is_ok_and(|shaped| shaped != pose), "it limits");
        assert_eq!(shaper.cartesian_pose(&pose, &zeros, false), shaped);
        let twist = CartesianVelocities {
            O_dP_EE: [0.0; 6],
            elbow: pose.elbow,
        };
        let shaped = shaper.cartesian_velocities(&twist, &state);
        assert!(shaped.is_ok_and(|shaped| shaped != twist), "it limits");
        assert_eq!(shaper.cartesian_velocities(&twist, &zeros), shaped);
        let holding = MotionCommand::from(pose).holding(&zeros);
        assert_eq!(holding, MotionCommand::from(pose).holding(&state));
    }
}

#[test]
fn fr3_envelope_holds_positions_near_the_range_end() {
    let mut state = at_rest();
    state.q_d[0] = 2.749;
    let ahead = JointPositions(core::array::from_fn(|i| {
        state.q_d[i] + [1.0, 0.0][i.min(1)]
    }));
    let moved = |shaper: &Shaper| {
        let shaped = shaper.joint_positions(&ahead, &state, false);
        shaped.expect("finite").0[0] - state.q_d[0]
    };
    let free = moved(&Shaper::new(Version::V5, true, OFF));
    let held = moved(&Shaper::new(Version::V10, true, OFF));
    assert!(held < 0.0 && 0.0 < free, "{held} {free}");
    // Another description contains another envelope.
    let bounds = Bounds::fr3();
    let VelocityBounds::Envelope { mut joints, .. } = bounds.joint_velocity else {
        panic!("the FR3 has an envelope");
    };
    joints.hard_upper[0] = 2.9;
    let shaper = Shaper::new(Version::V10, true, OFF);
    let other = moved(&shaper.with_bounds(bounds.with_envelope_of(&joints)));
    assert!(other > held);
    // The order of the calls has no effect.
    let described = shaper.with_limits_of(&joints);
    assert_eq!(moved(&described.with_bounds(bounds)), other);
    let bounded = shaper.with_bounds(bounds);
    assert_eq!(moved(&bounded.with_limits_of(&joints)), other);
}

#[test]
fn first_position_is_bounded_by_its_own_envelope() {
    let state = at_rest();
    let mut q = JointPositions(state.q_d);
    q.0[0] = 2.75;
    let first = Shaper::new(Version::V10, true, OFF).joint_positions(&q, &state, true);
    // The joint must turn back at 2.75 rad; at 0.1 rad no envelope limits it.
    assert!(first.expect("finite").0[0] < 2.75);
}

#[test]
fn echo_room_is_left_in_protocol_10_unless_it_is_trusted() {
    let state = RobotState {
        tau_J_d: [80.0; 7],
        ..at_rest()
    };
    let step = |shaper: Shaper| {
        let tau = shaper.torques(&Torques([87.0; 7]), &state).expect("finite");
        tau.0[0] - 80.0
    };
    let v10 = Shaper::new(Version::V10, true, OFF);
    assert!((step(v10.trusting_the_echo()) - 0.999_999).abs() < 1e-13);
    // Half of the step of an f32 below 128 is 2^-18. The value of eps / 2 of 80 is a little more.
    let room = 0.999_999 - step(v10);
    assert!((2.0_f64.powi(-18)..5e-6).contains(&room), "{room}");
    assert!((step(Shaper::new(Version::V5, true, OFF)) - 0.999_999).abs() < 1e-13);
}

#[test]
fn defaults_are_those_of_the_vendors_loops() {
    for (version, limits) in [(Version::V5, true), (Version::V10, false)] {
        assert_eq!(Shaper::limits_by_default(version), limits);
        assert_eq!(
            Shaper::by_default(version),
            Shaper::new(version, limits, 100.0)
        );
    }
}

#[test]
fn an_elbow_of_two_zeros_is_none() {
    let state = at_rest();
    let shaper = Shaper::by_default(Version::V5);
    for elbow in [None, Some([0.0, 0.0]), Some([-0.0, 0.0])] {
        let pose = CartesianPose {
            elbow,
            ..nudged(&state)
        };
        let shaped = shaper.cartesian_pose(&pose, &state, false).expect("a pose");
        assert_eq!(shaped.elbow, None);
    }
    let no_sign = CartesianPose {
        elbow: Some([0.1, 0.0]),
        ..nudged(&state)
    };
    assert_eq!(
        shaper.cartesian_pose(&no_sign, &state, false),
        Err(InvalidCommand::ElbowSign)
    );
}

/// The first step that encounters a number that is not finite names the signal.
#[test]
fn non_finite_command_is_refused_by_first_step_to_see_it() {
    let state = at_rest();
    let filter = |signal| InvalidCommand::Filter {
        signal,
        fault: FilterFault::Value,
    };
    for version in Version::ALL {
        for (limit_rate, cutoff) in [(false, OFF), (true, OFF), (false, 100.0), (true, 100.0)] {
            let shaper = Shaper::new(version, limit_rate, cutoff);
            let expected = |limiter, signal| match (limit_rate, cutoff < OFF) {
                (_, true) => filter(signal),
                (true, false) => limiter,
                (false, false) => InvalidCommand::NotFinite,
            };
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let tau = Torques([0.0, 0.0, 0.0, bad, 0.0, 0.0, 0.0]);
                assert_eq!(
                    shaper.torques(&tau, &state),
                    Err(expected(InvalidCommand::NotFinite, Signal::Scalar))
                );
                for first in [false, true] {
                    let q = JointPositions(tau.0);
                    assert_eq!(
                        shaper.joint_positions(&q, &state, first),
                        Err(expected(InvalidCommand::JointPositions, Signal::Scalar))
                    );
                    let mut pose = nudged(&state);
                    pose.O_T_EE[5] = bad;
                    assert_eq!(
                        shaper.cartesian_pose(&pose, &state, first),
                        Err(expected(InvalidCommand::Pose, Signal::Pose))
                    );
                    let mut pose = nudged(&state);
                    pose.elbow = Some([bad, -1.0]);
                    assert_eq!(
                        shaper.cartesian_pose(&pose, &state, first),
                        Err(expected(InvalidCommand::Position, Signal::Scalar))
                    );
                }
                let dq = JointVelocities(tau.0);
                assert_eq!(
                    shaper.joint_velocities(&dq, &state),
                    Err(expected(InvalidCommand::JointVelocities, Signal::Scalar))
                );
                let twist = CartesianVelocities {
                    O_dP_EE: [0.0, 0.0, bad, 0.0, 0.0, 0.0],
                    elbow: None,
                };
                assert_eq!(
                    shaper.cartesian_velocities(&twist, &state),
                    Err(expected(InvalidCommand::Twist, Signal::Scalar))
                );
            }
        }
    }
}

#[test]
fn row_major_pose_is_refused_with_the_text_of_the_step() {
    let state = at_rest();
    let pose = nudged(&state);
    let transposed = CartesianPose {
        O_T_EE: core::array::from_fn(|i| pose.O_T_EE[i % 4 * 4 + i / 4]),
        elbow: None,
    };
    for (limit_rate, expected) in [
        (true, InvalidCommand::LimiterTransformation),
        (false, InvalidCommand::Transformation),
    ] {
        for cutoff in [100.0, OFF] {
            let shaper = Shaper::new(Version::V10, limit_rate, cutoff);
            assert_eq!(
                shaper.cartesian_pose(&transposed, &state, false),
                Err(expected)
            );
        }
    }
}

#[test]
fn invalid_pose_is_refused_even_if_filter_would_mend_it() {
    let state = at_rest();
    let mut pose = nudged(&state);
    for element in &mut pose.O_T_EE[..3] {
        *element *= 1.01;
    }
    for limit_rate in [false, true] {
        let shaper = Shaper::new(Version::V10, limit_rate, 100.0);
        let got = shaper.cartesian_pose(&pose, &state, false);
        assert_eq!(got, Err(InvalidCommand::Transformation));
    }
}

#[test]
fn non_positive_cutoff_is_reported_with_first_command() {
    for cutoff in [0.0, -1.0, f64::NEG_INFINITY, f64::NAN] {
        let shaper = Shaper::new(Version::V10, false, cutoff);
        let got = shaper.torques(&Torques([0.0; 7]), &at_rest());
        let expected = InvalidCommand::Filter {
            signal: Signal::Scalar,
            fault: FilterFault::CutoffFrequency,
        };
        assert_eq!(got, Err(expected));
    }
    for off in [f64::INFINITY, OFF] {
        let shaper = Shaper::new(Version::V10, false, off);
        let tau = Torques([5.0; 7]);
        assert_eq!(shaper.torques(&tau, &at_rest()), Ok(tau));
    }
}

/// Generates ordinary numbers, and all special floating-point values.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -3.0..3.0,
        2 => prop::sample::select(vec![
            f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, 5e-324, -0.0, 1.0, 1e154, 1e30,
        ]),
        1 => prop::num::f64::ANY,
    ]
}

fn any_pose() -> impl Strategy<Value = [f64; 16]> {
    let numbers = prop::collection::vec(any_number(), 16);
    let damaged = (0..16_usize, any_number(), prop::array::uniform6(-3.0..3.0));
    let damaged = damaged.prop_map(|(index, value, [x, y, z, rx, ry, rz])| {
        let pose = Isometry3::new(Vector3::new(x, y, z), Vector3::new(rx, ry, rz));
        let mut pose = transform::array(&pose);
        // One number in four stays unchanged.
        pose[index] = if index % 4 == 3 { pose[index] } else { value };
        pose
    });
    prop_oneof![
        1 => numbers.prop_map(|numbers| core::array::from_fn(|i| numbers[i])),
        3 => damaged,
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    /// For any input from the program and the robot, nothing panics, and every command that passes
    /// is finite and valid.
    #[test]
    fn no_input_at_all_gives_an_invalid_command_or_a_panic(
        numbers in prop::collection::vec(any_number(), 7 * 4 + 6 * 3),
        poses in (any_pose(), any_pose()),
        elbows in prop::array::uniform4(prop::array::uniform2(any_number())),
        (limit_rate, first, v5) in any::<(bool, bool, bool)>(),
        cutoff in prop_oneof![Just(100.0), Just(OFF), any_number()],
    ) {
        let seven = |k: usize| core::array::from_fn(|i| numbers[7 * k + i]);
        let six = |k: usize| core::array::from_fn(|i| numbers[28 + 6 * k + i]);
        let state = RobotState {
            tau_J_d: seven(0),
            q_d: seven(0),
            dq_d: seven(1),
            ddq_d: seven(2),
            O_T_EE_c: poses.0,
            O_dP_EE_c: six(0),
            O_ddP_EE_c: six(1),
            elbow_c: elbows[0],
            delbow_c: elbows[1],
            ddelbow_c: elbows[2],
            ..RobotState::default()
        };
        let version = if v5 { Version::V5 } else { Version::V10 };
        let shaper = Shaper::new(version, limit_rate, cutoff);
        let elbow = Some(elbows[3]);
        if let Ok(sent) = shaper.torques(&Torques(seven(3)), &state) {
            prop_assert!(sent.0.iter().all(|x| x.is_finite()));
        }
        if let Ok(sent) = shaper.joint_positions(&JointPositions(seven(3)), &state, first) {
            prop_assert!(sent.0.iter().all(|x| x.is_finite()));
        }
        if let Ok(sent) = shaper.joint_velocities(&JointVelocities(seven(3)), &state) {
            prop_assert!(sent.0.iter().all(|x| x.is_finite()));
        }
        let twist = CartesianVelocities { O_dP_EE: six(2), elbow };
        if let Ok(sent) = shaper.cartesian_velocities(&twist, &state) {
            prop_assert!(sent.O_dP_EE.iter().chain(sent.elbow.iter().flatten()).all(|x| x.is_finite()));
        }
        let pose = CartesianPose { O_T_EE: poses.1, elbow };
        if let Ok(sent) = shaper.cartesian_pose(&pose, &state, first) {
            prop_assert_eq!(check::pose(&sent.O_T_EE), Ok(()));
            prop_assert!(sent.elbow.is_none_or(|elbow| elbow[0].is_finite() && elbow[1].abs() == 1.0));
        }
    }
}

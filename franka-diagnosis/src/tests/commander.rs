use franka_model::Model;
use franka_proto::MotionGeneratorMode as Generator;
use franka_proto::RobotError as E;

use super::*;
use crate::{Advice, Bound, Cause, Origin, Quantity, Subject};

const ALL: [Commander; 4] = [
    Commander::Goals,
    Commander::Function,
    Commander::Active,
    Commander::Asynchronous,
];

#[test]
fn the_advice_names_settings_that_the_commander_has() {
    for commander in ALL {
        let story = Story::of(Model::fr3(), Generator::None).by(commander);
        let diagnosis = story.stop(
            &[E::ControllerTorqueDiscontinuity],
            |_, command| command.tau_J_d[0] = 5.0,
            |_| {},
        );
        assert_eq!(diagnosis.commander, commander);
        assert_eq!(diagnosis.advice, [Advice::SmoothTorques]);
        let text = diagnosis.to_string();
        for (setting, whose) in [
            ("limit_rate", Commander::Function),
            ("limits with", Commander::Goals),
            ("maximum_joint_velocities", Commander::Asynchronous),
        ] {
            assert_eq!(text.contains(setting), commander == whose, "{text}");
        }
    }
}

#[test]
fn a_torque_step_is_advised_in_torques() {
    for commander in [Commander::Function, Commander::Active] {
        let error = E::ControllerTorqueDiscontinuity;
        let step = |torque: f64| {
            let story = Story::of(Model::fr3(), Generator::None).by(commander);
            let diagnosis = story.stop(&[error], |_, command| command.tau_J_d[3] = torque, |_| {});
            assert_eq!(diagnosis.advice, [Advice::SmoothTorques]);
            (diagnosis.causes.len(), diagnosis.to_string())
        };
        let (causes, text) = step(8.0);
        assert_eq!(causes, 1);
        assert!(
            text.contains("limit 1000 N m/s (8 times as much)"),
            "{text}"
        );
        assert!(
            text.contains("change: torques that start and end at zero"),
            "{text}"
        );
        let ramps = text.contains("limit_rate(true) turns steps into ramps");
        assert_eq!(ramps, commander == Commander::Function, "{text}");
        for of_positions in ["position", "acceleration", "steps of joints"] {
            assert!(!text.contains(of_positions), "{text}");
        }
        // If the log shows no step, the advice follows from the error.
        assert_eq!(step(0.0).0, 0);
    }
}

#[test]
fn the_limiter_is_promised_for_steps_of_joints_only() {
    let story = Story::of(Model::fr3(), Generator::CartesianPosition);
    let error = E::CartesianMotionGeneratorAccelerationDiscontinuity;
    let diagnosis = story.stop(&[error], |_, command| command.O_T_EE_c[14] += 0.001, |_| {});
    assert_eq!(diagnosis.advice, [Advice::Smooth]);
    let text = diagnosis.to_string();
    assert!(text.contains("steps of joints, not of poses"), "{text}");
}

const EVERY_ADVICE: [Advice; 15] = [
    Advice::Smooth,
    Advice::SmoothTorques,
    Advice::SlowDown,
    Advice::StartWhereItIs,
    Advice::FinishAtRest,
    Advice::Network,
    Advice::Host,
    Advice::Thresholds,
    Advice::GiveWay,
    Advice::AvoidSingularity,
    Advice::StayInRange,
    Advice::StayClearOfItself,
    Advice::LessEffort,
    Advice::SofterGains,
    Advice::Desk,
];

#[test]
fn no_advice_speaks_of_a_control_function_where_there_is_none() {
    for advice in EVERY_ADVICE {
        for commander in ALL {
            let text = advice.text(commander);
            let of_functions = ["control function", "limit_rate", "cutoff_frequency"];
            let speaks = of_functions.iter().any(|words| text.contains(words));
            assert!(!speaks || commander == Commander::Function, "{text}");
        }
    }
}

/// A motion with sparse targets. The client sends one target, then the robot moves without commands
/// for this number of cycles.
fn sparse(cycles: u32) -> Story {
    let mut story = Story::of(Model::fr3(), Generator::JointPosition).by(Commander::Asynchronous);
    let asked = story.newest().message_id;
    let mut target = story.newest().q_d;
    target[0] += 0.3;
    for cycle in 0..cycles {
        let before = *story.newest();
        story.go(
            |_, command| (command.message_id, command.q_c) = (asked, target),
            |state| {
                state.q_d = before.q_d;
                state.q_d[0] += 1e-4;
                (state.dq_d, state.ddq_d) = ([0.0; 7], [0.0; 7]);
                state.dq_d[0] = 0.1 * f64::from(cycle.min(1));
            },
        );
    }
    story
}

#[test]
fn sparse_targets_count_as_no_losses_and_no_leaps() {
    let error = E::JointMotionGeneratorAccelerationDiscontinuity;
    let asked = sparse(20).newest().q_d;
    let diagnosis = sparse(20).stop(
        &[error],
        |_, command| command.q_c[1] = asked[1] + 0.2,
        |_| {},
    );
    assert_eq!(diagnosis.finding, None);
    assert!(diagnosis.causes.is_empty(), "{:?}", diagnosis.causes);
    let diagnosis = sparse(20).stop(
        &[error],
        |_, command| (command.q_c, command.motion_generation_finished) = ([0.0; 7], true),
        |_| {},
    );
    assert!(diagnosis.causes.is_empty(), "{:?}", diagnosis.causes);
    // States that did not arrive still count as losses.
    let mut story = sparse(5);
    story.go(|_, _| {}, |state| state.message_id += 3);
    let diagnosis = story.stop(&[error], |_, command| command.message_id = 7, |_| {});
    assert!(
        matches!(
            diagnosis.causes[..],
            [Cause::LostPackets {
                states: 3,
                unanswered: 0,
                ..
            }]
        ),
        "{:?}",
        diagnosis.causes
    );
}

#[test]
fn a_sparse_target_beyond_the_range_is_named_without_a_leap() {
    let error = E::JointMotionGeneratorPositionLimitsViolation;
    let diagnosis = sparse(20).stop(&[error], |_, command| command.q_c[3] = 0.2, |_| {});
    let finding = finding(&diagnosis);
    assert_eq!(
        (finding.subject, finding.quantity, finding.origin),
        (Subject::Joint(4), Quantity::Position, Origin::Commanded)
    );
    assert!(matches!(finding.bound, Bound::AtMost(_)));
    let leaps = |cause: &Cause| matches!(cause, Cause::TargetStep { .. });
    assert!(
        !diagnosis.causes.iter().any(leaps),
        "{:?}",
        diagnosis.causes
    );
    assert_eq!(diagnosis.advice, [Advice::StayInRange]);
}

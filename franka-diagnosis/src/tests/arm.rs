use franka_model::Model;
use franka_proto::MotionGeneratorMode as Generator;
use franka_proto::RobotError as E;

use super::*;
use crate::{Advice, Axis, Bound, Cause, Origin, Quantity, Subject};

fn torques() -> Story {
    Story::of(Model::fr3(), Generator::None)
}

#[test]
fn a_speed_is_too_high_since_the_first_cycle_in_a_row() {
    let mut story = torques();
    // First above, then below, then above to the end.
    for velocity in [2.7, 2.5, 2.63, 2.7, 2.8] {
        story.go(|_, _| {}, |state| state.dq[2] = velocity);
    }
    let from = story.newest().message_id - 2;
    let diagnosis = story.stop(&[E::JointVelocityViolation], |_, _| {}, |_| {});
    let finding = finding(&diagnosis);
    assert_eq!(
        (finding.subject, finding.quantity),
        (Subject::Joint(3), Quantity::Velocity)
    );
    assert_eq!((finding.origin, finding.value), (Origin::Measured, 2.8));
    assert_eq!(finding.bound, Bound::AtMost(2.62));
    assert_eq!(finding.since, from);
    assert_eq!(diagnosis.cycles_before_end(), Some(3));
    assert_eq!(diagnosis.advice, [Advice::SlowDown]);
}

#[test]
fn a_step_in_torque_that_was_allowed_is_still_named() {
    let mut story = torques();
    story.go(|_, command| command.tau_J_d[5] = 0.9, |_| {});
    let diagnosis = story.stop(
        &[E::JointVelocityViolation],
        |_, _| {},
        |state| state.dq[5] = 4.5,
    );
    assert_eq!(finding(&diagnosis).subject, Subject::Joint(6));
    assert!(matches!(
        diagnosis.causes[..],
        [Cause::TargetStep {
            subject: Subject::Joint(6),
            quantity: Quantity::Torque,
            size: 0.9,
            ..
        }]
    ));
}

#[test]
fn a_torque_that_the_limiter_ramps_is_no_step() {
    let mut story = torques();
    // The last step of the limiter is the remainder.
    for torque in [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 8.7] {
        story.go(|_, command| command.tau_J_d[5] = torque * 0.999_999, |_| {});
    }
    let fast = |state: &mut franka_proto::RobotState| state.dq[5] = 4.5;
    let keep = |before: &franka_proto::RobotState, command: &mut franka_proto::RobotCommand| {
        command.tau_J_d = before.tau_J_d;
    };
    let diagnosis = story.stop(&[E::JointVelocityViolation], keep, fast);
    assert_eq!(diagnosis.causes, []);
    assert_eq!(diagnosis.advice, [Advice::SlowDown]);
}

#[test]
fn a_torque_that_goes_on_growing_is_no_step() {
    let mut story = torques();
    for cycle in 1..=20_u32 {
        story.go(
            |_, command| command.tau_J_d[3] = 0.8 * f64::from(cycle),
            |_| {},
        );
    }
    let fast = |state: &mut franka_proto::RobotState| state.dq[3] = 4.5;
    let grow = |before: &franka_proto::RobotState, command: &mut franka_proto::RobotCommand| {
        command.tau_J_d = before.tau_J_d;
        command.tau_J_d[3] += 0.8;
    };
    let diagnosis = story.stop(&[E::JointVelocityViolation], grow, fast);
    assert_eq!(diagnosis.causes, []);
}

#[test]
fn near_a_stretched_arm_a_force_may_be_none() {
    let singular = |elbow: f64| {
        let mut story = torques();
        story.go(|_, _| {}, |state| state.q_d[3] = elbow);
        let diagnosis = story.stop(&[E::CartesianReflex], |_, _| {}, |_| {});
        let singular = |cause: &Cause| matches!(cause, Cause::Singularity { .. });
        diagnosis.causes.iter().any(singular)
    };
    assert_eq!([-2.0, -0.55].map(singular), [false, true]);
}

#[test]
fn a_collision_is_the_flagged_axis_not_the_strongest() {
    let mut story = torques();
    for (force, contact) in [(5.0, 0.0), (12.0, 1.0), (19.0, 1.0)] {
        story.go(
            |_, _| {},
            |state| {
                state.O_F_ext_hat_K = [30.0, 0.0, -force, 0.0, 0.0, 0.0];
                state.cartesian_contact[2] = contact;
            },
        );
    }
    let diagnosis = story.stop(
        &[E::CartesianReflex],
        |_, _| {},
        |state| {
            state.O_F_ext_hat_K[2] = -21.0;
            state.cartesian_collision[2] = 1.0;
        },
    );
    let finding = finding(&diagnosis);
    assert_eq!(finding.subject, Subject::Translation(Axis::Z));
    assert_eq!(
        (finding.value, finding.bound),
        (-21.0, Bound::Between(19.0, 21.0))
    );
    let since = diagnosis.end.unwrap() - 2;
    let contact = Cause::Contact {
        subject: finding.subject,
        value: -21.0,
        since,
    };
    assert_eq!(diagnosis.causes, [contact]);
    assert_eq!(diagnosis.advice, [Advice::Thresholds]);
}

#[test]
fn a_threshold_that_a_larger_load_had_passed_is_not_told() {
    let mut story = torques();
    // The thresholds differ in acceleration phases.
    story.go(|_, _| {}, |state| state.tau_ext_hat_filtered[1] = 30.0);
    let diagnosis = story.stop(
        &[E::JointReflex],
        |_, _| {},
        |state| {
            state.tau_ext_hat_filtered[1] = 25.0;
            state.joint_collision[1] = 1.0;
        },
    );
    assert_eq!(finding(&diagnosis).subject, Subject::Joint(2));
    assert_eq!(finding(&diagnosis).bound, Bound::Unknown);
}

#[test]
fn two_links_that_come_near_each_other_are_named() {
    let mut story = torques();
    let mut q = [0.0; 7];
    // The hand folds back onto the arm.
    (q[1], q[3], q[5]) = (-0.6, -3.0, 0.6);
    story.go(|_, _| {}, |state| (state.q, state.m_ee) = (q, 0.7));
    let diagnosis = story.stop(&[E::SelfCollisionAvoidanceViolation], |_, _| {}, |_| {});
    let finding = finding(&diagnosis);
    let Subject::Bodies(inner, outer) = finding.subject else {
        panic!("{finding:?}")
    };
    assert!(outer >= inner + 3);
    assert!(finding.value < 0.1);
    assert_eq!(diagnosis.advice, [Advice::StayClearOfItself]);
}

#[test]
fn power_torque_and_shaking_are_read_off_the_sensors() {
    let mut story = torques();
    story.go(
        |_, _| {},
        |state| {
            state.tau_J[1] = 90.0;
            state.dq[1] = 2.0;
        },
    );
    let power = story_of(&story).stop(&[E::PowerLimitViolation], |_, _| {}, |_| {});
    assert_eq!(
        (finding(&power).subject, finding(&power).value),
        (Subject::Arm, 180.0)
    );
    let torque = story_of(&story).stop(&[E::TauJRangeViolation], |_, _| {}, |_| {});
    assert_eq!(finding(&torque).subject, Subject::Joint(2));
    assert_eq!(finding(&torque).bound, Bound::AtMost(87.0));
    assert_eq!(torque.advice, [Advice::LessEffort]);
    // After a contact, the advice names neither the load nor the commands.
    let mut touched = story_of(&story);
    for torque in [0.0, 0.9] {
        touched.go(
            |_, command| command.tau_J_d[1] = torque,
            |state| {
                state.O_F_ext_hat_K[1] = -36.0;
                state.cartesian_contact[1] = 1.0;
            },
        );
    }
    let touched = touched.stop(&[E::TauJRangeViolation], |_, _| {}, |_| {});
    let [Cause::Contact { subject, .. }] = touched.causes[..] else {
        panic!("{:?}", touched.causes)
    };
    assert_eq!(subject, Subject::Translation(Axis::Y));
    assert_eq!(touched.advice, [Advice::GiveWay]);
    for swing in 0..12 {
        story.go(
            |_, _| {},
            |state| state.dq[4] = if swing % 2 == 0 { 0.2 } else { -0.2 },
        );
    }
    let shaking = story.stop(&[E::InstabilityDetected], |_, _| {}, |_| {});
    assert_eq!(finding(&shaking).subject, Subject::Joint(5));
    assert_eq!(finding(&shaking).value, 11.0);
    assert_eq!(shaking.advice, [Advice::SofterGains]);
}

fn story_of(story: &Story) -> Story {
    Story {
        commander: story.commander,
        model: story.model,
        entries: story.entries.clone(),
    }
}

#[test]
fn the_fastest_direction_of_the_end_effector_is_named() {
    let mut story = torques();
    // Joint 1 swings a hand that is 0.31 m from its axis; joints 2 and 4 drive it downwards.
    story.go(|_, _| {}, |state| (state.dq[1], state.dq[3]) = (6.0, -5.0));
    let diagnosis = story.stop(&[E::CartesianVelocityViolation], |_, _| {}, |_| {});
    let finding = finding(&diagnosis);
    assert!(matches!(finding.subject, Subject::Translation(_)));
    assert_eq!(finding.bound, Bound::AtMost(3.0));
}

#[test]
fn a_deviation_from_the_path_is_measured() {
    let mut story = torques();
    story.go(|_, _| {}, |state| state.O_T_EE[13] += 0.03);
    let diagnosis = story.stop(&[E::MaxPathPoseDeviationViolation], |_, _| {}, |_| {});
    let finding = finding(&diagnosis);
    assert_eq!(
        (finding.subject, finding.quantity),
        (Subject::Translation(Axis::Y), Quantity::Deviation)
    );
    assert!((finding.value - 0.03).abs() < 1e-12);
}

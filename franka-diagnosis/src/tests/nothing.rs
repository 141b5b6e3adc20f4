use franka_model::Model;
use franka_proto::MotionGeneratorMode as Generator;
use franka_proto::RobotError as E;

use super::*;
use crate::Advice;

#[test]
fn cause_missing_from_the_log_is_called_not_visible() {
    for error in [
        E::JointVelocityViolation,
        E::JointReflex,
        E::CartesianReflex,
        E::JointMotionGeneratorAccelerationDiscontinuity,
        E::JointPositionMotionGeneratorStartPoseInvalid,
        E::ControllerTorqueDiscontinuity,
        E::CartesianPositionLimitsViolation,
        E::SelfCollisionAvoidanceViolation,
    ] {
        let story = Story::of(Model::fr3(), Generator::JointVelocity);
        let diagnosis = story.stop(&[error], |_, _| {}, |_| {});
        assert_eq!((diagnosis.error, diagnosis.finding), (Some(error), None));
        assert!(
            diagnosis.causes.is_empty(),
            "{error}: {:?}",
            diagnosis.causes
        );
        let text = diagnosis.to_string();
        let first = format!("{error}: its cause is not visible in the log of 3 cycles");
        assert_eq!(text.lines().next(), Some(&first[..]));
        assert_eq!(diagnosis.advice.len(), 1);
    }
}

#[test]
fn an_error_that_shows_comes_before_one_that_does_not() {
    let story = Story::of(Model::fr3(), Generator::None);
    let errors = [E::ControllerTorqueDiscontinuity, E::JointVelocityViolation];
    let diagnosis = story.stop(&errors, |_, _| {}, |state| state.dq[0] = -3.0);
    assert_eq!(diagnosis.error, Some(E::JointVelocityViolation));
    assert_eq!(finding(&diagnosis).value, -3.0);
}

#[test]
fn empty_log_and_single_cycle_still_get_a_diagnosis() {
    for error in E::ALL {
        let mut story = Story::unbegun(Model::fr3(), Generator::CartesianPosition);
        let one = story.diagnosis(error.into(), None);
        story.entries.clear();
        let empty = story.diagnosis(error.into(), None);
        assert_eq!((empty.finding, empty.end, empty.cycles), (None, None, 0));
        assert!(
            empty
                .to_string()
                .contains("the log has no cycle of the motion")
        );
        assert_eq!(one.error, Some(error));
        assert_eq!(one.end, Some(BEGIN));
    }
    let story = Story::of(Model::fr3(), Generator::None);
    let none = story.diagnosis(Errors::NONE, None);
    assert_eq!(none.to_string(), "the robot named no error");
}

#[test]
fn a_log_of_numbers_that_are_none_is_read_without_a_panic() {
    for error in E::ALL {
        let mut story = Story::of(Model::fer(), Generator::CartesianPosition);
        let state = &mut story.entries.last_mut().unwrap().state;
        (state.q, state.q_d, state.dq) = ([f64::NAN; 7], [f64::NAN; 7], [f64::INFINITY; 7]);
        state.tau_ext_hat_filtered = [f64::NAN; 7];
        state.joint_collision = [1.0; 7];
        let diagnosis = story.stop(
            &[error],
            |_, command| command.O_T_EE_c = [f64::NAN; 16],
            |_| {},
        );
        assert_eq!(diagnosis.error, Some(error));
    }
}

#[test]
fn walls_are_a_matter_of_desk() {
    let story = Story::of(Model::fr3(), Generator::None);
    let diagnosis = story.stop(&[E::CartesianPositionLimitsViolation], |_, _| {}, |_| {});
    assert_eq!(diagnosis.advice, [Advice::Desk]);
}

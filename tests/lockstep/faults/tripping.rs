//! Reflexes, the user stop, and motions that the robot does not begin.

use franka_lockstep::Lockstep;
use franka_model::READY;
use franka_proto::{MoveGeneratorMode, RobotError};
use franka_rt::lifecycle::MotionError;

use crate::faults::Matrix;
use crate::faults::expect::Expect;
use crate::faults::program::Misbehaviour;
use crate::faults::trial::{Moment, Trial};
use crate::faults::variant::Variant;

#[test]
fn a_reflex_at_any_moment_is_named() {
    let mut matrix = Matrix::new("reflex");
    for variant in Variant::all() {
        for moment in matrix.moments() {
            matrix.case(format_args!("{variant}/{moment:?}"), || {
                let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                trial.until(moment);
                trial.lockstep.robot.trip(RobotError::CartesianReflex);
                let outcome = trial.outcome();
                let expected = match moment {
                    Moment::Armed(0) => Expect::Refused("Reflex"),
                    _ => Expect::reflex([RobotError::CartesianReflex]),
                };
                expected.check(&trial, &outcome);
                trial.works_again();
            });
        }
    }
    matrix.finish();
}

#[test]
fn the_user_stop_at_any_moment_is_reported() {
    let mut matrix = Matrix::new("user-stop");
    for variant in Variant::all() {
        for moment in matrix.moments() {
            matrix.case(format_args!("{variant}/{moment:?}"), || {
                let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                trial.until(moment);
                trial.lockstep.robot.press_user_stop(true);
                let outcome = trial.outcome();
                let expected = match moment {
                    Moment::Armed(0) => Expect::Refused("User stopped"),
                    _ => Expect::UserStop,
                };
                expected.check(&trial, &outcome);
                trial.works_again();
            });
        }
    }
    matrix.finish();
}

/// The refusal comes after the robot has reported the start of the motion, and no state ever shows
/// the motion.
#[test]
fn a_cartesian_motion_does_not_begin_where_the_arm_is_singular() {
    let mut matrix = Matrix::new("singular");
    for (variant, channel) in Variant::cyclic() {
        if !matches!(
            channel.generator,
            MoveGeneratorMode::CartesianPosition | MoveGeneratorMode::CartesianVelocity
        ) {
            continue;
        }
        matrix.case(variant, || {
            let mut lockstep = Lockstep::ready_of(variant.kind);
            lockstep.robot.place(&STRETCHED.into());
            lockstep.run(2);
            let mut trial = Trial::begin_on(lockstep, variant, Misbehaviour::Faultless);
            let outcome = trial.outcome();
            let rejected = |error: &MotionError| matches!(error, MotionError::Rejected(_));
            let text = "libfranka: Move command rejected: cannot start at singular pose!";
            Expect::Other(rejected, text.to_owned()).check(&trial, &outcome);
            trial.lockstep.robot.place(&READY);
            trial.works_again();
        });
    }
    matrix.finish();
}

/// A posture in which a robot refuses to begin, `[rad]`.
const STRETCHED: [f64; 7] = [0.0, 1.28, 0.0, -0.5415, 0.0, 2.74, 0.0];

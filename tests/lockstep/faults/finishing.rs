//! Motions that finish, and motions whose finish causes a reflex.

use franka_proto::{MoveGeneratorMode, RobotError as E};

use crate::faults::expect::Expect;
use crate::faults::program::Misbehaviour;
use crate::faults::trial::Trial;
use crate::faults::variant::Variant;
use crate::faults::{Matrix, course};

#[test]
fn every_way_finishes_without_faults() {
    let mut matrix = Matrix::new("nothing");
    for variant in Variant::all() {
        matrix.case(variant, || {
            let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
            let outcome = trial.outcome();
            Expect::Done.check(&trial, &outcome);
            if variant.channel().is_some() {
                assert_eq!((trial.cycles, trial.finishing), (course::END, 1));
            }
            trial.works_again();
        });
    }
    matrix.finish();
}

#[test]
fn a_motion_may_finish_in_its_first_cycle() {
    let mut matrix = Matrix::new("first");
    for (variant, _) in Variant::cyclic() {
        matrix.case(variant, || {
            let mut trial = Trial::begin(variant, Misbehaviour::FinishesAt(0));
            let outcome = trial.outcome();
            Expect::Done.check(&trial, &outcome);
            assert_eq!((trial.cycles, trial.finishing), (0, 1));
            trial.works_again();
        });
    }
    matrix.finish();
}

/// The command stands still from the finish on: its velocity drops to zero within a millisecond,
/// which violates every limit from the first derivative of the command upwards. For torques alone,
/// the measured velocity counts.
#[test]
fn a_finish_on_a_moving_command_is_a_reflex() {
    let mut matrix = Matrix::new("moving");
    for (variant, channel) in Variant::cyclic() {
        let expected = match channel.generator {
            MoveGeneratorMode::None => {
                Expect::reflex([E::JointMotionGeneratorVelocityDiscontinuity])
            }
            MoveGeneratorMode::JointPosition => Expect::reflex([
                E::JointMotionGeneratorVelocityDiscontinuity,
                E::JointMotionGeneratorAccelerationDiscontinuity,
            ]),
            MoveGeneratorMode::JointVelocity => {
                Expect::reflex([E::JointMotionGeneratorAccelerationDiscontinuity])
            }
            MoveGeneratorMode::CartesianPosition => Expect::reflex([
                E::CartesianMotionGeneratorVelocityDiscontinuity,
                E::CartesianMotionGeneratorAccelerationDiscontinuity,
                E::CartesianMotionGeneratorJointVelocityDiscontinuity,
                E::CartesianMotionGeneratorJointAccelerationDiscontinuity,
            ]),
            MoveGeneratorMode::CartesianVelocity => Expect::reflex([
                E::CartesianMotionGeneratorAccelerationDiscontinuity,
                E::CartesianMotionGeneratorJointAccelerationDiscontinuity,
            ]),
        };
        matrix.case(variant, || {
            let middle = course::REST + course::RAMP + course::CRUISE / 2;
            let mut trial = Trial::begin(variant, Misbehaviour::FinishesAt(middle));
            let outcome = trial.outcome();
            expected.check(&trial, &outcome);
            trial.works_again();
        });
    }
    matrix.finish();
}

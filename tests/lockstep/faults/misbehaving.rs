//! Functions that panic, and invalid commands.

use franka_lockstep::Lockstep;
use franka_proto::MoveGeneratorMode;
use franka_rt::control::{AsynchronousTarget, Shaper, WriteError};
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{GoalError, OnArrival, Target};
use franka_rt::shaping::{FilterFault, InvalidCommand, Signal};

use crate::faults::expect::Expect;
use crate::faults::program::{Misbehaviour, PANIC_MESSAGE};
use crate::faults::trial::{Moment, Trial};
use crate::faults::variant::{Gesture, Variant, Way};
use crate::faults::{Matrix, course};

/// The calls in which a function misbehaves: the first, the second, one in mid-motion, the last.
const CALLS: [u64; 4] = [0, 1, 47, course::END];

#[test]
fn a_panic_in_any_cycle_is_reported_and_the_robot_stopped() {
    let mut matrix = Matrix::new("panic");
    for (variant, channel) in Variant::cyclic() {
        if variant.way != Way::Callback(channel) {
            continue; // Under active control a panic is the caller's own, and drops the handle.
        }
        let beside = channel.is_external() && channel.generator != MoveGeneratorMode::None;
        let beside = beside.then_some(Misbehaviour::TorquesPanicIn(47));
        for misbehaviour in CALLS.map(Misbehaviour::PanicsIn).into_iter().chain(beside) {
            matrix.case(format_args!("{variant}/{misbehaviour:?}"), || {
                let mut trial = Trial::begin(variant, misbehaviour);
                let outcome = trial.outcome();
                let panicked = |error: &MotionError| matches!(error, MotionError::Panicked { .. });
                let text = format!("the control function panicked: {PANIC_MESSAGE}");
                Expect::Other(panicked, text).check(&trial, &outcome);
                trial.works_again();
            });
        }
    }
    matrix.finish();
}

/// Shaping of commands.
#[derive(Clone, Copy, Debug)]
enum Shaping {
    /// Neither filter nor limiter.
    Plain,
    /// Limiter only.
    Limited,
    /// Filter and limiter.
    Filtered,
}

impl Shaping {
    const ALL: [Self; 3] = [Self::Plain, Self::Limited, Self::Filtered];

    /// The error of the first check that finds a non-finite value.
    fn finds(self, generator: MoveGeneratorMode) -> InvalidCommand {
        use InvalidCommand as I;
        match (self, generator) {
            (Self::Plain, _) | (Self::Limited, MoveGeneratorMode::None) => I::NotFinite,
            (Self::Limited, MoveGeneratorMode::JointPosition) => I::JointPositions,
            (Self::Limited, MoveGeneratorMode::JointVelocity) => I::JointVelocities,
            (Self::Limited, MoveGeneratorMode::CartesianPosition) => I::Pose,
            (Self::Limited, MoveGeneratorMode::CartesianVelocity) => I::Twist,
            (Self::Filtered, generator) => I::Filter {
                signal: match generator {
                    MoveGeneratorMode::CartesianPosition => Signal::Pose,
                    _ => Signal::Scalar,
                },
                fault: FilterFault::Value,
            },
        }
    }
}

#[test]
fn a_nan_in_any_cycle_is_reported_and_the_robot_stopped() {
    let mut matrix = Matrix::new("nan");
    for (variant, channel) in Variant::cyclic() {
        if variant.way != Way::Callback(channel) {
            continue;
        }
        for shaping in Shaping::ALL {
            for call in CALLS {
                matrix.case(format_args!("{variant}/{shaping:?}/{call}"), || {
                    let lockstep = Lockstep::ready_of(variant.kind);
                    let version = lockstep.client.version();
                    let shaper = match shaping {
                        Shaping::Plain => Shaper::new(version, false, 1000.0),
                        Shaping::Limited => Shaper::new(version, true, 1000.0),
                        Shaping::Filtered => Shaper::new(version, true, 100.0),
                    };
                    let misbehaviour = Misbehaviour::CommandsNanIn(call);
                    let mut trial = Trial::begin_shaped(lockstep, variant, misbehaviour, shaper);
                    let outcome = trial.outcome();
                    let invalid = |error: &MotionError| matches!(error, MotionError::Invalid(_));
                    let text = shaping.finds(channel.generator).to_string();
                    Expect::Other(invalid, text).check(&trial, &outcome);
                    trial.works_again();
                });
            }
        }
    }
    matrix.finish();
}

/// The refused command counts as lost and the motion continues, since `writeOnce` leaves the
/// decision to its caller.
#[test]
fn writing_a_nan_is_refused_and_the_motion_continues() {
    let mut matrix = Matrix::new("written-nan");
    for (variant, channel) in Variant::cyclic() {
        if variant.way != Way::Active(channel) {
            continue;
        }
        for call in [0, 1, 47] {
            matrix.case(format_args!("{variant}/{call}"), || {
                let mut trial = Trial::begin(variant, Misbehaviour::CommandsNanIn(call));
                let outcome = trial.outcome();
                Expect::Done.check(&trial, &outcome);
                let refused = WriteError::Invalid(InvalidCommand::NotFinite);
                assert_eq!(trial.refused, [refused]);
                assert_eq!(refused.to_string(), "Commanding value is infinite or NaN.");
                trial.works_again();
            });
        }
    }
    matrix.finish();
}

/// Targets are checked where they are set. The real-time thread does not send an invalid target
/// that passes this check.
#[test]
fn an_invalid_sparse_target_ends_the_motion() {
    let mut matrix = Matrix::new("sparse-nan");
    for variant in Variant::all().filter(|variant| variant.way == Way::Asynchronous) {
        for cycle in [1, 20, 60] {
            matrix.case(format_args!("{variant}/{cycle}"), || {
                let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                trial.until(Moment::Cycle(cycle));
                let q = [f64::NAN; 7];
                let finished = false;
                trial.give_target(&AsynchronousTarget { q, finished });
                let outcome = trial.outcome();
                let invalid = |error: &MotionError| matches!(error, MotionError::Invalid(_));
                let text = "Commanding value is infinite or NaN.";
                Expect::Other(invalid, text.to_owned()).check(&trial, &outcome);
                trial.works_again();
            });
        }
    }
    matrix.finish();
}

#[test]
fn an_invalid_goal_is_refused_and_the_motion_continues() {
    let mut matrix = Matrix::new("goal-nan");
    for variant in Variant::all().filter(|variant| variant.is_target()) {
        for moment in [
            Moment::Armed(1),
            Moment::Cycle(1),
            Moment::Cycle(70),
            Moment::Finishing(1),
        ] {
            matrix.case(format_args!("{variant}/{moment:?}"), || {
                let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                trial.until(moment);
                let none = Target::Joints([f64::NAN; 7]);
                let goal = trial.lockstep.goal(none, OnArrival::ReportAndFinish);
                let refused = trial.lockstep.submit(goal);
                let what = "joint positions";
                let error = GoalError::NotFinite { what };
                assert_eq!(refused, Err(MotionError::Goal(error)));
                if variant.way == Way::Target(Gesture::Follow) {
                    let updated = trial.lockstep.update(trial.work, none);
                    assert_eq!(updated, Err(error));
                }
                let outcome = trial.outcome();
                Expect::Done.check(&trial, &outcome);
                trial.works_again();
            });
        }
    }
    matrix.finish();
}

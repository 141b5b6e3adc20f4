//! Functions that panic, and commands that are none.

use franka_proto::MoveGeneratorMode;
use franka_rt::control::{AsynchronousTarget, WriteError};
use franka_rt::lifecycle::MotionError;
use franka_rt::session::{GoalError, OnArrival, Target};
use franka_rt::shaping::{FilterFault, InvalidCommand, Shaper, Signal};
use franka_tests::lockstep::Lockstep;

use crate::faults::expect::Expect;
use crate::faults::program::{Deed, LAST_WORDS};
use crate::faults::trial::{Moment, Trial};
use crate::faults::variant::{Gesture, Variant, Way};
use crate::faults::{Matrix, course};

/// Calls in which a function does what it should not: the first, the second, one in mid motion, the
/// last.
const CALLS: [u64; 4] = [0, 1, 47, course::END];

#[test]
fn a_function_that_panics_in_any_cycle_is_told_and_the_robot_stopped() {
    let mut matrix = Matrix::new("panic");
    for (variant, channel) in Variant::cyclic() {
        if variant.way != Way::Callback(channel) {
            continue; // Under active control a panic is the caller's own, and drops the handle.
        }
        let beside = channel.is_external() && channel.generator != MoveGeneratorMode::None;
        let beside = beside.then_some(Deed::TorquesPanicIn(47));
        for deed in CALLS.map(Deed::PanicsIn).into_iter().chain(beside) {
            matrix.case(format_args!("{variant}/{deed:?}"), || {
                let mut trial = Trial::begin(variant, deed);
                let outcome = trial.outcome();
                let panicked = |error: &MotionError| matches!(error, MotionError::Panicked { .. });
                let text = format!("the control function panicked: {LAST_WORDS}");
                Expect::Other(panicked, text).check(&trial, &outcome);
                trial.works_again();
            });
        }
    }
    matrix.finish();
}

/// How commands are shaped.
#[derive(Clone, Copy, Debug)]
enum Shaping {
    /// Not at all.
    Plain,
    /// By the limiter.
    Limited,
    /// By filter and limiter.
    Filtered,
}

impl Shaping {
    const ALL: [Self; 3] = [Self::Plain, Self::Limited, Self::Filtered];

    /// Who finds what is no number first, and in which words.
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
fn a_function_that_commands_nan_in_any_cycle_is_told_and_the_robot_stopped() {
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
                    let deed = Deed::CommandsNanIn(call);
                    let mut trial = Trial::begin_shaped(lockstep, variant, deed, shaper);
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

/// What is not sent is a lost command: the motion goes on, as `writeOnce` leaves it to whoever
/// called it.
#[test]
fn a_nan_that_is_written_is_refused_and_the_motion_goes_on() {
    let mut matrix = Matrix::new("written-nan");
    for (variant, channel) in Variant::cyclic() {
        if variant.way != Way::Active(channel) {
            continue;
        }
        for call in [0, 1, 47] {
            matrix.case(format_args!("{variant}/{call}"), || {
                let mut trial = Trial::begin(variant, Deed::CommandsNanIn(call));
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

/// Targets are checked where they are given. One that passes all the same, the robot refuses.
#[test]
fn a_sparse_target_that_is_none_ends_the_motion() {
    let mut matrix = Matrix::new("sparse-nan");
    for variant in Variant::all().filter(|variant| variant.way == Way::Asynchronous) {
        for cycle in [1, 20, 60] {
            matrix.case(format_args!("{variant}/{cycle}"), || {
                let mut trial = Trial::begin(variant, Deed::Faultless);
                trial.until(Moment::Cycle(cycle));
                let q = [f64::NAN; 7];
                let finished = false;
                trial.give_target(&AsynchronousTarget { q, finished });
                let outcome = trial.outcome();
                let control = |error: &MotionError| matches!(error, MotionError::Control(_));
                let text = "libfranka: Move command aborted: invalid input provided!";
                Expect::Other(control, text.to_owned()).check(&trial, &outcome);
                trial.works_again();
            });
        }
    }
    matrix.finish();
}

#[test]
fn a_goal_that_is_none_is_refused_and_the_motion_goes_on() {
    let mut matrix = Matrix::new("goal-nan");
    for variant in Variant::all().filter(|variant| variant.is_target()) {
        for moment in [
            Moment::Armed(1),
            Moment::Cycle(1),
            Moment::Cycle(70),
            Moment::Finishing(1),
        ] {
            matrix.case(format_args!("{variant}/{moment:?}"), || {
                let mut trial = Trial::begin(variant, Deed::Faultless);
                trial.until(moment);
                let none = Target::Joints([f64::NAN; 7]);
                let goal = trial.lockstep.goal(none, OnArrival::ReportAndFinish);
                let refused = trial.lockstep.submit(goal);
                assert_eq!(refused, Err(MotionError::Goal(GoalError::NotFinite)));
                if variant.way == Way::Target(Gesture::Follow) {
                    let updated = trial.lockstep.update(trial.work, none);
                    assert_eq!(updated, Err(GoalError::NotFinite));
                }
                let outcome = trial.outcome();
                Expect::Done.check(&trial, &outcome);
                trial.works_again();
            });
        }
    }
    matrix.finish();
}

//! Stops from another handle, and dropped handles.

use crate::faults::Matrix;
use crate::faults::expect::Expect;
use crate::faults::program::Misbehaviour;
use crate::faults::trial::{Moment, Trial};
use crate::faults::variant::Variant;

/// A goal whose finishing command has been sent was reached. A program's motion counts as stopped
/// if the robot reports it stopped.
fn expected(variant: Variant, moment: Moment) -> Expect {
    match moment {
        Moment::Finishing(_) if variant.is_target() => Expect::Done,
        _ => Expect::Stopped,
    }
}

#[test]
fn a_stop_at_any_moment_resolves_itself_and_the_motion() {
    let mut matrix = Matrix::new("stop");
    for variant in Variant::all() {
        for moment in matrix.moments() {
            matrix.case(format_args!("{variant}/{moment:?}"), || {
                let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                trial.until(moment);
                let stop = trial.lockstep.stop().expect("something moves");
                let outcome = trial.outcome();
                expected(variant, moment).check(&trial, &outcome);
                let stopped = trial.lockstep.client.outcome(stop).expect("resolved");
                assert!(stopped.is_ok(), "{stopped:?}");
                assert!(trial.lockstep.stop().is_none(), "nothing moves any more");
                trial.works_again();
            });
        }
    }
    matrix.finish();
}

#[test]
fn a_handle_dropped_at_any_moment_ends_the_motion() {
    let mut matrix = Matrix::new("drop");
    for variant in Variant::all() {
        for moment in matrix.moments() {
            matrix.case(format_args!("{variant}/{moment:?}"), || {
                let mut trial = Trial::begin(variant, Misbehaviour::Faultless);
                trial.until(moment);
                trial.lockstep.cancel(trial.work);
                let outcome = trial.outcome();
                expected(variant, moment).check(&trial, &outcome);
                trial.works_again();
            });
        }
    }
    matrix.finish();
}

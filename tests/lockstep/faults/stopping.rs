//! Stops from elsewhere, and handles that are dropped.

use crate::faults::Matrix;
use crate::faults::expect::Expect;
use crate::faults::program::Deed;
use crate::faults::trial::{Moment, Trial};
use crate::faults::variant::Variant;

/// A goal that the finishing command is out for was reached. A program's motion that the robot says
/// it has stopped, it has not finished.
fn expected(variant: Variant, moment: Moment) -> Expect {
    match moment {
        Moment::Finishing(_) if variant.is_target() => Expect::Done,
        _ => Expect::Stopped,
    }
}

#[test]
fn a_stop_at_any_moment_resolves_for_both() {
    let mut matrix = Matrix::new("stop");
    for variant in Variant::all() {
        for moment in matrix.moments() {
            matrix.case(format_args!("{variant}/{moment:?}"), || {
                let mut trial = Trial::begin(variant, Deed::Faultless);
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
fn a_handle_that_is_dropped_at_any_moment_ends_the_motion() {
    let mut matrix = Matrix::new("drop");
    for variant in Variant::all() {
        for moment in matrix.moments() {
            matrix.case(format_args!("{variant}/{moment:?}"), || {
                let mut trial = Trial::begin(variant, Deed::Faultless);
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

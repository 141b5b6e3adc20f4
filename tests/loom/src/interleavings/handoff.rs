//! The handoff where the cycle changes hands. The lent value is a count of its turns.

use std::time::Duration;

use loom::sync::Arc;
use loom::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use loom::thread;

use crate::handoff::{BorrowError, Handoff};

/// Ticks that never end: a thread that waits for a change must be notified.
const FOREVER: Duration = Duration::MAX;

/// Ticks that are over at once.
const AT_ONCE: Duration = Duration::ZERO;

/// The owner's loop. It runs while `goes_on` returns true, lends the value on request, and then
/// closes the handoff. Returns the total number of turns, if the value is back.
fn own(handoff: &Handoff<u64>, goes_on: impl Fn() -> bool) -> Option<u64> {
    let mut turns = Some(0);
    while let Some(value) = turns.filter(|_| goes_on()) {
        if handoff.is_wanted() {
            turns = handoff.lend(value, || !goes_on()).ok();
        } else {
            thread::yield_now();
        }
    }
    handoff.close();
    turns
}

/// Borrows the value, runs a turn and returns the value.
fn take_a_turn(handoff: &Handoff<u64>) -> Result<(), BorrowError> {
    let turns = handoff.borrow()?;
    handoff.give_back(Some(turns + 1));
    Ok(())
}

/// With ticks that never end, a notification that gets lost would leave a thread waiting for good,
/// which loom reports.
#[test]
fn handoff_serves_the_borrower_that_wants_it() {
    loom::model(|| {
        let handoff = Arc::new(Handoff::new(FOREVER));
        let served = Arc::new(AtomicBool::new(false));
        let borrower = {
            let (handoff, served) = (handoff.clone(), served.clone());
            thread::spawn(move || {
                let got = take_a_turn(&handoff);
                served.store(true, Ordering::Relaxed);
                got
            })
        };
        let turns = own(&handoff, || !served.load(Ordering::Relaxed));
        assert_eq!(borrower.join().expect("no panic"), Ok(()));
        assert_eq!(turns, Some(1), "no turn is lost or doubled");
    });
}

/// Three threads have too many interleavings: those with up to two preemptions are explored.
#[test]
fn two_borrowers_get_it_or_hear_that_the_other_has_it() {
    let mut model = loom::model::Builder::new();
    model.preemption_bound = Some(2);
    model.check(|| {
        let handoff = Arc::new(Handoff::new(FOREVER));
        let left = Arc::new(AtomicU64::new(2));
        let borrowers = [(); 2].map(|()| {
            let (handoff, left) = (handoff.clone(), left.clone());
            thread::spawn(move || {
                let got = take_a_turn(&handoff);
                left.fetch_sub(1, Ordering::Relaxed);
                got
            })
        });
        let turns = own(&handoff, || left.load(Ordering::Relaxed) > 0);
        let got = borrowers.map(|borrower| borrower.join().expect("no panic"));
        let served = got.iter().filter(|got| got.is_ok()).count();
        assert!(served >= 1, "one borrower gets it: {got:?}");
        assert!(
            got.iter()
                .all(|got| matches!(got, Ok(()) | Err(BorrowError::Lent))),
            "{got:?}"
        );
        assert_eq!(turns, Some(served as u64), "no turn is lost or doubled");
    });
}

/// The owner is stopped at any moment: no thread waits forever, and the value ends in one state.
#[test]
fn a_stop_at_any_moment_leaves_nobody_waiting() {
    loom::model(|| {
        let handoff = Arc::new(Handoff::new(AT_ONCE));
        let stop = Arc::new(AtomicBool::new(false));
        let borrower = {
            let handoff = handoff.clone();
            thread::spawn(move || take_a_turn(&handoff))
        };
        let stopper = {
            let stop = stop.clone();
            thread::spawn(move || stop.store(true, Ordering::Relaxed))
        };
        let turns = own(&handoff, || !stop.load(Ordering::Relaxed));
        let got = borrower.join().expect("no panic");
        stopper.join().expect("no panic");
        match (got, turns) {
            // Given back in time, or freed by the borrower, after the owner gave it up.
            (Ok(()), Some(1) | None) => {}
            (Err(BorrowError::Ended), Some(0)) => {}
            other => panic!("{other:?}"),
        }
        assert_eq!(
            handoff.borrow(),
            Err(BorrowError::Ended),
            "no borrower later"
        );
    });
}

/// A borrower that panics returns nothing.
#[test]
fn a_value_that_is_spoilt_ends_the_owner() {
    loom::model(|| {
        let handoff = Arc::new(Handoff::new(FOREVER));
        let borrower = {
            let handoff = handoff.clone();
            thread::spawn(move || {
                let spoilt = handoff.borrow();
                handoff.give_back(None);
                spoilt
            })
        };
        assert_eq!(own(&handoff, || true), None);
        assert_eq!(borrower.join().expect("no panic"), Ok(0));
        assert_eq!(handoff.borrow(), Err(BorrowError::Ended));
    });
}

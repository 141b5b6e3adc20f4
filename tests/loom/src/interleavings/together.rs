//! Members of a common start: they agree on its result, with any simultaneous operations.

use loom::thread;

use crate::together::{Gate, StartBarrier};

#[test]
fn start_begins_for_all_or_for_none() {
    loom::model(|| {
        let [mut first, mut second] = StartBarrier::new().tickets();
        let waiting = thread::spawn(move || {
            let gates = [first.pass(0), first.pass(1)];
            (first, gates)
        });
        second.pass(0);
        // Its motion ends in the next cycle, if it has not begun before.
        second.end();
        let (mut first, gates) = waiting.join().expect("no panic");
        let decided = first.pass(2);
        assert_eq!(decided == Gate::Open, second.refusal().is_none());
        assert_ne!(decided, Gate::Closed);
        for gate in gates {
            assert!(
                gate == Gate::Closed || gate == decided,
                "{gate:?}, {decided:?}"
            );
        }
    });
}

#[test]
fn simultaneous_refusals_are_heard_alike_by_all() {
    loom::model(|| {
        let [mut first, second, mut third] = StartBarrier::new().tickets();
        let leaving = thread::spawn(move || {
            first.pass(0);
            first.end();
            first
        });
        drop(second);
        let gate = third.pass(0);
        assert!(matches!(gate, Gate::Broken(_)), "{gate:?}");
        let first = leaving.join().expect("no panic");
        assert_eq!(third.pass(1), gate);
        assert_eq!(first.refusal(), third.refusal());
    });
}

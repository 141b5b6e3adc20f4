//! Wake-ups per state: a request is never lost to a release at the same time.

use loom::sync::Arc;
use loom::sync::atomic::{AtomicUsize, Ordering};
use loom::thread;

use crate::state_wakeups::StateWakeups;

/// A subscriber is counted before it requests. Meanwhile the bridge finds none and releases.
#[test]
fn a_request_during_a_release_holds_in_the_end() {
    loom::model(|| {
        let state_wakeups = StateWakeups::default();
        let listeners = Arc::new(AtomicUsize::new(0));
        let entering = {
            let (state_wakeups, listeners) = (state_wakeups.clone(), listeners.clone());
            thread::spawn(move || {
                listeners.fetch_add(1, Ordering::Relaxed);
                state_wakeups.request();
            })
        };
        state_wakeups.release(|| listeners.load(Ordering::Relaxed) > 0);
        entering.join().expect("no panic");
        assert!(state_wakeups.are_wanted());
    });
}

#[test]
fn a_release_without_subscribers_holds() {
    loom::model(|| {
        let state_wakeups = StateWakeups::default();
        assert!(state_wakeups.are_wanted(), "initially");
        state_wakeups.release(|| false);
        assert!(!state_wakeups.are_wanted());
    });
}

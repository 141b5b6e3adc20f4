//! The audience: whoever has entered and not left is rung for.

use franka_rt::audience::Audience;
use loom::sync::Arc;
use loom::sync::atomic::{AtomicUsize, Ordering};
use loom::thread;

/// Who listens is counted before it enters; the bridge finds nobody and closes, while somebody
/// comes.
#[test]
fn whoever_enters_while_the_last_one_leaves_is_there_in_the_end() {
    loom::model(|| {
        let audience = Audience::default();
        let listeners = Arc::new(AtomicUsize::new(0));
        let entering = {
            let (audience, listeners) = (audience.clone(), listeners.clone());
            thread::spawn(move || {
                listeners.fetch_add(1, Ordering::Relaxed);
                audience.enter();
            })
        };
        audience.leave(|| listeners.load(Ordering::Relaxed) > 0);
        entering.join().expect("no panic");
        assert!(audience.is_there());
    });
}

#[test]
fn a_room_that_is_empty_stays_so() {
    loom::model(|| {
        let audience = Audience::default();
        assert!(audience.is_there(), "somebody, until it is known");
        audience.leave(|| false);
        assert!(!audience.is_there());
    });
}

//! The bell: what is published before a ring is found by whoever looks after it.
//!
//! The bell itself is an eventfd, which only the kernel can be asked about. Its counter and its
//! readiness are made of a lock and a condition variable here; what is explored is the order of our
//! operations around it, which is that of the thread (publish, note the end, ring) and of the
//! bridge (hear, silence, look).

// Private to the crate, and free of everything else in it.
#[path = "../../src/thread/lifetime.rs"]
mod lifetime;

use franka_rt::slot::{Read, slot};
use loom::sync::atomic::{AtomicU64, Ordering};
use loom::sync::{Arc, Condvar, Mutex};
use loom::thread;

use self::lifetime::Lifetime;

/// What an eventfd does.
#[derive(Default)]
struct Bell {
    rings: Mutex<u64>,
    readable: Condvar,
}

impl Bell {
    fn ring(&self) {
        *self.rings.lock().expect("no panic") += 1;
        self.readable.notify_all();
    }

    /// Waits until it has rung and silences it.
    fn hear(&self) {
        let mut rings = self.rings.lock().expect("no panic");
        while *rings == 0 {
            rings = self.readable.wait(rings).expect("no panic");
        }
        *rings = 0;
    }
}

/// A listener that looks once after each time it hears the bell has the newest value in the end,
/// torn reads or not; one that misses it waits for good, which loom reports.
#[test]
fn whoever_looks_after_each_ring_finds_the_newest_value() {
    loom::model(|| {
        let bell = Arc::new(Bell::default());
        let (mut writer, mut reader) = slot::<[u64; 1]>();
        let publishing = {
            let bell = bell.clone();
            thread::spawn(move || {
                for value in [1, 2] {
                    writer.write(&[value]);
                    bell.ring();
                }
            })
        };
        let mut newest = 0;
        while newest < 2 {
            bell.hear();
            if let Read::Newer([value]) = reader.read_newer() {
                newest = value;
            }
        }
        publishing.join().expect("no panic");
    });
}

#[test]
fn the_end_is_heard_with_all_that_was_left_before_it() {
    loom::model(|| {
        let bell = Arc::new(Bell::default());
        let lifetime = Arc::new(Lifetime::default());
        let left = Arc::new(AtomicU64::new(0));
        let ending = {
            let (bell, lifetime, left) = (bell.clone(), lifetime.clone(), left.clone());
            thread::spawn(move || {
                while !lifetime.stop_wanted() {
                    thread::yield_now();
                }
                left.store(7, Ordering::Relaxed);
                lifetime.note_end();
                bell.ring();
            })
        };
        lifetime.ask_to_stop();
        // Somebody looks without having been told.
        if lifetime.has_ended() {
            assert_eq!(left.load(Ordering::Relaxed), 7);
        }
        bell.hear();
        assert!(lifetime.has_ended(), "the bell rings after the end");
        assert_eq!(left.load(Ordering::Relaxed), 7);
        ending.join().expect("no panic");
    });
}

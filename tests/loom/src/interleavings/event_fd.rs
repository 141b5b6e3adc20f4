//! The wake-up: a listener that looks after a notification finds the value that was published
//! before it.
//!
//! The eventfd itself belongs to the kernel. Here a lock and a condition variable replace its
//! counter and its readiness. The model explores the order of our operations around it: the thread
//! publishes, records the end and notifies; the bridge waits, drains and looks.

use loom::sync::atomic::{AtomicU64, Ordering};
use loom::sync::{Arc, Condvar, Mutex};
use loom::thread;

use crate::lifetime::Lifetime;
use crate::slot::{Read, slot};

/// Model of an eventfd.
#[derive(Default)]
struct EventFd {
    count: Mutex<u64>,
    readable: Condvar,
}

impl EventFd {
    fn notify(&self) {
        *self.count.lock().expect("no panic") += 1;
        self.readable.notify_all();
    }

    /// Waits until it is notified, and drains it.
    fn notified(&self) {
        let mut count = self.count.lock().expect("no panic");
        while *count == 0 {
            count = self.readable.wait(count).expect("no panic");
        }
        *count = 0;
    }
}

/// A listener that looks once after each notification has the newest value in the end, torn reads
/// or not. A listener that misses it would wait forever, which loom reports.
#[test]
fn a_look_after_each_notification_finds_the_newest_value() {
    loom::model(|| {
        let event_fd = Arc::new(EventFd::default());
        let (mut writer, mut reader) = slot::<[u64; 1]>();
        let publishing = {
            let event_fd = event_fd.clone();
            thread::spawn(move || {
                for value in [1, 2] {
                    writer.write(&[value]);
                    event_fd.notify();
                }
            })
        };
        let mut newest = 0;
        while newest < 2 {
            event_fd.notified();
            if let Read::Newer([value]) = reader.read_newer() {
                newest = value;
            }
        }
        publishing.join().expect("no panic");
    });
}

#[test]
fn the_end_is_seen_with_all_that_was_left_before_it() {
    loom::model(|| {
        let event_fd = Arc::new(EventFd::default());
        let lifetime = Arc::new(Lifetime::default());
        let left = Arc::new(AtomicU64::new(0));
        let ending = {
            let (event_fd, lifetime, left) = (event_fd.clone(), lifetime.clone(), left.clone());
            thread::spawn(move || {
                while !lifetime.stop_wanted() {
                    thread::yield_now();
                }
                left.store(7, Ordering::Relaxed);
                lifetime.note_end();
                event_fd.notify();
            })
        };
        lifetime.ask_to_stop();
        // A reader looks without a notification.
        if lifetime.has_ended() {
            assert_eq!(left.load(Ordering::Relaxed), 7);
        }
        event_fd.notified();
        assert!(lifetime.has_ended(), "the notification comes after the end");
        assert_eq!(left.load(Ordering::Relaxed), 7);
        ending.join().expect("no panic");
    });
}

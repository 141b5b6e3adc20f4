//! Conditions under which the thread sends wake-ups.

use franka_rt::driver::Driver;
use franka_rt::thread::{Core, Handle};

use super::{Peer, Probe, VERSION, config, start, wait_for};

/// Sends this many states, each after the previous one was published, and ends the thread. Returns
/// the number of notifications.
fn notifications<C: Core>(mut handle: Handle<C>, robot: &Peer, states: u64) -> u64 {
    for id in 1..=states {
        robot.send(id);
        wait_for("state", || {
            (handle.states.newest()?.message_id == id).then_some(())
        });
    }
    handle.thread.join().expect("nothing panics");
    handle.event_fd.drain()
}

#[test]
fn without_a_request_every_fiftieth_state_wakes() {
    let (handle, robot) = start(config(), Driver::new(VERSION));
    assert_eq!(
        notifications(handle, &robot, 120),
        120 + 1,
        "and at the end"
    );

    let (handle, robot) = start(config(), Driver::new(VERSION));
    handle.state_wakeups.release(|| false);
    assert_eq!(notifications(handle, &robot, 120), 2 + 1);
}

#[test]
fn an_event_wakes_without_a_request() {
    let core = Probe {
        to_say: 0..1,
        ..Probe::default()
    };
    let (handle, robot) = start(config(), core);
    handle.state_wakeups.release(|| false);
    assert_eq!(notifications(handle, &robot, 10), 1 + 1);
}

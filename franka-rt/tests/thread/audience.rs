//! Who is rung for.

use franka_rt::driver::Driver;
use franka_rt::thread::{Core, Handle};

use super::{Peer, Probe, VERSION, config, start, wait_for};

/// Sends so many states, each after the one before has been published; ends the thread; returns how
/// often the bell rang.
fn rings<C: Core>(mut handle: Handle<C>, robot: &Peer, states: u64) -> u64 {
    for id in 1..=states {
        robot.send(id);
        wait_for("state", || {
            (handle.states.newest()?.message_id == id).then_some(())
        });
    }
    handle.thread.join().expect("nothing panics");
    handle.wake.clear()
}

#[test]
fn without_an_audience_the_bell_rings_for_every_fiftieth_state() {
    let (handle, robot) = start(config(), Driver::new(VERSION));
    assert_eq!(rings(handle, &robot, 120), 120 + 1, "and at the end");

    let (handle, robot) = start(config(), Driver::new(VERSION));
    handle.audience.leave(|| false);
    assert_eq!(rings(handle, &robot, 120), 2 + 1);
}

#[test]
fn an_event_is_rung_for_without_an_audience() {
    let core = Probe {
        to_say: 0..1,
        ..Probe::default()
    };
    let (handle, robot) = start(config(), core);
    handle.audience.leave(|| false);
    assert_eq!(rings(handle, &robot, 10), 1 + 1);
}

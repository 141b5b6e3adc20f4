//! Background tasks of the server, which run with or without viewers. They end when the last handle
//! of the hub is dropped.

use std::sync::{Arc, Weak};
use std::time::Duration;

use tokio::time::{MissedTickBehavior, interval};

use super::Hub;
use crate::contact;
use crate::news;
use crate::simulated::Simulated;
use crate::source::Source;

/// Starts the tasks.
pub(super) fn begin(hub: &Arc<Hub>) {
    tokio::spawn(watch_silence(Arc::downgrade(hub)));
    tokio::spawn(watch_contacts(Arc::downgrade(hub)));
    if let Some(simulated) = hub.simulated.clone() {
        let hub = hub.clone();
        tokio::spawn(async move {
            simulated.look().await;
            hub.tick();
        });
    }
    match &hub.source {
        Source::Robot(robot) => {
            tokio::spawn(tell_events(robot.events(), Arc::downgrade(hub)));
        }
        Source::Watched(_) => {
            if let Some(simulated) = hub.simulated.clone() {
                tokio::spawn(follow_simulation(simulated, Arc::downgrade(hub)));
            }
        }
    }
}

/// Ends holds and leases whose viewers have been silent for too long.
async fn watch_silence(hub: Weak<Hub>) {
    let mut clock = interval(Duration::from_millis(10));
    clock.set_missed_tick_behavior(MissedTickBehavior::Skip);
    loop {
        clock.tick().await;
        let Some(hub) = hub.upgrade() else { return };
        hub.tick();
    }
}

/// Estimates contacts while viewers are connected.
async fn watch_contacts(hub: Weak<Hub>) {
    let mut clock = interval(contact::EVERY);
    clock.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let mut watch = contact::Watch::default();
    loop {
        clock.tick().await;
        let Some(hub) = hub.upgrade() else { return };
        if hub.contact.receiver_count() == 0 {
            watch = contact::Watch::default();
            continue;
        }
        let newest = watch.update(hub.source.model(), &hub.source.newest().state);
        hub.contact.send_if_modified(|contact| {
            let changed = *contact != newest;
            *contact = newest;
            changed
        });
    }
}

async fn tell_events(mut events: franka_async::supervision::Events, hub: Weak<Hub>) {
    while let Some(notification) = events.next().await {
        let Some(hub) = hub.upgrade() else { return };
        hub.check_tare(&notification.event.kind);
        if let Some((level, text, detail)) = news::of_event(&notification.event.kind) {
            hub.tell(level, text, detail);
        }
    }
}

/// Copies the states of a simulated robot that another program controls, and reports their changes.
async fn follow_simulation(simulated: Simulated, hub: Weak<Hub>) {
    let copy = |state| {
        let Some(hub) = hub.upgrade() else {
            return false;
        };
        if let Source::Watched(watched) = &hub.source {
            let before = hub.source.newest().state;
            if let Some((level, text, detail)) = news::of_states(&before, &state) {
                hub.tell(level, text, detail);
            }
            watched.set(state);
        }
        true
    };
    simulated.copy_to(copy).await;
}

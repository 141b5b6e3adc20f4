//! Passes arbitrary viewer messages to a lease. It must accept or refuse every message, and no
//! message may have a forbidden effect. A test and the fuzz target `dashboard` use this module.

use core::time::Duration;
use std::time::Instant;

use franka_async::connection::lease::Lease;

use crate::request::Request;
use crate::viewer_lease::{DEADMAN, Effect, LEASE, Permissions, ViewerLease};

/// Passes messages to a lease, and panics if a message has a forbidden effect.
///
/// Each line of `bytes` is a message. Its first byte is the viewer, its second byte is the time
/// since the last message in milliseconds, and the rest is the text. The first byte of `bytes`
/// contains the server's permissions.
pub(crate) fn check(bytes: &[u8]) {
    let Some((permitted, bytes)) = bytes.split_first() else {
        return;
    };
    let permissions = Permissions {
        motion: permitted & 1 != 0,
        disturbances: permitted & 2 != 0,
        gripper: permitted & 4 != 0,
        recording: permitted & 8 != 0,
        patience: Duration::ZERO,
    };
    let mut viewer_lease = ViewerLease::new(permissions, Lease::default(), Instant::now());
    let (mut now, mut fed) = (Duration::ZERO, Duration::ZERO);
    for line in bytes.split(|byte| *byte == b'\n') {
        let [viewer, wait, text @ ..] = line else {
            continue;
        };
        now += Duration::from_millis(u64::from(*wait));
        viewer_lease.tick(now);
        let before = viewer_lease.status();
        let silent = now - fed > DEADMAN;
        assert!(!before.holding || !silent, "moves without messages");
        let Ok(request) = serde_json::from_slice::<Request>(text) else {
            continue;
        };
        let (viewer, valid) = (u64::from(viewer % 4), request.check().is_ok());
        let round_trip = Some(Duration::from_millis(viewer));
        let is_stop = matches!(request, Request::Stop {});
        let step = viewer_lease.handle(now, viewer, round_trip, request);
        let after = viewer_lease.status();
        match &step.effect {
            None => {}
            Some(Effect::Stop) => assert!(is_stop && !after.holding),
            Some(effect) => {
                assert_eq!(before.commander, Some(viewer), "{effect:?}");
                assert!(valid && step.refusal.is_none(), "{effect:?}");
                let permitted = match effect {
                    Effect::Disturb(_) => permissions.disturbances,
                    Effect::Record(_) => permissions.recording,
                    Effect::Gripper(_) => permissions.motion && permissions.gripper,
                    _ => permissions.motion,
                };
                assert!(permitted, "{effect:?}");
            }
        }
        if let Some(Effect::Begin { .. } | Effect::KeepAlive) = step.effect {
            fed = now;
        }
        if before.commander.is_some() && before.commander != Some(viewer) {
            assert_eq!(
                after.commander, before.commander,
                "another page took the lease"
            );
            assert!(after.holding == before.holding || is_stop);
        }
        assert!(!after.holding || after.commander.is_some());
    }
    now += LEASE + Duration::from_millis(1);
    viewer_lease.tick(now);
    assert!(!viewer_lease.status().holding);
}

/// Returns messages of every kind, in the page's format, for one run of [`check`].
pub(crate) fn seeds() -> Vec<Vec<u8>> {
    let session = |permitted: u8| {
        let mut bytes = vec![permitted];
        for text in REQUESTS {
            bytes.extend([b'1', b' ']);
            bytes.extend(text.as_bytes());
            bytes.push(b'\n');
        }
        bytes
    };
    (b'0'..=b'?').map(session).collect()
}

/// A request of each kind.
pub(crate) const REQUESTS: &[&str] = &[
    r#"{"type":"take","name":"Ada"}"#,
    r#"{"type":"seen","server_ms":12}"#,
    r#"{"type":"alive"}"#,
    r#"{"type":"begin","motion":{"kind":"joint","joint":3,"up":true},"speed":0.05}"#,
    r#"{"type":"hold","seq":1}"#,
    r#"{"type":"hold","seq":2}"#,
    r#"{"type":"end"}"#,
    r#"{"type":"begin","motion":{"kind":"translate","direction":[0,0,-1],"axes":"base"},"speed":0.1}"#,
    r#"{"type":"stop"}"#,
    r#"{"type":"begin","motion":{"kind":"rotate","direction":[0,0,1],"axes":"tool"},"speed":0.05}"#,
    r#"{"type":"end"}"#,
    r#"{"type":"begin","motion":{"kind":"joints","q":[0,0,0,-1.5,0,1.5,0]},"speed":0.25}"#,
    r#"{"type":"end"}"#,
    r#"{"type":"begin","motion":{"kind":"ready"},"speed":0.25}"#,
    r#"{"type":"end"}"#,
    r#"{"type":"preview","number":7,"motion":{"kind":"ready"},"speed":0.1}"#,
    r#"{"type":"begin","motion":{"kind":"pose","position":[0.4,0,0.5],"orientation":[1,0,0,0]},"speed":0.1}"#,
    r#"{"type":"end"}"#,
    r#"{"type":"recover"}"#,
    r#"{"type":"disturb","disturbance":{"kind":"push","link":7,"offset":[0,0,0],"force":[0,0,-30]}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"user_stop","pressed":true}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"guide","pressed":true}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"brakes","closed":true}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"reflex"}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"network","conditions":{"loss":0.01,"burst":8,"delay_ms":0.3,"jitter_ms":0,"stalls_per_second":7,"stall_ms":3}}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"cut","milliseconds":25}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"object","width":0.04}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"object","width":null}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"load","mass":1.5}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"arm","arm":"bad"}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"speed","speed":0.1}}"#,
    r#"{"type":"disturb","disturbance":{"kind":"speed","speed":null}}"#,
    r#"{"type":"tune","tuning":{"end_effector":0.25,"joints":0.25,"damping":1,"force_cap":15,"compensation":true}}"#,
    r#"{"type":"begin","motion":{"kind":"stay"},"speed":0.05}"#,
    r#"{"type":"speed","speed":0.1}"#,
    r#"{"type":"end"}"#,
    r#"{"type":"gripper","action":{"kind":"home"}}"#,
    r#"{"type":"gripper","action":{"kind":"move","width":0.08,"speed":0.1}}"#,
    r#"{"type":"gripper","action":{"kind":"grasp","width":0.03,"tolerance":0.01,"speed":0.1,"force":40}}"#,
    r#"{"type":"gripper","action":{"kind":"stop"}}"#,
    r#"{"type":"tare","on":true}"#,
    r#"{"type":"tare","on":false}"#,
    r#"{"type":"record","on":true}"#,
    r#"{"type":"record","on":false}"#,
    r#"{"type":"release"}"#,
];

#[cfg(test)]
mod tests {
    use rand::rngs::SmallRng;
    use rand::{Rng, SeedableRng};

    use super::*;

    /// Passes messages in which bytes were changed, cut and repeated.
    #[test]
    fn no_messages_get_what_they_must_not() {
        let seed: u64 = rand::rng().random();
        println!("seed {seed}");
        let mut random = SmallRng::seed_from_u64(seed);
        for session in seeds() {
            check(&session);
            for _ in 0..3_000 {
                let mut bytes = session.clone();
                for _ in 0..random.random_range(1..6) {
                    let at = random.random_range(0..bytes.len());
                    match random.random_range(0..4) {
                        0 => bytes[at] = random.random(),
                        1 => bytes.insert(at, bytes[at]),
                        2 => drop(bytes.drain(at..bytes.len().min(at + 9))),
                        _ => bytes.extend_from_within(at..),
                    }
                    bytes.truncate(8000);
                    if bytes.is_empty() {
                        break;
                    }
                }
                check(&bytes);
            }
        }
    }
}

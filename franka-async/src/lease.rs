//! The lease of an arm: see [`connection::lease`](crate::connection::lease).

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use franka_rt::session::{Deadman, DeadmanMonitor};

use crate::world;

/// Lease of an arm: the right of one client at a time to command it. This is a cheap handle: clones
/// share the lease.
#[derive(Clone, Debug, Default)]
pub struct Lease {
    state: Arc<Mutex<State>>,
}

/// Holder of a lease: a client that has the right to command the arm.
///
/// Dropping it frees the lease. If a session is bound to the lease, this also brakes the arm, as
/// dropping a [`Deadman`] does. Drop the [`Arm`](crate::Arm) first, because the next holder's
/// session begins when the arm has been released.
#[derive(Debug)]
#[must_use = "dropping the holder brakes the arm and frees the lease"]
pub struct Holder {
    lease: Lease,
    number: u64,
    name: String,
    silence: Duration,
    monitor: DeadmanMonitor,
}

/// Another client holds the lease.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{name:?} holds the lease (the right to command this arm): try again when the lease is free"
)]
pub struct Taken {
    /// Name of the holder.
    pub name: String,
}

/// The holder was silent for too long, so it has lost the lease.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the lease (the right to command this arm) was lost after more than {silence:?} without a \
     heartbeat: take the lease again"
)]
pub struct Lost {
    /// Time for which the lease allowed the holder to be silent.
    pub silence: Duration,
}

/// State that all handles of a lease share.
#[derive(Debug, Default)]
struct State {
    /// The newest time that a call has passed.
    now: Option<Instant>,
    /// Number of times that the lease was taken.
    taken: u64,
    held: Option<Held>,
}

#[derive(Debug)]
struct Held {
    number: u64,
    name: String,
    silence: Duration,
    heard: Instant,
    /// Deadman of the bound sessions. It is dropped with the lease, so that no later message
    /// revives these sessions.
    deadman: Deadman,
}

impl Lease {
    /// Takes the lease under `name`, which is shown to refused clients. The holder loses the lease
    /// after more than `silence` without a call of [`Holder::keep_alive`]. With [`Duration::MAX`],
    /// only the holder itself ends the lease.
    ///
    /// # Errors
    /// Returns [`Taken`] if another client holds the lease.
    pub fn take(
        &self,
        name: impl Into<String>,
        silence: Duration,
        now: Instant,
    ) -> Result<Holder, Taken> {
        let mut state = self.lock();
        let heard = state.advance(now);
        if let Some(held) = &state.held {
            let name = held.name.clone();
            return Err(Taken { name });
        }
        state.taken += 1;
        let (number, name) = (state.taken, name.into());
        let (deadman, monitor) = Deadman::new(silence);
        state.held = Some(Held {
            number,
            name: name.clone(),
            silence,
            heard,
            deadman,
        });
        Ok(Holder {
            lease: self.clone(),
            number,
            name,
            silence,
            monitor,
        })
    }

    /// Returns the name of the holder; `None` if the lease is free.
    pub fn holder(&self, now: Instant) -> Option<String> {
        let mut state = self.lock();
        state.advance(now);
        state.held.as_ref().map(|held| held.name.clone())
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Holder {
    /// Returns the name under which the lease was taken.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Restarts the timer of the lease, and the timers of the sessions that are bound to it.
    ///
    /// # Errors
    /// Returns [`Lost`] if the call comes too late. The arm then stays braked. Take the lease
    /// again, and begin a new session.
    pub fn keep_alive(&self, now: Instant) -> Result<(), Lost> {
        let mut state = self.lease.lock();
        let now = state.advance(now);
        let held = state.held_by(self.number).ok_or_else(|| self.lost_by())?;
        held.heard = now;
        held.deadman.keep_alive();
        Ok(())
    }

    /// True until the lease is lost.
    pub fn is_held(&self, now: Instant) -> bool {
        self.left(now).is_some()
    }

    /// Returns the deadman for a session: see [`Engage::deadman`](crate::Engage::deadman). The
    /// control thread brakes the arm when the holder has been silent for too long, and when the
    /// lease is lost or dropped. A session accepts the deadman only if the lease allows a silence
    /// of [`Deadman::SILENCE_MIN`] or more.
    pub fn deadman(&self) -> DeadmanMonitor {
        self.monitor.clone()
    }

    /// Resolves when the lease is lost, measured by the host's clock. This needs a Tokio runtime.
    ///
    /// # Cancel safety
    /// Nothing happens if the future is dropped.
    pub async fn lost(&self) -> Lost {
        while let Some(left) = self.left(world::now().into_std()) {
            // A silence of exactly the allowed length does not lose the lease.
            world::sleep(left.saturating_add(Duration::from_millis(1))).await;
        }
        self.lost_by()
    }

    /// Frees the lease, as dropping the holder does.
    pub fn release(self) {}

    /// Returns how much longer the holder may be silent; `None` once the lease is lost.
    fn left(&self, now: Instant) -> Option<Duration> {
        let mut state = self.lease.lock();
        let now = state.advance(now);
        let held = state.held_by(self.number)?;
        Some(held.silence.saturating_sub(now - held.heard))
    }

    fn lost_by(&self) -> Lost {
        let silence = self.silence;
        Lost { silence }
    }
}

impl Drop for Holder {
    fn drop(&mut self) {
        let mut state = self.lease.lock();
        if state.held_by(self.number).is_some() {
            state.held = None;
        }
    }
}

impl State {
    /// Advances the time to `now`, and frees the lease if its holder has been silent for too long.
    /// Returns the newest time.
    fn advance(&mut self, now: Instant) -> Instant {
        let now = self.now.map_or(now, |newest| newest.max(now));
        self.now = Some(now);
        self.held.take_if(|held| now - held.heard > held.silence);
        now
    }

    /// Returns the lease while this holder has it.
    fn held_by(&mut self, number: u64) -> Option<&mut Held> {
        self.held.as_mut().filter(|held| held.number == number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SILENCE: Duration = Duration::from_millis(300);

    fn ms(milliseconds: u64) -> Duration {
        Duration::from_millis(milliseconds)
    }

    fn taken(name: &str) -> Taken {
        let name = name.to_owned();
        Taken { name }
    }

    /// True once no session that is bound to the lease moves the arm.
    fn has_braked(monitor: &DeadmanMonitor) -> bool {
        monitor.is_gone()
    }

    #[test]
    fn second_holder_is_refused_with_the_name_of_the_first() {
        let (lease, now) = (Lease::default(), Instant::now());
        let holder = lease.take("Ada", SILENCE, now).expect("it is free");
        for other in [&lease, &lease.clone()] {
            let refused = other.take("Grace", SILENCE, now);
            assert_eq!(refused.expect_err("it is taken"), taken("Ada"));
            assert_eq!(other.holder(now).as_deref(), Some("Ada"));
        }
        // A second request under the same name is refused, too.
        assert!(lease.take("Ada", SILENCE, now).is_err());
        assert!(holder.is_held(now) && holder.name() == "Ada");
    }

    #[test]
    fn heartbeats_keep_the_lease_and_silence_loses_it() {
        let (lease, start) = (Lease::default(), Instant::now());
        let holder = lease.take("Ada", SILENCE, start).expect("it is free");
        let monitor = holder.deadman();
        let mut now = start;
        for _ in 0..10 {
            now += SILENCE;
            assert_eq!(holder.keep_alive(now), Ok(()));
        }
        assert!(holder.is_held(now + SILENCE));
        assert!(!has_braked(&monitor));
        assert!(!holder.is_held(now + SILENCE + ms(1)));
        assert!(has_braked(&monitor), "the control thread brakes, too");
        assert_eq!(lease.holder(now + SILENCE + ms(1)), None);
    }

    #[test]
    fn late_heartbeat_revives_nothing() {
        let (lease, start) = (Lease::default(), Instant::now());
        let late = lease.take("Ada", SILENCE, start).expect("it is free");
        let monitor = late.deadman();
        let now = start + SILENCE + ms(1);
        let lost = Err(Lost { silence: SILENCE });
        assert_eq!(late.keep_alive(now), lost);
        let other = lease.take("Grace", SILENCE, now).expect("it is free");
        assert_eq!(late.keep_alive(now), lost);
        assert!(has_braked(&monitor) && !has_braked(&other.deadman()));
        // A session that the former holder begins now does not move the arm.
        assert!(has_braked(&late.deadman()));
        // The former holder does not end the lease of the present holder.
        drop(late);
        assert!(other.is_held(now) && !has_braked(&other.deadman()));
    }

    #[test]
    fn release_and_drop_brake_and_free() {
        let (lease, now) = (Lease::default(), Instant::now());
        let ways: [fn(Holder); 2] = [Holder::release, drop];
        for end in ways {
            let holder = lease.take("Ada", SILENCE, now).expect("it is free");
            let monitors = [holder.deadman(), holder.deadman()];
            end(holder);
            assert!(monitors.iter().all(has_braked));
            assert_eq!(lease.holder(now), None);
        }
    }

    #[test]
    fn time_that_goes_back_ends_nothing_and_prolongs_nothing() {
        let (lease, start) = (Lease::default(), Instant::now());
        let now = start + ms(1000);
        let holder = lease.take("Ada", SILENCE, now).expect("it is free");
        assert_eq!(holder.keep_alive(start), Ok(()));
        assert!(holder.is_held(now + SILENCE));
        assert!(!holder.is_held(now + SILENCE + ms(1)));
        assert!(!holder.is_held(start));
    }

    #[test]
    fn endless_silence_is_ended_by_the_holder_only() {
        let (lease, now) = (Lease::default(), Instant::now());
        let holder = lease.take("a call", Duration::MAX, now);
        let holder = holder.expect("it is free");
        let later = now + Duration::from_secs(1_000_000);
        assert!(holder.is_held(later) && !has_braked(&holder.deadman()));
        drop(holder);
        assert_eq!(lease.holder(later), None);
    }

    #[tokio::test]
    async fn lost_resolves_after_the_silence() {
        let (lease, start) = (Lease::default(), Instant::now());
        let silence = ms(30);
        let holder = lease.take("Ada", silence, start).expect("it is free");
        drop(holder.lost());
        assert_eq!(holder.lost().await, Lost { silence });
        assert!(start.elapsed() > silence);
        assert!(lease.take("Grace", silence, Instant::now()).is_ok());
    }

    /// Holders come, leave, send messages and are silent in any order. There is never more than one
    /// holder, and the arm moves only for the holder.
    #[test]
    fn any_schedule_has_one_holder_at_most() {
        let start = Instant::now();
        for seed in 0..50_u64 {
            let mut random = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
            let mut draw = |below: u64| {
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                random % below
            };
            let lease = Lease::default();
            let mut clients: [Option<(Holder, DeadmanMonitor)>; 3] = [None, None, None];
            let mut now = start;
            for _ in 0..300 {
                now += ms(draw(200));
                let client = draw(3) as usize;
                let held = clients.iter().flatten();
                let held = held.filter(|(holder, _)| holder.is_held(now)).count();
                let slot = &mut clients[client];
                match (draw(4), &slot) {
                    (0, Some(_)) => *slot = None,
                    (1..3, Some((holder, monitor))) => {
                        let kept = holder.keep_alive(now).is_ok();
                        assert_eq!(kept, !has_braked(monitor), "seed {seed}");
                    }
                    (_, None) => {
                        let took = lease.take(format!("client {client}"), SILENCE, now);
                        assert_eq!(took.is_ok(), held == 0, "seed {seed}");
                        *slot = took.ok().map(|holder| {
                            let monitor = holder.deadman();
                            (holder, monitor)
                        });
                    }
                    _ => {}
                }
                let moving = clients.iter().flatten();
                let moving = moving.filter(|(_, monitor)| !has_braked(monitor)).count();
                assert!(moving <= 1, "seed {seed}: two may move");
                assert_eq!(moving == 1, lease.holder(now).is_some(), "seed {seed}");
            }
        }
    }
}

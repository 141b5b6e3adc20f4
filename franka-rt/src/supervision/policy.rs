//! Policy of a supervisor: its permitted actions and their limits.

use core::time::Duration;

use franka_proto::{Errors, RobotError};

/// Actions of a supervisor when the connection or the robot fails. The default reconnects without a
/// time limit, never recovers from a reflex, and refuses motions meanwhile.
///
/// No earlier motion resumes under any policy: motions and sessions end with the mishap.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use = "a policy does nothing until a robot is supervised by it"]
pub struct Policy {
    pub(super) recovery: Option<Recovery>,
    /// The only errors to recover from. A reflex with any other error is not recovered.
    pub(super) only: Option<Errors>,
    pub(super) agreement: bool,
    pub(super) reconnects: bool,
    /// Pauses between attempts to connect, and to recover.
    pub(super) pauses: Backoff,
    pub(super) give_up_after: Option<Duration>,
    pub(super) silence: Duration,
    pub(super) motions_wait: Option<Duration>,
    pub(super) seed: Option<u64>,
}

/// Rules for recovering from a reflex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Recovery {
    pub(super) times: u32,
    pub(super) window: Duration,
}

/// Pauses between two attempts. The pause after the first attempt is `first`; each further pause is
/// twice as long as the previous one, but at most `most`. The first attempt is made at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Backoff {
    /// The first pause.
    pub first: Duration,
    /// The longest pause.
    pub most: Duration,
    /// Random share of each pause, 0 to 1, by which the pause may be shorter. Robots that were lost
    /// at the same time then reconnect at different times.
    pub jitter: f64,
}

impl Default for Backoff {
    /// Returns pauses from 100 ms to 5 s. The jitter is 0.3.
    fn default() -> Self {
        Self {
            first: Duration::from_millis(100),
            most: Duration::from_secs(5),
            jitter: 0.3,
        }
    }
}

impl Default for Policy {
    fn default() -> Self {
        Self {
            recovery: None,
            only: None,
            agreement: false,
            reconnects: true,
            pauses: Backoff::default(),
            give_up_after: None,
            silence: SILENCE,
            motions_wait: None,
            seed: None,
        }
    }
}

impl Policy {
    /// Recovers from reflexes automatically, at most `times` times within any `window`, failed
    /// attempts included. Further reflexes are left to a person.
    pub fn recover(mut self, times: u32, window: Duration) -> Self {
        self.recovery = Some(Recovery { times, window });
        self
    }

    /// Limits [`Self::recover`] to reflexes all of whose errors are among these. A reflex whose
    /// state has no error is not recovered either.
    pub fn only(mut self, errors: impl IntoIterator<Item = RobotError>) -> Self {
        self.only = Some(errors.into_iter().collect());
        self
    }

    /// Recovers from a reflex only after the user has approved it.
    pub fn ask_first(mut self) -> Self {
        self.agreement = true;
        self
    }

    /// Replaces the pauses between two attempts to connect. Failed recoveries are repeated after
    /// the same pauses, even [without reconnecting](Self::without_reconnecting).
    pub fn reconnect(mut self, backoff: Backoff) -> Self {
        self.pauses = backoff;
        self
    }

    /// Makes no new connection when one is lost, regardless of the pauses of [`Self::reconnect`].
    pub fn without_reconnecting(mut self) -> Self {
        self.reconnects = false;
        self
    }

    /// Gives up when a lost connection was not restored within `time`; never by default.
    pub fn give_up_after(mut self, time: Duration) -> Self {
        self.give_up_after = Some(time);
        self
    }

    /// Sets how long the robot may be silent on a connection that looks alive. After that, the
    /// supervisor closes the connection and makes a new one. 3 s by default. The time begins when
    /// the silence is noticed, after the link timeout.
    pub fn silence(mut self, time: Duration) -> Self {
        self.silence = time;
        self
    }

    /// Lets a motion that is requested while the supervisor reconnects or recovers wait, for `most`
    /// at most, and begin when the robot is ready. By default such a motion is refused at once, as
    /// [`MotionError::NotReady`](crate::lifecycle::MotionError::NotReady).
    ///
    /// The motion waits for the end of this mishap only. Another reflex, a reflex during the
    /// recovery, a connection that is lost again, a user stop, a hand on the arm and closed brakes
    /// refuse the motion. A newer motion supersedes it like a motion under way, and a stop cancels
    /// it.
    pub fn motions_wait(mut self, most: Duration) -> Self {
        self.motions_wait = Some(most);
        self
    }

    /// Sets the seed of the random jitter; by default each robot has a different seed.
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = Some(seed);
        self
    }

    /// As [`Self::seed`], unless a seed was set already.
    pub fn or_seed(mut self, seed: u64) -> Self {
        self.seed = self.seed.or(Some(seed));
        self
    }
}

/// Silence after which a connection is given up, counted from when the silence is noticed.
const SILENCE: Duration = Duration::from_secs(3);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_of_setters_changes_nothing() {
        const SECOND: Duration = Duration::from_secs(1);
        let pauses = Backoff {
            first: SECOND,
            ..Backoff::default()
        };
        let setters: [&dyn Fn(Policy) -> Policy; 9] = [
            &|it| it.recover(3, SECOND),
            &|it| it.only([RobotError::CartesianReflex]),
            &Policy::ask_first,
            &|it| it.reconnect(pauses),
            &Policy::without_reconnecting,
            &|it| it.give_up_after(SECOND),
            &|it| it.silence(SECOND),
            &|it| it.motions_wait(SECOND),
            &|it| it.seed(1).or_seed(2),
        ];
        for (i, first) in setters.iter().enumerate() {
            for second in &setters[i + 1..] {
                let (policy, other) = (Policy::default(), Policy::default());
                assert_eq!(second(first(policy)), first(second(other)), "{i}");
            }
        }
        let policy = Policy::default().reconnect(pauses).without_reconnecting();
        assert!(!policy.reconnects && policy.pauses == pauses);
        let policy = Policy::default().or_seed(2).seed(1);
        assert_eq!(policy.seed, Some(1));
    }
}

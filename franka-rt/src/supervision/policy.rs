//! Policy of a supervisor: its permitted actions, and their limits.

use core::time::Duration;

use franka_proto::{Errors, RobotError};

/// Actions of a supervisor when the connection or the robot fails. The default policy reconnects
/// without a time limit, never recovers from a reflex, and refuses motions until the robot is ready
/// again.
///
/// No policy resumes an earlier motion: motions and sessions end when the connection or the robot
/// fails.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use = "a policy does nothing until a robot is supervised by it"]
pub struct Policy {
    pub(super) recovery: Option<Recovery>,
    /// The only errors from which the supervisor recovers. A reflex with any other error is not
    /// recovered.
    pub(super) only: Option<Errors>,
    pub(super) agreement: bool,
    pub(super) reconnects: bool,
    /// Pauses between attempts to connect, and between attempts to recover.
    pub(super) pauses: Backoff,
    pub(super) give_up_after: Option<Duration>,
    pub(super) silence: Duration,
    pub(super) motions_wait: Option<Duration>,
    pub(super) seed: Option<u64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Recovery {
    pub(super) times: u32,
    pub(super) window: Duration,
}

/// Pauses between attempts. The first attempt is made at once. The pause after it is `first`; each
/// further pause is twice as long as the previous pause, but at most `most`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Backoff {
    /// The first pause.
    pub first: Duration,
    /// The longest pause.
    pub most: Duration,
    /// Greatest random reduction of each pause, as a share between 0 and 1. With it, robots that
    /// were lost at the same time reconnect at different times.
    pub jitter: f64,
}

impl Default for Backoff {
    /// Returns pauses from 100 ms to 5 s, with a jitter of 0.3.
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
    /// Recovers from reflexes automatically, at most `times` times within any `window`. Failed
    /// attempts count. After that, the supervisor does not recover a reflex, even when the window
    /// has passed: the program or a person must recover the robot.
    pub fn recover(mut self, times: u32, window: Duration) -> Self {
        self.recovery = Some(Recovery { times, window });
        self
    }

    /// Limits [`Self::recover`] to reflexes that have only errors from this list. A reflex whose
    /// state has no error is not recovered.
    pub fn only(mut self, errors: impl IntoIterator<Item = RobotError>) -> Self {
        self.only = Some(errors.into_iter().collect());
        self
    }

    /// Recovers from a reflex only after the user has approved it.
    pub fn ask_first(mut self) -> Self {
        self.agreement = true;
        self
    }

    /// Sets the pauses between attempts to connect. The same pauses apply between failed
    /// recoveries, even [without reconnecting](Self::without_reconnecting).
    pub fn reconnect(mut self, backoff: Backoff) -> Self {
        self.pauses = backoff;
        self
    }

    /// Makes no new connection after a lost connection, regardless of the pauses of
    /// [`Self::reconnect`].
    pub fn without_reconnecting(mut self) -> Self {
        self.reconnects = false;
        self
    }

    /// Gives up if a lost connection was not restored within `time`. By default the supervisor
    /// never gives up.
    pub fn give_up_after(mut self, time: Duration) -> Self {
        self.give_up_after = Some(time);
        self
    }

    /// Sets how long the supervisor waits, on a connection without states that is still open, until
    /// it closes the connection and makes a new one. The default is 3 s. The time begins when the
    /// silence is noticed, after the link timeout.
    pub fn silence(mut self, time: Duration) -> Self {
        self.silence = time;
        self
    }

    /// Lets motions wait that are requested while the supervisor reconnects or recovers. Such a
    /// motion waits for at most `most`, and begins when the robot is ready. By default it is
    /// refused at once, as [`MotionError::NotReady`](crate::lifecycle::MotionError::NotReady).
    ///
    /// The motion waits only for the present reconnect or recovery. It is refused after another
    /// reflex (also one during the recovery), after another lost connection or a user stop, and if
    /// a hand guides the arm or the brakes are closed. A newer motion supersedes the waiting motion
    /// as it would supersede a running one, and a stop cancels it.
    pub fn motions_wait(mut self, most: Duration) -> Self {
        self.motions_wait = Some(most);
        self
    }

    /// Sets the seed of the random jitter. By default each robot has a different seed.
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = Some(seed);
        self
    }

    /// Same as [`Self::seed`], but has no effect if a seed was already set.
    pub fn or_seed(mut self, seed: u64) -> Self {
        self.seed = self.seed.or(Some(seed));
        self
    }
}

/// Time without a state after which a connection is given up, counted from the time when the
/// silence is noticed.
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

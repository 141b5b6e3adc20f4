//! The clock of the thread that serves the devices. It schedules the states and handles delays that
//! the host causes.

use std::time::{Duration, Instant};

/// Record of how punctually the simulator ran its milliseconds.
///
/// The thread has ordinary priority, unless [`Sim::realtime`](super::Sim::realtime) requests a
/// higher one. The host therefore delays the thread now and then; real robots have no such delays.
/// By default, the clock then *slips*: a state that is late by more than [`Pace::TOLERANCE`] delays
/// all later states by the same time. A slow host therefore causes no lost commands. `message_id`
/// still advances by one per state, so that robot time lags behind the wall clock.
///
/// With a [strict clock](super::Sim::strict_clock), the simulator instead publishes all due states
/// in a burst, like a robot's network after a stall. If more than [`Pace::BURST`] states are due,
/// the simulator skips the rest of the lost time.
///
/// In [virtual time](super::Sim::virtual_time), the simulator does not use this clock, and no state
/// is late.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Pace {
    /// Number of states due so far.
    pub cycles: u64,
    /// Number of slips of the clock.
    pub slips: u64,
    /// Total time of the slips.
    pub slipped: Duration,
    /// Number of states that directly followed another state in a burst (strict clock only). The
    /// client had no time to answer the preceding state.
    pub burst: u64,
    /// Number of skipped milliseconds (strict clock only).
    pub skipped: u64,
}

impl Pace {
    /// Largest number of states that a strict clock publishes at once.
    pub const BURST: u32 = 4;

    /// Largest delay of a state that does not delay the next state. It is half a period; ordinary
    /// delays of wake-ups are shorter. Two states are never less than half a period apart, unless
    /// the client has answered the first of them.
    pub const TOLERANCE: Duration = Duration::from_micros(500);

    /// Returns the number of cycles in which the host, not the client, was late: slips, states in
    /// bursts, and skipped milliseconds.
    pub fn late(&self) -> u64 {
        self.slips + self.burst + self.skipped
    }

    /// Logs the host's lateness, if any.
    pub(super) fn log(&self) {
        let Self {
            cycles,
            slips,
            slipped,
            burst,
            skipped,
        } = self;
        if *slips > 0 {
            tracing::info!(
                "the host was late for {slips} of {cycles} states: the clock slipped by {slipped:?}"
            );
        }
        if burst + skipped > 0 {
            tracing::info!(
                "the host was late: of {cycles} states, {burst} in bursts, and {skipped} ms skipped"
            );
        }
    }
}

/// Time from one state to the next.
pub(super) const PERIOD: Duration = Duration::from_millis(1);

/// A clock that lags behind the wall clock by the total time of its slips. Instants named `wall`
/// are on the wall clock; all others are on this clock.
#[derive(Debug)]
pub(super) struct Clock {
    strict: bool,
    /// Time at which the next state is due.
    due: Instant,
    /// Time at which the last state left, on the wall clock.
    published_wall: Instant,
    pace: Pace,
}

impl Clock {
    /// Returns a clock whose first state is due one period after `wall`.
    pub(super) fn new(wall: Instant, strict: bool) -> Self {
        Self {
            strict,
            due: wall + PERIOD,
            published_wall: wall,
            pace: Pace::default(),
        }
    }

    pub(super) fn pace(&self) -> Pace {
        self.pace
    }

    pub(super) fn at(&self, wall: Instant) -> Instant {
        wall - self.pace.slipped
    }

    /// Returns the time at which the next state is due.
    pub(super) fn due(&self) -> Instant {
        self.due
    }

    /// Gives the client a whole period to answer the last state, even if that state left late.
    /// Returns the time at which the next state is then due. A strict clock gives the client only
    /// the rest of the period.
    pub(super) fn wait_for_answer(&mut self) -> Instant {
        if !self.strict {
            self.due = self.due.max(self.at(self.published_wall) + PERIOD);
        }
        self.due
    }

    /// Records that the thread awaited a command until `wall`. No state is due before `wall`.
    pub(super) fn waited(&mut self, wall: Instant) {
        self.due = self.due.max(self.at(wall));
    }

    /// Records that the thread woke at `wall` instead of `meant`. The clock slips if `wall` is too
    /// late.
    pub(super) fn woke(&mut self, wall: Instant, meant: Instant) {
        let late = self.at(wall).saturating_duration_since(meant);
        if late > Pace::TOLERANCE && !self.strict {
            self.pace.slips += 1;
            self.pace.slipped += late;
        }
    }

    /// Begins the cycle that is due, at `wall`. Returns the number of states to publish together.
    pub(super) fn begin(&mut self, wall: Instant) -> u32 {
        // The last cycle may have been delayed, too.
        self.woke(wall, self.due);
        let mut states = 1;
        if self.strict {
            let late = self.at(wall).saturating_duration_since(self.due);
            let periods = u32::try_from(late.as_micros() / PERIOD.as_micros());
            let due = periods.unwrap_or(u32::MAX - 1).saturating_add(1);
            states = due.min(Pace::BURST);
            self.pace.burst += u64::from(states - 1);
            self.pace.skipped += u64::from(due - states);
            self.due += PERIOD * (due - 1);
        }
        self.due += PERIOD;
        states
    }

    /// Records that a state left at `wall`.
    pub(super) fn published(&mut self, wall: Instant) {
        self.pace.cycles += 1;
        self.published_wall = wall;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Random;

    /// A wall clock, read by a thread that the host sometimes delays.
    struct Host {
        wall: Instant,
        random: Random,
        /// Probability that the host delays the thread when it has an opportunity.
        likelihood: f64,
    }

    impl Host {
        /// Lets the thread compute for a short random time, with a delay now and then.
        fn compute(&mut self) -> Instant {
            self.wall += Duration::from_micros(50);
            if self.random.uniform() < self.likelihood {
                self.wall += Duration::from_secs_f64(0.05 * self.random.uniform());
            }
            self.wall
        }

        fn sleep_until(&mut self, clock: &mut Clock, until: Instant) {
            let left = until.saturating_duration_since(clock.at(self.wall));
            if !left.is_zero() {
                self.wall += left;
                let wall = self.compute();
                clock.woke(wall, until);
            }
        }
    }

    /// Runs the thread's loop with a client that answers each state after `turnaround`. Returns the
    /// number of late answers, the clock's record, and the duration on the wall clock.
    fn late_answers(strict: bool, likelihood: f64, turnaround: Duration) -> (u64, Pace, Duration) {
        let begun = Instant::now();
        let mut host = Host {
            wall: begun,
            random: Random::new(7),
            likelihood,
        };
        let mut clock = Clock::new(begun, strict);
        let (mut late, mut answer) = (0, begun);
        for _ in 0..5000 {
            let due = clock.due();
            host.sleep_until(&mut clock, due);
            host.compute();
            if answer > host.wall {
                let due = clock.wait_for_answer();
                host.sleep_until(&mut clock, due);
            }
            let states = clock.begin(host.compute());
            for _ in 0..states {
                late += u64::from(answer > host.wall);
                // The state leaves. Then the host may delay the thread.
                answer = host.compute() + turnaround;
                clock.published(host.compute());
            }
        }
        (late, clock.pace(), host.wall - begun)
    }

    #[test]
    fn lateness_of_the_host_is_no_lateness_of_a_client() {
        for turnaround in [10, 400, 990] {
            let turnaround = Duration::from_micros(turnaround);
            let (late, pace, wall) = late_answers(false, 0.02, turnaround);
            assert_eq!(late, 0, "{turnaround:?}: {pace:?}");
            assert_eq!((pace.cycles, pace.burst, pace.skipped), (5000, 0, 0));
            assert!(pace.slips > 100, "{pace:?}");
            assert!(pace.slipped < wall - 5000 * PERIOD, "{pace:?}, {wall:?}");
        }
    }

    #[test]
    fn a_client_that_is_late_stays_late() {
        let (late, ..) = late_answers(false, 0.02, Duration::from_millis(2));
        assert!(late > 2000, "{late}");
    }

    #[test]
    fn a_strict_clock_counts_what_it_sends_in_bursts() {
        let (late, pace, wall) = late_answers(true, 0.02, Duration::from_micros(500));
        assert!(late >= pace.burst && pace.burst > 100, "{late}, {pace:?}");
        assert_eq!((pace.slips, pace.slipped), (0, Duration::ZERO));
        // The clock loses only the time that it counts as skipped.
        let scheduled = PERIOD * u32::try_from(pace.cycles + pace.skipped).expect("few");
        assert!(
            wall < scheduled + Duration::from_millis(60),
            "{wall:?}, {scheduled:?}"
        );
    }

    #[test]
    fn small_delays_move_no_schedule() {
        let begun = Instant::now();
        let mut clock = Clock::new(begun, false);
        for n in 1..100 {
            let due = begun + PERIOD * n;
            assert_eq!(clock.due(), due);
            let wall = due + Pace::TOLERANCE * (n % 2);
            clock.woke(wall, due);
            assert_eq!(clock.begin(wall), 1);
            clock.published(wall);
        }
        assert_eq!(clock.pace().slips, 0);
    }

    #[test]
    fn one_long_stop_moves_the_schedule_once() {
        let begun = Instant::now();
        let mut clock = Clock::new(begun, false);
        let wall = begun + Duration::from_millis(51);
        clock.woke(wall, clock.due());
        assert_eq!(clock.begin(wall), 1);
        clock.published(wall);
        assert_eq!(clock.due(), clock.at(wall + PERIOD));
        let pace = clock.pace();
        assert_eq!((pace.slips, pace.slipped), (1, Duration::from_millis(50)));
    }
}

//! Duration of one cycle, as a whole and by phase.

use core::fmt;
use core::time::Duration;

use franka_model::CYCLE;

use crate::slot::Words;

/// Times of one cycle that sent a command, as a whole and by phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct CycleTimes {
    /// `message_id` of the state that the command answers, `[ms]` of the robot's clock.
    pub time: u64,
    /// Time from the moment when the state was due until the thread had received it. It includes
    /// the network, the kernel and waking up. A state is due a whole number of milliseconds, by
    /// `message_id`, after the most punctual of the last 32 to 64 states. `late` is zero for that
    /// state.
    pub late: Duration,
    /// Time from the receipt of the state until the command was sent, when the system call that
    /// sends it had returned.
    pub turnaround: Duration,
    /// Time left until the next state was due: 1 ms - `late` - `turnaround`. During this time, the
    /// command must travel to the robot, and the next state must travel back.
    pub slack: Slack,
    /// Times of the phases; `None` if the feature `cycle-phases` is off.
    pub phases: Option<Phases>,
}

/// Time from the departure of a command until the next state is due. A negative slack is an
/// overrun: the command left after the next state was due.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(transparent))]
pub struct Slack {
    nanos: i64,
}

/// Times of the phases of one cycle, in their order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Phases {
    /// Time for orders from outside the thread.
    pub orders: Duration,
    /// Time for decoding the state from its bytes.
    pub decode: Duration,
    /// Time for the driver: its law and guards, or a function of the user. Under active control it
    /// includes the time until the user's thread wrote its command.
    pub program: Duration,
    /// Time for encoding the command into bytes and passing it to the kernel.
    pub send: Duration,
    /// Time for work after the command: log, newest state, rings, events, wake-up. A long time
    /// delays the next cycle. Under active control this work comes before the command.
    pub publish: Duration,
    /// Time for work on the next answer that does not need the next state: goals, plans, generator,
    /// inverse kinematics. A long time delays the next cycle.
    pub prepare: Duration,
}

/// Phase of a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Phase {
    /// The state arrived late, or the thread woke up late: [`CycleTimes::late`].
    Arrival,
    /// All work of the thread, if its phases are not timed: [`CycleTimes::turnaround`].
    Answer,
    /// Orders from outside the thread: [`Phases::orders`].
    Orders,
    /// Decoding of the state: [`Phases::decode`].
    Decode,
    /// The program of the motion: [`Phases::program`].
    Program,
    /// Sending of the command: [`Phases::send`].
    Send,
    /// Work after the command: [`Phases::publish`].
    Publish,
    /// Work for the next answer: [`Phases::prepare`].
    Prepare,
}

impl CycleTimes {
    /// Returns a cycle with unknown phases.
    pub fn new(time: u64, late: Duration, turnaround: Duration) -> Self {
        Self {
            time,
            late,
            turnaround,
            slack: Slack::of(late, turnaround),
            phases: None,
        }
    }

    /// Returns the time from the moment when the state was due to the end of all timed work: the
    /// departure of the command, or the later work.
    pub fn total(&self) -> Duration {
        let work = self.phases.map_or(Duration::ZERO, |phases| phases.sum());
        self.late.saturating_add(self.turnaround.max(work))
    }

    /// Returns the longest part, and its duration.
    pub fn longest(&self) -> (Phase, Duration) {
        let late = (Phase::Arrival, self.late);
        let Some(phases) = &self.phases else {
            let answer = (Phase::Answer, self.turnaround);
            return if late.1 > answer.1 { late } else { answer };
        };
        phases.parts().into_iter().fold(
            late,
            |longest, part| {
                if part.1 > longest.1 { part } else { longest }
            },
        )
    }
}

impl Slack {
    /// Returns the time that `late` and `turnaround` leave of a cycle.
    pub(crate) fn of(late: Duration, turnaround: Duration) -> Self {
        let gone = late.saturating_add(turnaround).as_nanos();
        let gone = i64::try_from(gone).unwrap_or(i64::MAX);
        Self {
            nanos: CYCLE_NANOS.saturating_sub(gone),
        }
    }

    /// Returns the slack of `nanos` nanoseconds, negative for an overrun.
    pub fn from_nanos(nanos: i64) -> Self {
        Self { nanos }
    }

    /// Returns the slack in nanoseconds; negative for an overrun.
    pub fn as_nanos(self) -> i64 {
        self.nanos
    }

    /// Returns the time that was left; `None` for an overrun.
    pub fn left(self) -> Option<Duration> {
        u64::try_from(self.nanos).ok().map(Duration::from_nanos)
    }

    /// Returns the time by which the command was too late; `None` if it was in time.
    pub fn overrun(self) -> Option<Duration> {
        (self.nanos < 0).then(|| Duration::from_nanos(self.nanos.unsigned_abs()))
    }
}

impl fmt::Display for Slack {
    /// Prints the slack in milliseconds.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.3} ms", self.nanos as f64 * 1e-6)
    }
}

impl Phases {
    /// Returns the duration of a phase; `None` for a phase that has no field here.
    #[cfg(feature = "cycle-phases")]
    pub(super) fn part_mut(&mut self, phase: Phase) -> Option<&mut Duration> {
        match phase {
            Phase::Orders => Some(&mut self.orders),
            Phase::Decode => Some(&mut self.decode),
            Phase::Program => Some(&mut self.program),
            Phase::Send => Some(&mut self.send),
            Phase::Publish => Some(&mut self.publish),
            Phase::Prepare => Some(&mut self.prepare),
            Phase::Arrival | Phase::Answer => None,
        }
    }

    fn parts(&self) -> [(Phase, Duration); 6] {
        [
            (Phase::Orders, self.orders),
            (Phase::Decode, self.decode),
            (Phase::Program, self.program),
            (Phase::Send, self.send),
            (Phase::Publish, self.publish),
            (Phase::Prepare, self.prepare),
        ]
    }

    fn sum(&self) -> Duration {
        self.parts()
            .iter()
            .fold(Duration::ZERO, |sum, (_, part)| sum.saturating_add(*part))
    }
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Arrival => "arrival",
            Self::Answer => "answer",
            Self::Orders => "orders",
            Self::Decode => "decode",
            Self::Program => "program",
            Self::Send => "send",
            Self::Publish => "publish",
            Self::Prepare => "prepare",
        })
    }
}

impl Words for CycleTimes {
    const WORDS: usize = 11;

    fn store(&self, words: &mut [u64]) {
        let phases = self.phases.unwrap_or_default();
        words.copy_from_slice(&[
            self.time,
            nanos(self.late),
            nanos(self.turnaround),
            self.slack.nanos.cast_unsigned(),
            u64::from(self.phases.is_some()),
            nanos(phases.orders),
            nanos(phases.decode),
            nanos(phases.program),
            nanos(phases.send),
            nanos(phases.publish),
            nanos(phases.prepare),
        ]);
    }

    fn load(words: &[u64]) -> Self {
        let duration = |index: usize| Duration::from_nanos(words[index]);
        Self {
            time: words[0],
            late: duration(1),
            turnaround: duration(2),
            slack: Slack {
                nanos: words[3].cast_signed(),
            },
            phases: (words[4] == 1).then(|| Phases {
                orders: duration(5),
                decode: duration(6),
                program: duration(7),
                send: duration(8),
                publish: duration(9),
                prepare: duration(10),
            }),
        }
    }
}

/// Returns a duration in nanoseconds. Durations above 585 years saturate.
fn nanos(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

/// [`CYCLE`] in nanoseconds: the time from one state to the next.
pub(super) const CYCLE_NANOS: i64 = (CYCLE * 1e9) as i64;

#[cfg(test)]
mod tests {
    use super::*;

    const US: fn(u64) -> Duration = Duration::from_micros;

    fn timed() -> CycleTimes {
        CycleTimes {
            phases: Some(Phases {
                orders: US(1),
                decode: US(2),
                program: US(50),
                send: US(7),
                publish: US(30),
                prepare: US(20),
            }),
            ..CycleTimes::new(17, US(20), US(60))
        }
    }

    #[test]
    fn slack_is_what_a_millisecond_has_left() {
        let slack = |late, turnaround| CycleTimes::new(1, US(late), US(turnaround)).slack;
        assert_eq!(slack(20, 60).left(), Some(US(920)));
        assert_eq!(slack(20, 60).overrun(), None);
        assert_eq!(slack(0, 1000).left(), Some(Duration::ZERO));
        assert_eq!(slack(0, 1000).overrun(), None);
        assert_eq!(slack(600, 700).left(), None);
        assert_eq!(slack(600, 700).overrun(), Some(US(300)));
        assert_eq!(slack(600, 700).as_nanos(), -300_000);
        assert_eq!(slack(600, 700).to_string(), "-0.300 ms");
        assert!(Slack::of(Duration::MAX, Duration::MAX).overrun().is_some());
    }

    #[test]
    fn total_adds_times_after_the_command_and_no_time_twice() {
        assert_eq!(timed().total(), US(20 + 60 + 30 + 20));
        let untimed = CycleTimes {
            phases: None,
            ..timed()
        };
        assert_eq!(untimed.total(), US(80));
        let mut active = timed();
        active.turnaround = US(90); // The command came after the publishing.
        assert_eq!(active.total(), US(130));
    }

    #[test]
    fn the_longest_part_is_named() {
        assert_eq!(timed().longest(), (Phase::Program, US(50)));
        let late = CycleTimes {
            late: US(51),
            ..timed()
        };
        assert_eq!(late.longest(), (Phase::Arrival, US(51)));
        let untimed = CycleTimes {
            phases: None,
            ..late
        };
        assert_eq!(untimed.longest(), (Phase::Answer, US(60)));
        let mut publishing = timed();
        publishing.phases.as_mut().expect("timed").publish = US(400);
        assert_eq!(publishing.longest(), (Phase::Publish, US(400)));
        assert_eq!(Phase::Publish.to_string(), "publish");
    }

    #[test]
    fn cycles_survive_their_words() {
        for cycle in [timed(), CycleTimes::new(u64::MAX, US(800), US(900))] {
            let mut words = [0; CycleTimes::WORDS];
            cycle.store(&mut words);
            assert_eq!(CycleTimes::load(&words), cycle);
        }
    }
}

//! The datagrams recorded by the relay, and their statistics.

use std::collections::HashMap;
use std::time::Duration;

use anyhow::ensure;
use franka_proto::RobotMode;
use hdrhistogram::Histogram;
use serde::Serialize;

/// A state that left for the client.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Departure {
    /// Its `message_id`.
    pub(crate) id: u64,
    /// Time of its departure, since the epoch.
    pub(crate) left: Duration,
    /// The success rate reported by the robot.
    pub(crate) success_rate: f64,
    /// The robot's mode.
    pub(crate) mode: RobotMode,
}

/// A command that arrived from the client.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CommandArrival {
    /// `message_id` of the state that it answers.
    pub(crate) id: u64,
    /// Time of its arrival, since the epoch.
    pub(crate) arrived: Duration,
}

/// All recorded datagrams, in order.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Trace {
    /// States.
    pub(crate) departures: Vec<Departure>,
    /// Commands.
    pub(crate) answers: Vec<CommandArrival>,
}

/// Statistics of a client over a time window.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Summary {
    /// Number of states sent to the client.
    pub(crate) states: u64,
    /// Number of states that it did not answer.
    pub(crate) lost: u64,
    /// Mean of the success rate in those states.
    pub(crate) success_average: f64,
    /// The smallest success rate.
    pub(crate) success_minimum: f64,
    /// The intervals between departures of states: the regularity of robot and relay.
    pub(crate) state_interval: Quantiles,
    /// The intervals between arrivals of commands.
    pub(crate) interval: Quantiles,
    /// The times from the departure of a state to the arrival of its command.
    pub(crate) turnaround: Quantiles,
}

/// The punctuality of the commands in the states for which the robot expected one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Punctuality {
    /// Number of states of a motion.
    pub(crate) states: u64,
    /// Number of states whose command had not arrived when the next state left.
    pub(crate) late: u64,
    /// True if the robot stopped itself.
    pub(crate) reflex: bool,
}

/// Quantiles of durations, in nanoseconds, to three digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Quantiles {
    /// The median.
    pub(crate) p50: u64,
    /// The 99 % quantile.
    pub(crate) p99: u64,
    /// The 99.9 % quantile.
    pub(crate) p99_9: u64,
    /// The maximum.
    pub(crate) max: u64,
}

impl Trace {
    /// Returns statistics over the states that left from `begin` on and before `end`, both since
    /// the epoch.
    ///
    /// # Errors
    /// If no state was answered.
    pub(crate) fn summary(&self, begin: Duration, end: Duration) -> anyhow::Result<Summary> {
        let within = |time: Duration| begin <= time && time < end;
        let answered = self.answered();
        let states: Vec<_> = self.departures.iter().filter(|d| within(d.left)).collect();
        let turnarounds: Vec<Duration> = states
            .iter()
            .filter_map(|state| answered.get(&state.id)?.checked_sub(state.left))
            .collect();
        ensure!(!turnarounds.is_empty(), "no state was answered");
        let rates = || states.iter().map(|state| state.success_rate);
        let arrivals = self.answers.iter().map(|answer| answer.arrived);
        Ok(Summary {
            states: states.len() as u64,
            lost: (states.len() - turnarounds.len()) as u64,
            success_average: rates().sum::<f64>() / states.len() as f64,
            success_minimum: rates().fold(f64::INFINITY, f64::min),
            state_interval: Quantiles::between(states.iter().map(|state| state.left)),
            interval: Quantiles::between(arrivals.filter(|&time| within(time))),
            turnaround: Quantiles::of(turnarounds),
        })
    }

    /// Returns the punctuality of the commands for the states that left from `begin` on and before
    /// `end`.
    pub(crate) fn punctuality(&self, begin: Duration, end: Duration) -> Punctuality {
        let answered = self.answered();
        let mut punctuality = Punctuality::default();
        for pair in self.departures.windows(2) {
            let [state, next] = pair else { continue };
            if state.left < begin || state.left >= end {
                continue;
            }
            punctuality.reflex |= state.mode == RobotMode::Reflex;
            if state.mode == RobotMode::Move {
                let in_time = answered.get(&state.id).is_some_and(|at| *at < next.left);
                punctuality.states += 1;
                punctuality.late += u64::from(!in_time);
            }
        }
        punctuality
    }

    /// Returns the time at which each state was answered. The first answer counts: a robot ignores
    /// a second one.
    fn answered(&self) -> HashMap<u64, Duration> {
        let mut answered = HashMap::new();
        for answer in &self.answers {
            answered.entry(answer.id).or_insert(answer.arrived);
        }
        answered
    }
}

impl Quantiles {
    /// Returns the quantiles of the intervals between these moments.
    fn between(moments: impl Iterator<Item = Duration>) -> Self {
        let moments: Vec<Duration> = moments.collect();
        let gap = |pair: &[Duration]| pair[1].saturating_sub(pair[0]);
        Self::of(moments.windows(2).map(gap))
    }

    /// Returns the quantiles of these durations.
    pub(crate) fn of(durations: impl IntoIterator<Item = Duration>) -> Self {
        let mut histogram = Histogram::<u64>::new_with_bounds(1, LONGEST, DIGITS)
            .expect("these bounds and digits are representable");
        for duration in durations {
            let nanos = u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX);
            // Longer durations count as the longest recordable one.
            histogram.saturating_record(nanos);
        }
        Self {
            p50: histogram.value_at_quantile(0.5),
            p99: histogram.value_at_quantile(0.99),
            p99_9: histogram.value_at_quantile(0.999),
            max: histogram.max(),
        }
    }
}

/// Significant digits of the values.
const DIGITS: u8 = 3;

/// Ten seconds, in nanoseconds: longer than any gap in a motion.
const LONGEST: u64 = 10_000_000_000;

#[cfg(test)]
mod tests {
    use super::*;

    const fn micros(number: u64) -> Duration {
        Duration::from_micros(number)
    }

    /// Returns a hundred states, one per millisecond. State number n is answered after n
    /// microseconds.
    fn hundred() -> Trace {
        let numbers = 1..=100;
        Trace {
            departures: numbers
                .clone()
                .map(|n| Departure {
                    id: n,
                    left: micros(1000 * n),
                    success_rate: if n == 40 { 0.5 } else { 1.0 },
                    mode: RobotMode::Move,
                })
                .collect(),
            answers: numbers
                .map(|n| CommandArrival {
                    id: n,
                    arrived: micros(1000 * n + n),
                })
                .collect(),
        }
    }

    /// True if two values are equal to the digits of the histogram.
    fn near(got: u64, micros: u64) -> bool {
        got.abs_diff(1000 * micros) * 1000 <= 1000 * micros
    }

    #[test]
    fn turnaround_ends_at_first_command_naming_the_state() {
        let mut trace = hundred();
        trace.answers.push(CommandArrival {
            id: 7,
            arrived: micros(200_000),
        });
        let summary = trace.summary(Duration::ZERO, Duration::MAX).unwrap();
        assert_eq!((summary.states, summary.lost), (100, 0));
        let Quantiles { p50, p99, max, .. } = summary.turnaround;
        assert!(near(p50, 50) && near(p99, 99) && near(max, 100), "{p50}");
        assert!(near(summary.state_interval.p99, 1000));
        assert!(near(summary.interval.p50, 1001));
    }

    #[test]
    fn only_states_of_the_window_count() {
        let mut trace = hundred();
        trace.answers.retain(|answer| answer.id != 20);
        let summary = trace.summary(micros(11_000), micros(51_000)).unwrap();
        assert_eq!((summary.states, summary.lost), (40, 1));
        assert_eq!(summary.success_minimum, 0.5);
        assert!((summary.success_average - (1.0 - 0.5 / 40.0)).abs() < 1e-12);
        assert!(near(summary.turnaround.max, 50));
    }

    #[test]
    fn a_command_is_late_once_the_next_state_has_left() {
        let mut trace = hundred();
        trace.answers.retain(|answer| answer.id != 20);
        trace.answers[30].arrived += micros(1000);
        trace.departures[50].mode = RobotMode::Idle;
        let all = trace.punctuality(Duration::ZERO, Duration::MAX);
        // No state left after the last.
        assert_eq!((all.states, all.late, all.reflex), (98, 2, false));
        trace.departures[60].mode = RobotMode::Reflex;
        let window = trace.punctuality(micros(25_000), micros(65_000));
        assert_eq!((window.states, window.late, window.reflex), (38, 1, true));
    }

    #[test]
    fn a_client_that_never_answered_has_no_statistics() {
        let trace = Trace {
            answers: Vec::new(),
            ..hundred()
        };
        assert!(trace.summary(Duration::ZERO, Duration::MAX).is_err());
    }
}

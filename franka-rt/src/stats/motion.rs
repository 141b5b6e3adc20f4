//! Counts and times of one motion.

use core::time::Duration;

use franka_proto::RobotState;

use super::{CycleTimes, Histogram, Slack};
use crate::slot::Words;

/// Counts of one motion while it runs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionStatistics {
    /// Number of states of the motion that were received and not skipped.
    pub cycles: u64,
    /// Number of states that never arrived.
    pub lost_states: u64,
    /// Number of states that were skipped, because a newer state had also arrived.
    pub skipped_states: u64,
    /// Lowest `control_command_success_rate` of the motion, in `[0, 1]`.
    pub success_rate_min: f64,
    /// Newest rate, in `[0, 1]`; 1 before the first rate.
    pub success_rate_newest: f64,
    success_rate_sum: f64,
    success_rate_count: u64,
    /// `message_id` of the first state and of the last state.
    span: (u64, u64),
    /// Number of commands that were sent.
    pub commands: u64,
    /// Number of commands that were sent after the next state was due.
    pub overruns: u64,
    /// Longest time from the receipt of a state to the departure of its command.
    pub worst_turnaround: Duration,
    slack_min: Slack,
    worst: CycleTimes,
}

impl Default for MotionStatistics {
    fn default() -> Self {
        Self {
            cycles: 0,
            lost_states: 0,
            skipped_states: 0,
            success_rate_min: 1.0,
            success_rate_newest: 1.0,
            success_rate_sum: 0.0,
            success_rate_count: 0,
            span: (0, 0),
            commands: 0,
            overruns: 0,
            worst_turnaround: Duration::ZERO,
            slack_min: Slack::default(),
            worst: CycleTimes::default(),
        }
    }
}

impl MotionStatistics {
    /// Returns the mean `control_command_success_rate`, in `[0, 1]`; 1 if the motion was too short
    /// to report a rate.
    pub fn success_rate_avg(&self) -> f64 {
        if self.success_rate_count == 0 {
            1.0
        } else {
            self.success_rate_sum / self.success_rate_count as f64
        }
    }

    /// Returns the time from the first state of the motion to the last, `[ms]` of the robot's
    /// clock.
    pub fn duration_ms(&self) -> u64 {
        self.span.1 - self.span.0
    }

    /// Returns the lowest slack of a command; `None` before the first command.
    pub fn slack_min(&self) -> Option<Slack> {
        (self.commands > 0).then_some(self.slack_min)
    }

    /// Returns the cycle with the longest [`CycleTimes::total`]; `None` before the first command.
    pub fn worst_cycle(&self) -> Option<CycleTimes> {
        (self.commands > 0).then_some(self.worst)
    }

    /// Counts one state of the running motion, and the states that were lost or skipped before it.
    /// The first and the final state of a motion always report a success rate of 0, so rates of
    /// zero do not count.
    pub(crate) fn note_state(&mut self, state: &RobotState, lost: u64, skipped: u64) {
        if self.cycles == 0 {
            self.span.0 = state.message_id;
        }
        self.cycles += 1;
        self.lost_states += lost;
        self.skipped_states += skipped;
        self.span.1 = state.message_id;
        let rate = state.control_command_success_rate;
        if rate > 0.0 {
            self.success_rate_min = self.success_rate_min.min(rate);
            self.success_rate_newest = rate;
            self.success_rate_sum += rate;
            self.success_rate_count += 1;
        }
    }

    /// Counts one command that was sent.
    pub(crate) fn note_cycle(&mut self, cycle: &CycleTimes) {
        if self.commands == 0 || cycle.slack < self.slack_min {
            self.slack_min = cycle.slack;
        }
        if self.commands == 0 || cycle.total() > self.worst.total() {
            self.worst = *cycle;
        }
        self.commands += 1;
        self.overruns += u64::from(cycle.slack.overrun().is_some());
        self.worst_turnaround = self.worst_turnaround.max(cycle.turnaround);
    }
}

impl Words for MotionStatistics {
    const WORDS: usize = OWN_WORDS + CycleTimes::WORDS;

    fn store(&self, words: &mut [u64]) {
        let (own, worst) = words.split_at_mut(OWN_WORDS);
        own.copy_from_slice(&[
            self.cycles,
            self.lost_states,
            self.skipped_states,
            self.success_rate_min.to_bits(),
            self.success_rate_newest.to_bits(),
            self.success_rate_sum.to_bits(),
            self.success_rate_count,
            self.span.0,
            self.span.1,
            self.commands,
            self.overruns,
            u64::try_from(self.worst_turnaround.as_nanos()).unwrap_or(u64::MAX),
            self.slack_min.as_nanos().cast_unsigned(),
        ]);
        self.worst.store(worst);
    }

    fn load(words: &[u64]) -> Self {
        let (own, worst) = words.split_at(OWN_WORDS);
        Self {
            cycles: own[0],
            lost_states: own[1],
            skipped_states: own[2],
            success_rate_min: f64::from_bits(own[3]),
            success_rate_newest: f64::from_bits(own[4]),
            success_rate_sum: f64::from_bits(own[5]),
            success_rate_count: own[6],
            span: (own[7], own[8]),
            commands: own[9],
            overruns: own[10],
            worst_turnaround: Duration::from_nanos(own[11]),
            slack_min: Slack::from_nanos(own[12].cast_signed()),
            worst: CycleTimes::load(worst),
        }
    }
}

/// Number of words of a motion's statistics before its worst cycle.
const OWN_WORDS: usize = 13;

/// Times of the cycles of one motion. They are allocated outside the thread, written by the thread,
/// and readable anywhere.
#[derive(Debug, Default)]
pub struct MotionTimes {
    /// Times between consecutive states, by this host's clock.
    pub interval: Histogram,
    /// Times from the receipt of a state to the departure of its command.
    pub turnaround: Histogram,
}

#[cfg(test)]
mod tests {
    use super::*;

    const US: fn(u64) -> Duration = Duration::from_micros;

    fn state(time: u64, rate: f64) -> RobotState {
        RobotState {
            message_id: time,
            control_command_success_rate: rate,
            ..RobotState::default()
        }
    }

    fn some() -> MotionStatistics {
        let mut statistics = MotionStatistics::default();
        for (time, rate, lost, skipped) in [
            (100, 0.0, 0, 0),
            (101, 1.0, 0, 0),
            (105, 0.9, 1, 2),
            (106, 0.95, 0, 0),
            (107, 0.0, 0, 0),
        ] {
            statistics.note_state(&state(time, rate), lost, skipped);
        }
        for (time, late, turnaround) in [(100, 0, 30), (101, 940, 100), (105, 700, 350)] {
            statistics.note_cycle(&CycleTimes::new(time, US(late), US(turnaround)));
        }
        statistics
    }

    #[test]
    fn statistics_count_missing_states_and_inner_rates() {
        let statistics = some();
        assert_eq!(statistics.cycles, 5);
        assert_eq!((statistics.lost_states, statistics.skipped_states), (1, 2));
        assert_eq!(statistics.duration_ms(), 7);
        assert_eq!(statistics.success_rate_min, 0.9);
        assert_eq!(statistics.success_rate_newest, 0.95);
        assert!((statistics.success_rate_avg() - 0.95).abs() < 1e-15);
    }

    #[test]
    fn the_worst_cycle_is_that_with_the_longest_total() {
        let statistics = some();
        assert_eq!((statistics.commands, statistics.overruns), (3, 2));
        assert_eq!(statistics.worst_turnaround, US(350));
        let worst = statistics.worst_cycle().expect("commands left");
        assert_eq!((worst.time, worst.total()), (105, US(1050)));
        assert_eq!(statistics.slack_min(), Some(worst.slack));
        let none = MotionStatistics::default();
        assert_eq!((none.worst_cycle(), none.slack_min()), (None, None));
        assert_eq!(none.success_rate_avg(), 1.0);
    }

    #[test]
    fn statistics_survive_their_words() {
        for statistics in [some(), MotionStatistics::default()] {
            let mut words = [0; MotionStatistics::WORDS];
            statistics.store(&mut words);
            assert_eq!(MotionStatistics::load(&words), statistics);
        }
    }
}

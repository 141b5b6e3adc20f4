//! Emits the statistics of the control thread as `tracing` events, so that the thread itself does
//! not.

use std::sync::Arc;
use std::time::Duration;

use franka_rt::driver::Ended;
use franka_rt::stats::{CycleTimes, Stats};

use crate::world::Instant;

/// Checks the statistics for commands that were sent too late.
pub(crate) struct Telemetry {
    stats: Arc<Stats>,
    /// Number of overruns reported so far.
    told: u64,
    warnings: Backoff,
}

/// A growing interval between warnings of a lasting condition.
#[derive(Default)]
struct Backoff {
    last: Option<Instant>,
    /// Shortest time from the last warning to the next one.
    interval: Duration,
}

impl Backoff {
    /// Returns true if a warning is due now, and then counts it as emitted.
    fn take(&mut self, now: Instant) -> bool {
        let since = self.last.map(|last| now.duration_since(last));
        self.interval = match since {
            Some(since) if since < self.interval => return false,
            Some(since) if since < 2 * self.interval => (2 * self.interval).min(INTERVAL_MAX),
            _ => INTERVAL_MIN,
        };
        self.last = Some(now);
        true
    }
}

impl Telemetry {
    pub(crate) fn new(stats: Arc<Stats>) -> Self {
        Self {
            stats,
            told: 0,
            warnings: Backoff::default(),
        }
    }

    /// Warns about commands that were sent too late since the last warning. The first warning comes
    /// at once. While more follow, warnings come after a second, after two, and so on, and finally
    /// twice a minute.
    pub(crate) fn watch(&mut self, now: Instant) {
        let overruns = self.stats.overrun.count();
        if overruns == self.told {
            return;
        }
        // The thread writes the cycle before it counts the overrun.
        let Some(cycle) = self.stats.newest_overrun() else {
            return;
        };
        if !self.warnings.take(now) {
            return;
        }
        let (phase, longest) = cycle.longest();
        tracing::warn!(
            overruns = overruns - self.told,
            time = cycle.time,
            slack_us = cycle.slack.as_nanos() / 1000,
            late_us = micros(cycle.late),
            turnaround_us = micros(cycle.turnaround),
            %phase,
            phase_us = micros(longest),
            "commands left after the next state was due; the newest late cycle is shown. `franka doctor` finds causes on this computer"
        );
        self.told = overruns;
    }
}

/// Logs a summary of a motion whose end the thread has reported.
pub(crate) fn sum_up(ended: &Ended) {
    let (statistics, times) = (&ended.statistics, &ended.times);
    let interval = times.interval.quantiles().unwrap_or_default();
    let turnaround = times.turnaround.quantiles().unwrap_or_default();
    let worst = statistics.worst_cycle();
    let (phase, longest) = worst.as_ref().map(CycleTimes::longest).unzip();
    tracing::info!(
        motion = ended.motion.0,
        ending = ?ended.ending,
        duration_ms = statistics.duration_ms(),
        cycles = statistics.cycles,
        commands = statistics.commands,
        lost = statistics.lost_states,
        skipped = statistics.skipped_states,
        overruns = statistics.overruns,
        success_rate_min = statistics.success_rate_min,
        success_rate_avg = statistics.success_rate_avg(),
        slack_min_us = statistics.slack_min().map(|slack| slack.as_nanos() / 1000),
        interval_p50_us = micros(interval.p50),
        interval_p99_us = micros(interval.p99),
        turnaround_p50_us = micros(turnaround.p50),
        turnaround_p99_us = micros(turnaround.p99),
        turnaround_max_us = micros(statistics.worst_turnaround),
        worst_time = worst.map(|worst| worst.time),
        worst_us = worst.map(|worst| micros(worst.total())),
        worst_phase = phase.map(tracing::field::display),
        worst_phase_us = longest.map(micros),
        "control thread finished the motion"
    );
}

fn micros(duration: Duration) -> u64 {
    u64::try_from(duration.as_micros()).unwrap_or(u64::MAX)
}

/// Time between the first two warnings.
const INTERVAL_MIN: Duration = Duration::from_secs(1);

/// Longest interval between warnings on a computer that is always late.
const INTERVAL_MAX: Duration = Duration::from_secs(32);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lasting_warning_repeats_ever_more_rarely_until_a_pause() {
        let begin = crate::world::now();
        let mut backoff = Backoff::default();
        let mut due = |second: u64| backoff.take(begin + Duration::from_secs(second));
        let told: Vec<u64> = (0..130).filter(|second| due(*second)).collect();
        assert_eq!(told, [0, 1, 3, 7, 15, 31, 63, 95, 127]);
        let told: Vec<u64> = (300..310).filter(|second| due(*second)).collect();
        assert_eq!(told, [300, 301, 303, 307]);
    }
}

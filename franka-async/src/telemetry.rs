//! The statistics of the control thread as `tracing` events, which are sent from here and never
//! from the thread.

use std::sync::Arc;
use std::time::Duration;

use franka_rt::driver::Ended;
use franka_rt::stats::{CycleTimes, Stats};
use tokio::time::Instant;

/// Watches the statistics for commands that left too late.
pub(crate) struct Telemetry {
    stats: Arc<Stats>,
    /// Overruns that were told.
    told: u64,
    /// When the last of them were.
    last: Option<Instant>,
}

impl Telemetry {
    pub(crate) fn new(stats: Arc<Stats>) -> Self {
        Self {
            stats,
            told: 0,
            last: None,
        }
    }

    /// Warns of commands that left too late since the last time: once a second while there are
    /// more.
    pub(crate) fn watch(&mut self, now: Instant) {
        let overruns = self.stats.overrun.count();
        let quiet = self.last.is_some_and(|last| now < last + WARNING_INTERVAL);
        if overruns == self.told || quiet {
            return;
        }
        // Written before it is counted.
        let Some(cycle) = self.stats.newest_overrun() else {
            return;
        };
        let (phase, longest) = cycle.longest();
        tracing::warn!(
            overruns = overruns - self.told,
            time = cycle.time,
            slack_us = cycle.slack.as_nanos() / 1000,
            late_us = micros(cycle.late),
            turnaround_us = micros(cycle.turnaround),
            %phase,
            phase_us = micros(longest),
            "commands left after the next state was due; this is the newest"
        );
        self.told = overruns;
        self.last = Some(now);
    }
}

/// Sums a motion up that has ended for the thread.
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
        "motion over for the control thread"
    );
}

fn micros(duration: Duration) -> u64 {
    u64::try_from(duration.as_micros()).unwrap_or(u64::MAX)
}

/// Time between two warnings.
const WARNING_INTERVAL: Duration = Duration::from_secs(1);

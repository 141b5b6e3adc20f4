//! The results of a run.

use std::fmt;
use std::process::ExitCode;

/// Counts, worst cases and failures.
#[derive(Default)]
pub(crate) struct SoakReport {
    pub(crate) replans: u64,
    /// Number of plans by generators that only knew the state.
    pub(crate) anew: u64,
    pub(crate) cycles: u64,
    pub(crate) arrivals: u64,
    /// Number of plans whose duration was compared with the plain search.
    pub(crate) optima: u64,
    pub(crate) velocity: Worst,
    pub(crate) acceleration: Worst,
    pub(crate) jerk: Worst,
    /// Excess of the duration over the optimum, relative.
    pub(crate) slower: Worst,
    /// Cycles after the arrival time of the last plan.
    pub(crate) late: Worst,
    /// Distance from the target at the end of the motion, relative to the size of the motion.
    pub(crate) landing: Worst,
    /// Overshoot beyond a target that can be reached without it, relative to the size of the
    /// motion.
    pub(crate) overshoot: Worst,
    pub(crate) failures: Vec<String>,
}

/// The largest of some values, and its seed.
#[derive(Clone, Copy)]
pub(crate) struct Worst {
    value: f64,
    seed: u64,
}

impl Default for Worst {
    fn default() -> Self {
        Self {
            value: f64::NEG_INFINITY,
            seed: 0,
        }
    }
}

impl Worst {
    pub(crate) fn see(&mut self, value: f64, seed: u64) {
        if value > self.value {
            *self = Self { value, seed };
        }
    }
}

impl SoakReport {
    pub(crate) fn outcome(&self) -> ExitCode {
        if self.failures.is_empty() {
            ExitCode::SUCCESS
        } else {
            ExitCode::FAILURE
        }
    }
}

impl fmt::Display for SoakReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} plans, {} of them anew from the state alone, {} cycles, {} arrivals, {} durations compared with the optimum",
            self.replans, self.anew, self.cycles, self.arrivals, self.optima
        )?;
        for (name, worst) in [
            ("velocity over its limit, relative", self.velocity),
            ("acceleration over its limit, relative", self.acceleration),
            ("jerk over its limit, relative", self.jerk),
            ("duration over the optimum, relative", self.slower),
            ("arrival behind the promised one, cycles", self.late),
            ("landing error, relative", self.landing),
            ("overshoot of a reachable target, relative", self.overshoot),
        ] {
            writeln!(f, "{name:<44} {:>10.1e}   seed {}", worst.value, worst.seed)?;
        }
        for failure in &self.failures {
            writeln!(f, "FAILED {failure}")?;
        }
        write!(f, "{} failures", self.failures.len())
    }
}

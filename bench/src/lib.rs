//! Measures the cost of one control cycle.
//!
//! ```text
//! round 1: decode, encode, cycle, ...   -> percentiles of each
//! round 2: decode, encode, cycle, ...   -> percentiles of each
//!   ...                                 -> median over the rounds -> flat keys
//! ```
//! Every round runs every benchmark once. A temporary disturbance of the machine then affects one
//! round of all benchmarks instead of one benchmark, and the median over the rounds excludes it.
//! Inputs are seeded and vary from call to call, so that the branch predictor cannot learn one
//! input.
//!
//! | module | subject |
//! |---|---|
//! | [`codec`] | decoding a state, encoding a command |
//! | [`collision`] | distances of the arm to itself, with gradients |
//! | [`contact`] | the place of a contact, from external torques |
//! | [`cycle`] | target control, datagram in to datagram out |
//! | [`figures`] | no benchmark: statistics for the programs |
//! | [`guarded`] | the same with every guard on, for each kind of goal |
//! | [`inverse`] | all postures of a pose, joint velocities in a box |
//! | [`mod@line`] | the decision about a straight line to a pose |
//! | [`model`] | the five quantities of a law, one by one and in one pass |
//! | [`otg`] | a new target for axes in motion |
//! | [`record`] | bytes and processor time of a recording, in virtual time |
//! | [`shape`] | filter, limiter and check of torques and of a pose |
//! | [`sim`] | the simulator under target control, in virtual time |
//! | [`supervisor`] | the time until a supervised robot accepts motions again, over sockets |

use std::collections::BTreeMap;
use std::time::Instant;

pub mod codec;
pub mod collision;
pub mod contact;
pub mod cycle;
pub mod figures;
pub mod guarded;
pub mod inverse;
pub mod line;
pub mod model;
pub mod otg;
pub mod record;
pub mod shape;
pub mod sim;
mod subject;
pub mod supervisor;

pub use subject::Subject;

/// A benchmark.
pub struct Benchmark {
    /// First part of its keys, including the unit; a statistic follows: `otg.replan_7_ns` gives
    /// `otg.replan_7_ns_p50`. [`Statistic::RealTime`] adds nothing.
    pub key: &'static str,
    /// The reported statistics of a round.
    pub statistics: &'static [Statistic],
    /// Runs one round and returns the time of each call, in the unit of the key; never empty.
    pub round: Box<dyn FnMut() -> Vec<u64>>,
}

/// A statistic of the samples of one round.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Statistic {
    /// Median.
    P50,
    /// The value that 99 of 100 samples do not exceed.
    P99,
    /// The largest sample.
    Max,
    /// The speed relative to real time: a millisecond divided by the median time to simulate it.
    RealTime,
}

impl Statistic {
    /// Returns the last part of a key.
    pub fn suffix(self) -> &'static str {
        match self {
            Self::P50 => "_p50",
            Self::P99 => "_p99",
            Self::Max => "_max",
            Self::RealTime => "",
        }
    }

    /// Returns the statistic of samples in ascending order; at least one sample is required.
    fn of(self, sorted: &[u64]) -> u64 {
        let last = sorted.len() - 1;
        match self {
            Self::P50 => sorted[last / 2],
            Self::P99 => sorted[last * 99 / 100],
            Self::Max => sorted[last],
            Self::RealTime => 1_000_000 / sorted[last / 2].max(1),
        }
    }
}

/// Returns all benchmarks of the project.
pub fn all() -> Vec<Benchmark> {
    [
        codec::all(),
        collision::all(),
        contact::all(),
        cycle::all(),
        guarded::all(),
        inverse::all(),
        line::all(),
        model::all(),
        otg::all(),
        shape::all(),
        sim::all(),
        supervisor::all(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Returns the calls whose instructions can be counted: the calls of the model, and the guarded
/// cycle.
pub fn subjects() -> Vec<Subject> {
    let mut subjects = model::subjects();
    subjects.extend(inverse::subjects());
    subjects.extend(guarded::subjects());
    subjects
}

/// Runs `rounds` interleaved rounds, at least one, and returns the median of each statistic over
/// them.
pub fn measure(benchmarks: &mut [Benchmark], rounds: usize) -> BTreeMap<String, u64> {
    let mut values: BTreeMap<String, Vec<u64>> = BTreeMap::new();
    for _ in 0..rounds.max(1) {
        for benchmark in &mut *benchmarks {
            let mut samples = (benchmark.round)();
            samples.sort_unstable();
            for statistic in benchmark.statistics {
                let key = format!("{}{}", benchmark.key, statistic.suffix());
                values.entry(key).or_default().push(statistic.of(&samples));
            }
        }
    }
    let median = |mut values: Vec<u64>| {
        values.sort_unstable();
        Statistic::P50.of(&values)
    };
    values
        .into_iter()
        .map(|(key, values)| (key, median(values)))
        .collect()
}

/// Times `samples` batches of `batch` calls each and returns the mean of each batch, in
/// nanoseconds. Reading the clock costs about as much as encoding a command. Calls below a
/// microsecond need a batch, whose percentiles above the median then mean little.
pub fn timed(samples: usize, batch: u32, mut call: impl FnMut()) -> Vec<u64> {
    let sample = |_| {
        let start = Instant::now();
        for _ in 0..batch {
            call();
        }
        let nanoseconds = start.elapsed().as_nanos() / u128::from(batch);
        u64::try_from(nanoseconds).unwrap_or(u64::MAX)
    };
    (0..samples).map(sample).collect()
}

/// Inputs for a benchmark, used in turn and cyclically; at least one.
struct Inputs<T> {
    list: Vec<T>,
    next: usize,
}

impl<T> Inputs<T> {
    fn new(inputs: impl Iterator<Item = T>) -> Self {
        let list = inputs.collect();
        Self { list, next: 0 }
    }

    fn next(&mut self) -> &T {
        let index = self.next;
        self.next = (index + 1) % self.list.len();
        &self.list[index]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_the_median_over_rounds_of_a_percentile_of_each() {
        let mut round = 0;
        let mut benchmarks = [Benchmark {
            key: "x_ns",
            statistics: &[Statistic::P50, Statistic::P99, Statistic::Max],
            round: Box::new(move || {
                round += 1;
                // The third round is disturbed.
                let factor = if round == 3 { 1000 } else { round };
                (1..=201).rev().map(|sample| factor * sample).collect()
            }),
        }];
        let values = measure(&mut benchmarks, 3);
        let expected = [("x_ns_max", 402), ("x_ns_p50", 202), ("x_ns_p99", 398)];
        let expected = expected.map(|(key, value)| (key.to_owned(), value));
        assert_eq!(values, BTreeMap::from(expected));
    }

    #[test]
    fn every_benchmark_has_samples_and_unique_keys() {
        let mut benchmarks = all();
        let values = measure(&mut benchmarks, 1);
        let keys: usize = benchmarks.iter().map(|b| b.statistics.len()).sum();
        assert_eq!(values.len(), keys);
        assert!(values.values().all(|&value| value > 0), "{values:?}");
    }
}

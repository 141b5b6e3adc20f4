//! One call to measure, in time or in instructions.

use std::hint::black_box;

use super::{Benchmark, Inputs, Statistic, timed};

/// A call to measure, with its next input each time.
pub struct Subject {
    /// The key, as in [`Benchmark`].
    pub key: &'static str,
    /// The functions whose instructions count, as patterns of callgrind; if empty, all instructions
    /// count. None of them may call another one.
    pub within: &'static [&'static str],
    /// Makes one call.
    pub call: Box<dyn FnMut()>,
}

impl Subject {
    /// Calls `function` with `inputs`, in turn and cyclically.
    pub(super) fn new<T: 'static, Output>(
        key: &'static str,
        mut inputs: Inputs<T>,
        mut function: impl FnMut(&T) -> Output + 'static,
    ) -> Self {
        Self {
            key,
            within: &[],
            call: Box::new(move || {
                black_box(function(black_box(inputs.next())));
            }),
        }
    }

    /// Converts to a benchmark of the median time of a call.
    pub(super) fn p50(mut self) -> Benchmark {
        Benchmark {
            key: self.key,
            statistics: &[Statistic::P50],
            round: Box::new(move || timed(SAMPLES, BATCH, &mut self.call)),
        }
    }
}

const SAMPLES: usize = 400;
const BATCH: u32 = 16;

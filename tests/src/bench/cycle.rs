//! The whole cycle of target control, datagram in to datagram out, without the sockets.

use std::time::Instant;

use crate::bench::{Benchmark, Statistic};
use crate::lockstep::Wander;

/// Cycles in a round: ten seconds of an arm sent about.
const CYCLES: usize = 10_000;

/// A state decoded, answered by target control and the answer encoded.
pub fn all() -> Vec<Benchmark> {
    let mut wander = Wander::new(1);
    vec![Benchmark {
        key: "rt.cycle_ns",
        statistics: &[Statistic::P50, Statistic::P99, Statistic::Max],
        round: Box::new(move || {
            let mut samples = Vec::with_capacity(CYCLES);
            while samples.len() < CYCLES {
                wander.tick_around(|cycle| {
                    let start = Instant::now();
                    cycle();
                    samples.push(start.elapsed().as_nanos() as u64);
                });
            }
            samples
        }),
    }]
}

//! Measures a new target for axes in motion, and the first step towards it: the longest work of the
//! generator in one cycle. Run it with `cargo bench -p franka-otg`. Compare two versions by
//! alternating runs.

mod cases;

use franka_otg::AxisLimits;

use cases::{Case, Cases, shortest};

fn main() {
    replan::<1>();
    replan::<3>();
    replan::<7>();
}

/// Prints the median, the 99th percentile and the maximum of the nanoseconds per state.
fn replan<const N: usize>() {
    let cases: Vec<Case<N>> = Cases::new(|_, _| LIMITS).take(STATES).collect();
    let mut shortest = shortest(&cases, SWEEPS);
    shortest.sort_unstable();
    let part = |part: f64| shortest[((shortest.len() - 1) as f64 * part) as usize];
    println!(
        "{N} axes: {} ns median, {} ns p99, {} ns largest of {STATES} states",
        part(0.5),
        part(0.99),
        part(1.0)
    );
}

/// Limits similar to an arm's joint.
const LIMITS: AxisLimits = AxisLimits {
    velocity: 2.62,
    acceleration: 10.0,
    jerk: 5000.0,
};

const STATES: usize = 20_000;
const SWEEPS: usize = 10;

//! A new target for axes in motion, and the first step towards it: the most that the generator does
//! in one cycle. `cargo bench -p franka-otg`.
//!
//! States are taken from random motions. Each sweep measures every state once, so that no branch
//! predictor learns a state, and a state counts with its shortest time over the sweeps: the longer
//! ones are those in which something else ran. Compare two versions by alternating runs.

use std::hint::black_box;
use std::time::Instant;

use franka_otg::{Generator, Limits, State, Synchronisation};
use rand::rngs::SmallRng;
use rand::{Rng, SeedableRng};

fn main() {
    replan::<1>();
    replan::<3>();
    replan::<7>();
}

/// Prints median, 99th percentile and largest of the nanoseconds per state.
fn replan<const N: usize>() {
    let cases = cases::<N>();
    let mut shortest = vec![u128::MAX; cases.len()];
    for _ in 0..SWEEPS {
        for ((generator, target), shortest) in cases.iter().zip(&mut shortest) {
            let mut generator = generator.clone();
            let start = Instant::now();
            let planned = generator.set_target(black_box(target));
            black_box(generator.step());
            *shortest = (*shortest).min(start.elapsed().as_nanos());
            planned.expect("the target is finite and in reach");
        }
    }
    shortest.sort_unstable();
    let part = |part: f64| shortest[((shortest.len() - 1) as f64 * part) as usize];
    println!(
        "{N} axes: {} ns median, {} ns p99, {} ns largest of {STATES} states",
        part(0.5),
        part(0.99),
        part(1.0)
    );
}

/// Generators in motion, before, in and after the phase of constant velocity, and the next target
/// of each. Limits are those of an arm's joints.
fn cases<const N: usize>() -> Vec<(Generator<N>, [f64; N])> {
    let mut random = SmallRng::seed_from_u64(3);
    let limits = Limits::from_arrays([2.62; N], [10.0; N], [5000.0; N]).expect("valid limits");
    let mut generator = Generator::new(State::at_rest([0.0; N]), limits)
        .expect("a start at rest is valid")
        .with_synchronisation(Synchronisation::Time);
    let case = |_| {
        let target = std::array::from_fn(|_| random.random_range(-2.0..2.0));
        let case = (generator.clone(), target);
        generator.set_target(&target).expect("the target is finite");
        let into = random.random_range(0.0..1.0) * generator.remaining();
        let state = generator.sample(into);
        generator.set_state(state).expect("the state is its own");
        case
    };
    (0..STATES).map(case).collect()
}

const STATES: usize = 20_000;
const SWEEPS: usize = 10;

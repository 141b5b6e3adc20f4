//! The trajectory generator, for targets of all kinds.

use std::hint::black_box;

use franka_otg::{CYCLE, Generator, Limits, State, Synchronisation};
use rand::{Rng, SeedableRng, rngs::SmallRng};

#[test]
fn plans_and_cycles_never_call_the_allocator() {
    let limits = |pace: f64| {
        Limits::from_arrays([2.0 * pace; 7], [10.0 * pace; 7], [5000.0 * pace; 7]).unwrap()
    };
    let (mut random, mut planned) = (SmallRng::seed_from_u64(7), 0);
    let before = crate::calls();
    for synchronisation in [Synchronisation::Time, Synchronisation::Straight] {
        let mut generator = Generator::new(State::at_rest([0.0; 7]), limits(1.0))
            .unwrap()
            .with_synchronisation(synchronisation);
        for k in 0..50_000 {
            let target = State {
                position: core::array::from_fn(|_| random.random_range(-1.0..1.0)),
                velocity: core::array::from_fn(|_| random.random_range(-1.0..1.0)),
                acceleration: [0.0; 7],
            };
            match k % 10 {
                0..5 => generator.set_target(&target.position).unwrap(),
                5..8 => generator.set_moving_target(&target).unwrap(),
                8 => generator.brake(),
                _ => {
                    generator
                        .set_limits(limits(random.random_range(1.2..1.8)))
                        .unwrap();
                    let now = *generator.state();
                    generator.set_state(now).unwrap();
                }
            }
            planned += 1;
            black_box(generator.sample(0.1));
            for _ in 0..k % 40 {
                black_box(generator.step());
            }
            black_box((generator.time_to_target() / CYCLE, generator.remaining()));
        }
    }
    assert_eq!(
        crate::calls() - before,
        0,
        "calls of the allocator in {planned} plans"
    );
}

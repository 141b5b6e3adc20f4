//! The trajectory generator, for targets of all kinds.

use std::hint::black_box;

use franka_otg::{CYCLE, Generator, Limits, State, Synchronisation};

/// A pseudo-random number in -1..1 (an LCG with the constants of MMIX).
fn next(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

#[test]
fn a_hundred_thousand_plans_and_cycles_allocate_and_free_nothing() {
    let limits = |pace: f64| {
        Limits::from_arrays([2.0 * pace; 7], [10.0 * pace; 7], [5000.0 * pace; 7]).unwrap()
    };
    let (mut seed, mut planned) = (7, 0);
    let before = crate::calls();
    for synchronisation in [Synchronisation::Time, Synchronisation::Straight] {
        let mut generator = Generator::new(State::at_rest([0.0; 7]), limits(1.0))
            .unwrap()
            .with_synchronisation(synchronisation);
        for k in 0..50_000 {
            let target = State {
                position: core::array::from_fn(|_| next(&mut seed)),
                velocity: core::array::from_fn(|_| next(&mut seed)),
                acceleration: [0.0; 7],
            };
            match k % 10 {
                0..5 => generator.set_target(&target.position).unwrap(),
                5..8 => generator.set_moving_target(&target).unwrap(),
                8 => generator.brake(),
                _ => {
                    generator
                        .set_limits(limits(1.5 + 0.3 * next(&mut seed)))
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

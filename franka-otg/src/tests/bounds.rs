//! Compares the passes of the searches with their bounds.

use super::allowed::beside_one_that_takes;
use super::random::stop_point;
use crate::{AxisLimits, AxisState, Generator, Limits, Synchronisation, search_passes};

/// Returns the largest number of passes, in percent of the bound, for motions from `state` to
/// `target` together with an axis that takes `stretch` times as long.
fn passes(limits: AxisLimits, state: AxisState, target: AxisState, stretch: f64) -> usize {
    let alone = Limits::per_axis([limits]).unwrap();
    let mut generator = Generator::new(super::random::one(state), alone).unwrap();
    let one = super::random::one(target);
    generator.set_moving_target(&one).unwrap();
    let duration = stretch * generator.time_to_target();
    if duration > 0.0 {
        let (limits, state, target) = beside_one_that_takes(duration, limits, state, target);
        Generator::new(state, limits)
            .unwrap()
            .with_synchronisation(Synchronisation::Time)
            .set_moving_target(&target)
            .unwrap();
    }
    search_passes::take_most()
}

#[test]
fn no_search_on_a_grid_comes_near_its_ceiling() {
    let mut most = 0;
    for top in [1e-6, 1e-3, 0.03, 0.3, 1.0, 3.0, 30.0, 1e3, 1e6] {
        let limits = AxisLimits {
            velocity: top,
            acceleration: 1.0,
            jerk: 1.0,
        };
        for speed in [-1.0, -0.5, -1e-9, 0.0, 1e-6, 0.3, 0.999_999, 1.0] {
            for bend in [-1.0, -0.6, -1e-9, 0.0, 1e-3, 0.8, 1.0] {
                let room = f64::sqrt(2.0 * top * (1.0 - f64::abs(speed)));
                let state = AxisState {
                    position: 0.0,
                    velocity: top * speed,
                    acceleration: bend * room.min(1.0),
                };
                let stop = stop_point(limits, state);
                let scale = top * (1.0 + top.min(1.0));
                for distance in [1e-15, 1e-9, 1e-4, 0.1, 0.9, 1.0, 10.0, 1e4] {
                    for side in [-1.0, 1.0] {
                        for moves in [0.0, 1e-9, 0.4, 1.0, -0.7] {
                            let target = AxisState {
                                position: stop + side * distance * scale,
                                velocity: moves * top,
                                acceleration: 0.0,
                            };
                            for stretch in [1.0 + 1e-9, 1.01, 1.2, 3.0] {
                                most = most.max(passes(limits, state, target, stretch));
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(most > 3, "the searches are counted");
    assert!(most <= 80, "a search takes {most} % of the passes it may");
}

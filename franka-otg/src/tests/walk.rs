//! Walks along a motion and checks it: it is inside its limits, and each state follows from the
//! previous one.

use crate::{Generator, Limits, State};

/// Relative excess over a limit that counts as rounding.
pub(super) const EXACT: f64 = 1e-9;

/// Relative error of a position that counts as rounding, including the instants at which the jerk
/// changes. The largest error seen was 2e-13, with limits from 1e-3 to 1e6.
const ROUNDING: f64 = 1e-12;

/// Relative error of the jerk between two states. The instants at which the jerk changes are
/// rounded, which affects the jerk directly. The largest errors seen were 3.6e-10 in ten million
/// plans, and 1.1e-8 with a new plan in each cycle.
const JERK: f64 = 1e-7;

/// Checks the step of one axis from one state to another, `dt` later.
///
/// `size` is the magnitude of the positions, whose rounding does not count as motion.
#[track_caller]
pub(super) fn check_step<const N: usize>(
    limits: &Limits<N>,
    before: &State<N>,
    after: &State<N>,
    dt: f64,
    size: f64,
) {
    for i in 0..N {
        let (l, p, q) = (limits.axis(i), before.axis(i), after.axis(i));
        let velocity = p.velocity.abs().max(q.velocity.abs());
        let acceleration = p.acceleration.abs().max(q.acceleration.abs());
        let jerk = (q.acceleration - p.acceleration).abs() / dt;
        assert!(
            velocity <= l.velocity * (1.0 + EXACT),
            "axis {i}: velocity {velocity} of {}",
            l.velocity
        );
        assert!(
            acceleration <= l.acceleration * (1.0 + EXACT),
            "axis {i}: acceleration {acceleration} of {}",
            l.acceleration
        );
        let rounding = 4.0 * f64::EPSILON * l.acceleration / dt;
        assert!(
            jerk <= l.jerk * (1.0 + JERK) + rounding,
            "axis {i}: jerk {jerk} of {}",
            l.jerk
        );
        // The error of a trapezoid is bounded by the limit of the next derivative.
        let dv = 0.5 * dt * (p.acceleration + q.acceleration);
        let bound = 0.25 * l.jerk * dt * dt * (1.0 + EXACT) + 8.0 * f64::EPSILON * l.velocity;
        let gap = (q.velocity - p.velocity - dv).abs();
        assert!(
            gap <= bound,
            "axis {i}: velocity off by {gap}, {bound} allowed"
        );
        let dp = 0.5 * dt * (p.velocity + q.velocity);
        let bound = 0.25 * l.acceleration * dt * dt * (1.0 + EXACT) + ROUNDING * size;
        let gap = (q.position - p.position - dp).abs();
        assert!(
            gap <= bound,
            "axis {i}: position off by {gap}, {bound} allowed"
        );
    }
}

/// Checks the current motion from now to its end, at `samples` instants.
#[track_caller]
pub(super) fn check_motion<const N: usize>(generator: &Generator<N>, samples: usize) {
    let size = generator
        .state()
        .position
        .iter()
        .chain(generator.target())
        .chain(generator.end())
        .fold(0.0_f64, |size, p| size.max(p.abs()));
    let dt = generator.remaining() / samples as f64;
    let mut before = *generator.state();
    for k in 1..=samples {
        let after = generator.sample(dt * k as f64);
        check_step(generator.limits(), &before, &after, dt, size);
        before = after;
    }
    assert_eq!(
        generator.sample(generator.remaining() + dt),
        State::at_rest(*generator.end())
    );
}

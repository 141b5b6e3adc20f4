//! Step two: a profile with exactly a given duration, which is not below the least duration.
//!
//! For targets at rest, two families with one parameter each are enough.
//!
//! **Velocity cap.** The motion is a transfer to a velocity `w`, a cruise and a stop. Eliminating
//! the cruise from the equations of time and distance leaves one equation for `w`, without a
//! division by `w`. Let `c, pi` be the start, extended to zero acceleration as in step one, and let
//! `A(d)` be the area of [`stop_distance`](crate::transfer::stop_distance). In the upward case, `w`
//! is at or above the velocity that remains when the acceleration is ramped to zero. The equation
//! is then
//!
//! ```text
//! g(w) = A(w - c) + A(w) - (T + a) w + d - pi = 0
//! ```
//!
//! In the downward case, it is `A(w) - A(c - w) - (T - a) w + d - pi = 0`, where `c, pi` belong to
//! a negative first jerk. `g` is convex or monotone as long as the cruise is not negative. If both
//! transfers hold their acceleration, the equation is quadratic or linear. The cruise follows from
//! the equation of time. Therefore the duration is exact, and rounding affects only the position,
//! where its effect is smallest.
//!
//! **Stop, then go.** Used if no cruise fits; see [`crate::stop_then_go`].
//!
//! Two other methods are not suitable. Scaling the time of the whole profile would change the
//! velocity at the start. Lowering all three limits together makes the duration discontinuous where
//! the start leaves the limits.

use crate::least_time::LeastTime;
use crate::scalar::sqrt;
use crate::shape::{Shape, Stretched};
use crate::stop_then_go::stop_then_go;
use crate::task::{SAME, Task};
use crate::transfer::{ramp_and_hold, stop_distance_and_slope, transfer_time};

/// Stretches a least-time solution to `duration`, in units of the axis. A solution that already
/// takes longer does not change.
pub(crate) fn stretched(least: &LeastTime, duration: f64) -> Stretched {
    if duration - least.duration <= SAME * duration {
        return Stretched::of(least.shape);
    }
    match velocity_cap(&least.task, least.shape.cruise, duration) {
        Some(shape) => Stretched::of(shape),
        None => stop_then_go(least, duration),
    }
}

/// Returns a transfer, a cruise and a stop, or `None` if no cruise fits.
fn velocity_cap(task: &Task, peak: f64, duration: f64) -> Option<Shape> {
    let coasting = task.coasting_velocity();
    let low = coasting.max(0.0);
    let up = Cap::new(task, duration, 1.0);
    if up.excess(low).0 >= 0.0 {
        let w = up.solve(low, peak.max(low));
        return up.shape(task.a, w);
    }
    let down = Cap::new(task, duration, -1.0);
    let w = down.solve(0.0, low);
    down.shape(task.a, w)
}

/// The equation of the velocity cap for one sign of the first jerk.
struct Cap {
    sign: f64,
    /// Start velocity, extended to zero acceleration.
    c: f64,
    /// Distance from the extended start.
    d: f64,
    /// Duration from the extended start.
    time: f64,
}

impl Cap {
    fn new(task: &Task, duration: f64, sign: f64) -> Self {
        let Task { d, v, a, .. } = *task;
        Self {
            sign,
            c: v - sign * 0.5 * a * a,
            d: d - a * (a * a / 3.0 - sign * v),
            time: duration + sign * a,
        }
    }

    /// Returns the distance that is still missing after `time` with cruise velocity `w`, and the
    /// derivative of this distance.
    fn excess(&self, w: f64) -> (f64, f64) {
        let (first, first_slope) = stop_distance_and_slope((self.sign * (w - self.c)).max(0.0));
        let (second, second_slope) = stop_distance_and_slope(w);
        (
            self.sign * first + second - self.time * w + self.d,
            first_slope + second_slope - self.time,
        )
    }

    /// Returns the root of the excess between `low` and `high`. The excess is not negative at `low`
    /// and not positive at `high`.
    fn solve(&self, low: f64, high: f64) -> f64 {
        let (mut low, mut high) = (low, high);
        let guess = self.with_holds();
        if guess >= low && guess <= high && guess >= 1.0 && self.sign * (guess - self.c) >= 1.0 {
            return guess;
        }
        let mut w = if guess >= low && guess <= high {
            guess
        } else {
            0.5 * (low + high)
        };
        for _ in 0..MAX_STEPS {
            let (excess, slope) = self.excess(w);
            if excess > 0.0 {
                low = w;
            } else {
                high = w;
            }
            let newton = w - excess / slope;
            let next = if newton > low && newton < high {
                newton
            } else if excess == 0.0 {
                return w;
            } else {
                0.5 * (low + high)
            };
            if (next - w).abs() <= 2.0 * f64::EPSILON * w {
                return next;
            }
            w = next;
        }
        w
    }

    /// Returns the root for the case that both transfers hold their acceleration. The equation is
    /// quadratic in the upward case and linear in the downward case.
    fn with_holds(&self) -> f64 {
        let c = self.c;
        if self.sign > 0.0 {
            let half = 0.5 * (self.time + c - 1.0);
            let q = 0.5 * c * (c - 1.0) + self.d;
            q / (half + sqrt((half * half - q).max(0.0)))
        } else {
            (self.d - 0.5 * c * (c + 1.0)) / (self.time - c - 1.0)
        }
    }

    /// Returns the profile with cruise velocity `w`, or `None` if its cruise would be negative.
    fn shape(&self, a: f64, w: f64) -> Option<Shape> {
        let first = (self.sign * (w - self.c)).max(0.0);
        let cruise = self.time - transfer_time(first) - transfer_time(w);
        if cruise < 0.0 {
            return None;
        }
        let shape = Shape::two_transfers(
            self.sign * a,
            ramp_and_hold(first),
            (w, cruise),
            ramp_and_hold(w),
        );
        Some(Shape {
            first: self.sign,
            ..shape
        })
    }
}

/// Largest number of steps of the search. Bisection alone needs about 53 steps.
const MAX_STEPS: usize = 60;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::least_time::least_time;

    /// Follows a solution. Returns its duration, the remaining task at its end, and the largest
    /// acceleration, velocity and distance beyond the target between segments.
    fn follow(task: &Task, solution: &Stretched) -> (f64, Task, f64, f64, f64) {
        let Stretched {
            before,
            sign,
            shape,
        } = *solution;
        let first = shape.first * sign;
        let jerks = [first, 0.0, -first, 0.0, -sign, 0.0, sign];
        let segments = jerks.into_iter().zip(shape.t);
        let cruise = before.iter().count() + 3;
        let (mut left, mut duration, mut a, mut v, mut beyond) =
            (*task, 0.0, 0.0_f64, 0.0_f64, 0.0_f64);
        for (i, (jerk, t)) in before.iter().chain(segments).enumerate() {
            assert!(t >= 0.0);
            if i == cruise && t > 0.0 {
                // As in profiles, a rounding error that remains would grow with the square of the
                // cruise's duration.
                left.v = sign * shape.cruise;
                left.a = 0.0;
            }
            duration += t;
            left = left.after(jerk, t);
            a = a.max(left.a.abs());
            v = v.max(left.v.abs());
            beyond = beyond.max(-left.d);
        }
        (duration, left, a, v, beyond)
    }

    /// Generates a start inside its limits, with a target whose distance from the stop point is
    /// usually small.
    fn task() -> impl Strategy<Value = Task> {
        let distance = prop_oneof![1 => -5.0..-1.0, 1 => -1.0..2.0];
        let sign = prop_oneof![Just(1.0), Just(-1.0)];
        (-1.5..2.5, -1.0..1.0, -1.0..1.0, distance, sign).prop_map(
            |(exponent, coasting, bend, distance, sign): (f64, f64, f64, f64, f64)| {
                let top = 10_f64.powf(exponent);
                let room = (2.0 * top * (1.0 + coasting * bend.signum())).sqrt();
                let a = bend * room.min(1.0);
                let task = Task {
                    d: 0.0,
                    v: top * coasting - 0.5 * a * a.abs(),
                    a,
                    top,
                    fuzz: 0.0,
                };
                let scale = top * (1.0 + top.min(1.0));
                Task {
                    d: task.stop_point().0 + sign * scale * 10_f64.powf(distance),
                    ..task
                }
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(5000) })]

        #[test]
        fn every_longer_duration_has_a_profile(task in task(), exponent in -5.0..0.7) {
            let least = least_time(task);
            let duration = least.duration * (1.0 + 10_f64.powf(exponent));
            let solution = stretched(&least, duration);
            let (lasts, left, a, v, beyond) = follow(&least.task, &solution);
            let size = task.d.abs() + task.top * duration;
            // Near a stop point, a rounding error of the position changes the time by its square
            // root.
            let rounding = f64::EPSILON * size;
            let slack = 1e-13 * duration + 2.0 * rounding.sqrt();
            let waits = duration - lasts;
            prop_assert!(waits >= -slack, "{waits} of {duration}: {solution:?}");
            prop_assert!(waits <= slack, "{waits} of {duration}: {solution:?}");
            let avoidable = least.task.d >= 0.0 && least.task.coasting_velocity() >= 0.0;
            prop_assert!(!avoidable || beyond <= 64.0 * rounding, "overshoots by {beyond}: {solution:?}");
            prop_assert!(left.d.abs() <= 64.0 * rounding, "{} missing of {size}", left.d);
            prop_assert!(left.v.abs() <= 1e-12 * (1.0 + task.top) && left.a.abs() <= 1e-12);
            prop_assert!(a <= 1.0 + 1e-12 && v <= task.top * (1.0 + 1e-12), "{a} {v}");
        }
    }

    #[test]
    fn an_axis_braking_into_a_near_target_stops_first() {
        let task = Task {
            d: 0.0,
            v: 2.0,
            a: -0.9,
            top: 10.0,
            fuzz: 0.0,
        };
        let stop = task.stop_point().0;
        let least = least_time(Task {
            d: stop + 1e-3,
            ..task
        });
        for factor in [1.001, 1.01, 1.02, 1.03] {
            let duration = factor * least.duration;
            assert!(velocity_cap(&least.task, least.shape.cruise, duration).is_none());
            let solution = stretched(&least, duration);
            let (lasts, left, _, _, beyond) = follow(&least.task, &solution);
            assert!(
                (lasts - duration).abs() < 1e-13 * duration,
                "{factor}: {lasts}"
            );
            assert!(
                left.d.abs() < 1e-14 && beyond < 1e-14,
                "{factor}: {solution:?}"
            );
        }
    }

    #[test]
    fn a_stop_point_can_be_waited_at() {
        let task = Task {
            d: 0.0,
            v: 2.0,
            a: 0.3,
            top: 10.0,
            fuzz: 1e-15,
        };
        let least = least_time(Task {
            d: task.stop_point().0,
            ..task
        });
        let solution = stretched(&least, 10.0 * least.duration);
        let (lasts, left, ..) = follow(&least.task, &solution);
        assert!((lasts - 10.0 * least.duration).abs() < 1e-12 * lasts);
        assert!(left.d.abs() < 1e-12 && left.v.abs() < 1e-12);
    }
}

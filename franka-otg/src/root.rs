//! Bracketed search for the root of a continuous function.

use crate::search_passes;

/// A point and the value of the function at the point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    pub(crate) at: f64,
    pub(crate) value: f64,
}

/// Finds a zero of `function` between two points at which it has different signs.
///
/// The method is Chandrupatla's: inverse quadratic interpolation if three points allow it,
/// otherwise bisection (T. R. Chandrupatla, Advances in Engineering Software 28(3), 1997). The
/// search ends when a value is at most `close`, when `f64` cannot resolve a narrower bracket, or
/// after [`MAX_STEPS`].
pub(crate) fn root(
    low: Point,
    high: Point,
    close: f64,
    mut function: impl FnMut(f64) -> f64,
) -> f64 {
    // `a` and `b` bracket the root, `a` is the newest point, and `c` is the point replaced by `a`
    // or `b`.
    let (mut a, mut b) = (low, high);
    let mut part = 0.5_f64;
    for pass in 0..MAX_STEPS {
        search_passes::count(pass, MAX_STEPS);
        let best = nearer(a, b);
        let width = (b.at - a.at).abs();
        let resolution = 2.0 * f64::EPSILON * best.at.abs() / width;
        // If the width is zero, the resolution is infinite. If the root is also zero, the
        // resolution is NaN.
        if best.value.abs() <= close || resolution >= 0.5 || resolution.is_nan() {
            return best.at;
        }
        let at = a.at + part.clamp(resolution, 1.0 - resolution) * (b.at - a.at);
        let next = Point {
            at,
            value: function(at),
        };
        let c = if (next.value > 0.0) == (a.value > 0.0) {
            a
        } else {
            core::mem::replace(&mut b, a)
        };
        a = next;
        part = interpolate(a, b, c);
    }
    nearer(a, b).at
}

fn nearer(a: Point, b: Point) -> Point {
    if a.value.abs() < b.value.abs() { a } else { b }
}

/// Returns the position of the root between `a` and `b`, as a fraction, from the parabola through
/// three points. Returns `None` if this parabola is not monotone between them.
fn interpolate(a: Point, b: Point, c: Point) -> f64 {
    let (fa, fb, fc) = (a.value, b.value, c.value);
    let xi = (a.at - b.at) / (c.at - b.at);
    let phi = (fa - fb) / (fc - fb);
    if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
        fa / (fb - fa) * fc / (fb - fc)
            + (c.at - a.at) / (b.at - a.at) * fa / (fc - fa) * fb / (fc - fb)
    } else {
        0.5
    }
}

/// Largest number of steps of a search. Ten steps are usual. If interpolation does not help, the
/// method falls back to bisection. Bisection alone needs 53 steps from any bracket within a factor
/// of two of the root.
const MAX_STEPS: usize = 100;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_flat_and_kinked_functions_are_solved_to_rounding() {
        type Case = (fn(f64) -> f64, f64);
        let functions: [Case; 4] = [
            (|x| x * x * x - 2.0, 2_f64.cbrt()),
            (|x| (x - 1.25).powi(3), 1.25),
            (
                |x| {
                    if x < 0.7 {
                        1e6 * (x - 0.7)
                    } else {
                        1e-6 * (x - 0.7)
                    }
                },
                0.7,
            ),
            (|x| (x - 1.9).abs().sqrt().copysign(x - 1.9), 1.9),
        ];
        for (function, expected) in functions {
            let point = |at| Point {
                at,
                value: function(at),
            };
            let mut calls = 0;
            let found = root(point(0.0), point(2.0), 0.0, |x| {
                calls += 1;
                function(x)
            });
            assert!((found - expected).abs() <= 1e-5, "{found} for {expected}");
            assert!(function(found).abs() <= 1e-7, "{found} for {expected}");
            assert!(calls < MAX_STEPS, "{calls} for {expected}");
        }
    }
}

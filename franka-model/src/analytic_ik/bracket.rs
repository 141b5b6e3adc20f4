//! Roots of a smooth function between its samples. Points are `(x, f(x))`.

/// Returns the root between two points with values of opposite signs, to the last digits of x.
///
/// The method is false position. If the same end of the interval remains twice, its value is halved
/// (the Illinois variant: Dowell and Jarratt, 1971). Every third step is a bisection, which bounds
/// the number of steps.
pub(super) fn root(
    f: impl Fn(f64) -> f64,
    (mut a, mut fa): (f64, f64),
    (mut b, mut fb): (f64, f64),
) -> f64 {
    let mut stayed = 0;
    for step in 0..STEPS_MAX {
        let middle = 0.5 * (a + b);
        let secant = b - fb * (b - a) / (fb - fa);
        let between = (secant - a) * (secant - b) < 0.0;
        let x = if between && step % 3 < 2 {
            secant
        } else {
            middle
        };
        let fx = f(x);
        if fx == 0.0 || x == a || x == b {
            return x;
        }
        if (fx > 0.0) == (fb > 0.0) {
            (b, fb) = (x, fx);
            fa = if stayed > 0 { 0.5 * fa } else { fa };
            stayed = 1;
        } else {
            (a, fa) = (x, fx);
            fb = if stayed < 0 { 0.5 * fb } else { fb };
            stayed = -1;
        }
        if (b - a).abs() <= RESOLUTION {
            break;
        }
    }
    if fa.abs() < fb.abs() { a } else { b }
}

/// Searches for roots around the middle of three successive points. The three values have the same
/// sign, and the middle value is nearest to zero. The search finds two roots, one double root, or
/// no root.
pub(super) fn dip(
    f: impl Fn(f64) -> f64,
    [mut a, mut b, mut c]: [(f64, f64); 3],
    visit: &mut impl FnMut(f64),
) {
    let sign = b.1.signum();
    let mut settled = 0;
    for step in 0..STEPS_MAX {
        let (vertex, expected) = vertex(a, b, c);
        // Uses the golden section if the parabola yields no new point.
        let wide = if (b.0 - a.0).abs() > (c.0 - b.0).abs() {
            a
        } else {
            c
        };
        let golden = b.0 + 0.381_966 * (wide.0 - b.0);
        let usable = (vertex - a.0) * (vertex - c.0) < 0.0
            && (vertex - b.0).abs() > RESOLUTION
            && step % 4 < 3;
        let x = if usable { vertex } else { golden };
        let point = (x, f(x));
        if point.1 * sign <= 0.0 {
            // The function crosses zero before its extremum, so one root is on each side.
            visit(root(&f, a, point));
            visit(root(&f, point, c));
            return;
        }
        let (value, least) = (point.1.abs(), b.1.abs());
        let foreseen = (point.1 - expected).abs() < 0.1 * value;
        if usable && foreseen && value > 0.8 * least {
            settled += 1;
        } else if value < 0.5 * least {
            settled = 0;
        }
        if settled == SETTLED {
            return; // away from zero: near a double root, the values fall ever faster
        }
        let nearer = value < least;
        let towards_c = (x - b.0) * (c.0 - b.0) > 0.0;
        match (nearer, towards_c) {
            (true, true) => (a, b) = (b, point),
            (true, false) => (c, b) = (b, point),
            (false, true) => c = point,
            (false, false) => a = point,
        }
        if (c.0 - a.0).abs() <= NARROW {
            break;
        }
    }
    if b.1.abs() < TOUCH {
        visit(b.0);
    }
}

/// Searches for roots as [`dip`] does, but between the end of an interval and the point next to it.
/// The value at that point is further from zero than at the end.
pub(super) fn dip_at_end(
    f: impl Fn(f64) -> f64,
    end: (f64, f64),
    next: (f64, f64),
    visit: &mut impl FnMut(f64),
) {
    if end.1.abs() < TOUCH {
        visit(end.0);
    }
    let mut far = next;
    for _ in 0..END_STEPS {
        let x = end.0 + 0.3 * (far.0 - end.0);
        let point = (x, f(x));
        if point.1 * end.1 < 0.0 {
            visit(root(&f, end, point));
            visit(root(&f, point, far));
            return;
        }
        if point.1.abs() < end.1.abs() {
            return dip(f, [end, point, far], visit);
        }
        far = point;
    }
}

/// Returns the extremum of the parabola through three points, and its value.
fn vertex(a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> (f64, f64) {
    let (left, right) = (a.0 - b.0, c.0 - b.0);
    let (down, up) = ((a.1 - b.1) / left, (c.1 - b.1) / right);
    let curvature = (up - down) / (right - left);
    let slope = down - curvature * left;
    let step = -0.5 * slope / curvature;
    (b.0 + step, b.1 + 0.5 * slope * step)
}

const STEPS_MAX: u32 = 60;
/// Number of parabola steps without improvement that end a search.
const SETTLED: u32 = 3;
/// Number of samples between an end and the point next to it.
const END_STEPS: u32 = 5;
/// Distance, `[rad]`, below which two points count as equal.
const RESOLUTION: f64 = 1e-16;
/// Width of a bracket within which a smooth function differs from its extremum only by rounding.
const NARROW: f64 = 1e-8;
/// Bound below which an extremum counts as a root.
const TOUCH: f64 = 1e-14;

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn found(f: impl Fn(f64) -> f64, points: [f64; 3]) -> Vec<f64> {
        let mut list = Vec::new();
        let points = points.map(|x| (x, f(x)));
        dip(f, points, &mut |x| list.push(x));
        list.sort_by(f64::total_cmp);
        list
    }

    #[test]
    fn a_bracketed_root_is_found_to_the_last_digits() {
        let f = |x: f64| x * x * x - 2.0;
        let x = root(f, (0.0, f(0.0)), (10.0, f(10.0)));
        assert!((x - 2f64.cbrt()).abs() < 1e-15);
        let steep = |x: f64| (1e6 * (x - 0.3)).atan();
        let x = root(steep, (-1.0, steep(-1.0)), (1.0, steep(1.0)));
        assert!((x - 0.3).abs() < 1e-15);
    }

    #[test]
    fn two_close_roots_between_samples_are_both_found() {
        for gap in [0.1, 1e-3, 1e-5, 1e-6] {
            let f = |x: f64| (x - 0.2) * (x - 0.2 - gap) * (1.0 + x);
            let roots = found(f, [-0.3, 0.1, 0.8]);
            assert_eq!(roots.len(), 2, "{gap}");
            assert!((roots[0] - 0.2).abs() < 1e-9 && (roots[1] - 0.2 - gap).abs() < 1e-9);
        }
    }

    #[test]
    fn tangent_root_is_found_once_or_twice() {
        let f = |x: f64| -(x - 0.2) * (x - 0.2) * (2.0 + x);
        let roots = found(f, [-0.3, 0.1, 0.8]);
        assert!(roots.len() == 1 || roots.len() == 2);
        assert!(roots.iter().all(|x| (x - 0.2).abs() < 1e-7));
    }

    #[test]
    fn an_extremum_short_of_zero_is_no_root() {
        for height in [1.0, 1e-3, 1e-9] {
            let roots = found(|x| (x - 0.2) * (x - 0.2) + height, [-0.3, 0.1, 0.8]);
            assert!(roots.is_empty(), "{height}");
        }
    }

    #[test]
    fn two_roots_next_to_an_end_are_found() {
        let f = |x: f64| (x - 0.02) * (x - 0.01);
        let mut list = Vec::new();
        dip_at_end(f, (0.0, f(0.0)), (0.2, f(0.2)), &mut |x| list.push(x));
        list.sort_by(f64::total_cmp);
        assert_eq!(list.len(), 2);
        assert!((list[0] - 0.01).abs() < 1e-12 && (list[1] - 0.02).abs() < 1e-12);
    }
}

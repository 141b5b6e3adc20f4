//! Timing of a path: it is traversed as fast as its limits allow. At each corner the arm rounds the
//! corner or stops.
//!
//! A leg is traversed along its straight line, with a profile of constant jerks. Around a corner,
//! the velocity changes from one leg's velocity to the next leg's velocity. The change follows a
//! smoothstep in time:
//!
//! ```text
//! v(t) = v1 + (v2 - v1) s(t / 2T)    from T before the corner to T after it, s(u) = 3 u^2 - 2 u^3
//! ```
//!
//! Its integral leads exactly from one line to the other line, and its acceleration is zero at both
//! ends. `T` is the shortest time that the limits allow for a given size of the corner. It is
//! longer if the adjacent legs are too short to reach that speed or to brake to it.

use franka_otg::AxisLimits;
use nalgebra::SVector;

/// A leg, as seen from its start.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg<const D: usize> {
    /// Vector from the start of the leg to its end.
    pub(super) way: SVector<f64, D>,
    /// Limits, with the length of the leg as the unit: 1/s, 1/s^2, 1/s^3.
    pub(super) limits: AxisLimits,
}

/// A rounded corner: its shares of the legs before and after it, and half of its duration, `[s]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) before: f64,
    pub(super) after: f64,
    pub(super) half: f64,
}

impl Corner {
    /// Creates the corner between `leg` and `next` with its shortest duration. `duration` returns
    /// the time for a vector: 0.75 of the vector divided by the squared time is at most the
    /// acceleration, and 1.5 of it divided by the cubed time is at most the jerk.
    pub(super) fn new<const D: usize>(
        (before, after): (f64, f64),
        (leg, next): (&Leg<D>, &Leg<D>),
        duration: impl Fn(&SVector<f64, D>) -> f64,
    ) -> Self {
        let turned = next.way * after - leg.way * before;
        let half = (before / leg.limits.velocity).max(after / next.limits.velocity);
        Self {
            before,
            after,
            half: half.max(duration(&turned)),
        }
    }
}

/// Returns half of the duration of a corner in which the velocity changes over `way`, `[s]`.
pub(super) fn corner_time(way: f64, limits: &AxisLimits) -> f64 {
    let by_acceleration = (0.75 * way / limits.acceleration).sqrt();
    by_acceleration.max((1.5 * way / limits.jerk).cbrt())
}

/// A knot of the motion. Between two knots the jerk is constant, or a corner is rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Knot {
    /// Time, `[s]`.
    pub(super) time: f64,
    pub(super) leg: usize,
    /// Position as a share of the leg, with two derivatives.
    pub(super) s: f64,
    pub(super) v: f64,
    pub(super) a: f64,
}

impl Knot {
    /// Rest at the start of a path.
    pub(super) const START: Self = Self {
        time: 0.0,
        leg: 0,
        s: 0.0,
        v: 0.0,
        a: 0.0,
    };
}

/// Times the `legs`, with `corners[i]` between leg `i` and the next leg. The arm stops where there
/// is no corner. Requires at least one leg, and one corner fewer than legs.
pub(super) fn time<const D: usize>(legs: &[Leg<D>], corners: &mut [Option<Corner>]) -> Vec<Knot> {
    // First find the speed from which each leg can brake, then the speed that it can reach.
    for i in (1..legs.len()).rev() {
        let (_, end) = speeds(i, corners);
        let most = fastest(end, span(i, corners), &legs[i].limits);
        if let Some(corner) = &mut corners[i - 1] {
            corner.half = corner.half.max(corner.after / most);
        }
    }
    for (i, leg) in legs.iter().enumerate().take(corners.len()) {
        let (begin, _) = speeds(i, corners);
        let most = fastest(begin, span(i, corners), &leg.limits);
        if let Some(corner) = &mut corners[i] {
            corner.half = corner.half.max(corner.before / most);
        }
    }
    let mut knots = vec![Knot::START];
    for (leg, Leg { limits, .. }) in legs.iter().enumerate() {
        let (begin, end) = speeds(leg, corners);
        if let Some(corner) = leg.checked_sub(1).and_then(|before| corners[before]) {
            let before = knots[knots.len() - 1];
            knots.push(Knot {
                time: before.time + 2.0 * corner.half,
                leg,
                s: corner.after,
                v: begin,
                a: 0.0,
            });
        } else if leg > 0 {
            // The same place, as seen from the next leg.
            if let Some(stopped) = knots.last_mut() {
                (stopped.leg, stopped.s) = (leg, 0.0);
            }
        }
        straight(&mut knots, (begin, end), span(leg, corners), limits);
    }
    knots
}

/// Returns the speeds, in shares per second, at the start and at the end of the straight part of
/// leg `i`.
fn speeds(i: usize, corners: &[Option<Corner>]) -> (f64, f64) {
    let before = i.checked_sub(1).and_then(|before| corners[before]);
    let after = corners.get(i).copied().flatten();
    (
        before.map_or(0.0, |corner| corner.after / corner.half),
        after.map_or(0.0, |corner| corner.before / corner.half),
    )
}

/// Returns the share of leg `i` that is traversed along its straight line.
fn span(i: usize, corners: &[Option<Corner>]) -> f64 {
    let before = i.checked_sub(1).and_then(|before| corners[before]);
    let after = corners.get(i).copied().flatten();
    let cut = before.map_or(0.0, |corner| corner.after) + after.map_or(0.0, |corner| corner.before);
    (1.0 - cut).max(0.0)
}

/// Returns the distance that a change of speed takes, with zero acceleration at both ends.
fn way(from: f64, to: f64, limits: &AxisLimits) -> f64 {
    let (build_up, hold) = ramp(from, to, limits);
    0.5 * (from + to) * (2.0 * build_up + hold)
}

/// Returns two times of a change of speed: the time to build up or remove the acceleration, and the
/// time between.
fn ramp(from: f64, to: f64, limits: &AxisLimits) -> (f64, f64) {
    let (change, full) = ((to - from).abs(), limits.acceleration / limits.jerk);
    if change < limits.acceleration * full {
        ((change / limits.jerk).sqrt(), 0.0)
    } else {
        (full, change / limits.acceleration - full)
    }
}

/// Returns the greatest speed that can be reached from the speed `from` within `span`, or from
/// which the motion can brake to `from`.
fn fastest(from: f64, span: f64, limits: &AxisLimits) -> f64 {
    most(from, limits.velocity, |to| way(from, to, limits) <= span)
}

/// Returns the greatest number in an interval for which `holds` is true. `holds` must be true from
/// the lower end up to that number, and false above it.
fn most(lower: f64, upper: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (lower, upper.max(lower));
    if holds(high) {
        return high;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Number of halvings. It exceeds the number of binary digits.
const HALVINGS: usize = 64;

/// Knots that are closer in time than this count as one knot, `[s]`.
const SAME: f64 = 1e-9;

/// Moves along the line for `span` of a leg, as fast as the limits allow.
fn straight(knots: &mut Vec<Knot>, (begin, end): (f64, f64), span: f64, limits: &AxisLimits) {
    let first = knots[knots.len() - 1];
    let peak = most(begin.max(end), limits.velocity, |peak| {
        way(begin, peak, limits) + way(peak, end, limits) <= span
    });
    let cruise = span - way(begin, peak, limits) - way(peak, end, limits);
    change(knots, (begin, peak), limits);
    if cruise > 0.0 && peak > 0.0 {
        glide(knots, cruise / peak, 0.0);
    }
    change(knots, (peak, end), limits);
    // Sets the exact end, so that rounding errors have no effect.
    if let Some(last) = knots.last_mut() {
        (last.s, last.v, last.a) = (first.s + span, end, 0.0);
    }
}

fn change(knots: &mut Vec<Knot>, (from, to): (f64, f64), limits: &AxisLimits) {
    let (build_up, hold) = ramp(from, to, limits);
    let jerk = limits.jerk.copysign(to - from);
    glide(knots, build_up, jerk);
    glide(knots, hold, 0.0);
    glide(knots, build_up, -jerk);
}

fn glide(knots: &mut Vec<Knot>, duration: f64, jerk: f64) {
    if duration < SAME {
        return;
    }
    let Knot { time, leg, s, v, a } = knots[knots.len() - 1];
    let t = duration;
    knots.push(Knot {
        time: time + t,
        leg,
        s: s + t * (v + t * (a / 2.0 + t * jerk / 6.0)),
        v: v + t * (a + t * jerk / 2.0),
        a: a + t * jerk,
    });
}

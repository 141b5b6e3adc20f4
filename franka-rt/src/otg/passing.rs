//! Targets in motion: which durations are possible, and a profile for each.
//!
//! At a target with a velocity an axis cannot wait. One that would be early has to make room first and come again, so
//! there may be durations that cannot be met between others that can: *blocked* ones. What remains true is that for one
//! duration the positions that can be reached are an interval, since the dynamics are linear and the limits convex.
//! Its ends are the farthest motions up and down ([`Farthest`]), in closed form. Hence
//!
//! - a duration is possible if its interval contains the target: two evaluations, no case to try;
//! - the interval's ends pass the target a few times at most, and in between durations stay possible or impossible.
//!   Each end is monotone between its turning points, which are closed too, so one bracketed search per piece finds
//!   them all: the least duration and the ends of the blocked intervals;
//! - there is a profile for each possible duration: the mean of the two farthest motions, weighted so that it ends at the
//!   target. A mean of motions inside convex limits is inside them. It is what always works; where a constant velocity
//!   fits in between that is the better course ([`Plateau`]).
//!
//! The velocity of the end has to be in reach as well, which is the same problem one derivative lower and for the same
//! reason has a blocked interval of its own if the target accelerates: `Turn` holds both.
//!
//! Looking for all profiles that fit, the usual way, needs quartic and sixth-order equations in eleven families per
//! direction, half of which fail by rounding where two families meet.

use super::farthest::{Farthest, Reach};
use super::least_time::Shape;
use super::plateau::Plateau;
use super::root::{Point, root};
use super::task::{ROUNDING, Task};

/// One axis and a target that moves, in units of the axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passing {
    task: Task,
    vf: f64,
    af: f64,
    up: Farthest,
    /// The same with all directions reversed.
    down: Farthest,
    turn: Turn,
    tolerance: Tolerance,
    /// Durations at which the possible ones begin, and some at which they end.
    candidates: Times<CANDIDATES>,
}

/// How to move for one duration.
#[derive(Debug, Clone, Copy)]
pub(super) enum Way {
    /// One shape in a direction, 1 or -1.
    Shape(f64, Shape),
    /// The mean of two.
    Mean {
        /// As far up as possible.
        up: Reach,
        /// As far down as possible, seen in its own frame.
        down: Reach,
        /// Weight of the first.
        weight: f64,
    },
}

impl Passing {
    /// The possible durations of a task inside its limits, for a target with velocity `vf` and acceleration `af` that
    /// can be met inside them.
    pub(super) fn new(task: &Task, vf: f64, af: f64) -> Self {
        let mut passing = Self {
            task: *task,
            vf,
            af,
            up: Farthest::new(task, vf, af),
            down: Farthest::new(&task.mirrored(-1.0), -vf, -af),
            turn: Turn::new(task, vf, af),
            tolerance: Tolerance::new(task, vf, af),
            candidates: Times::NONE,
        };
        passing.find_candidates();
        passing
    }

    /// The farthest motions of one direction, 1 or -1.
    pub(super) fn farthest(&self, sign: f64) -> &Farthest {
        if sign > 0.0 { &self.up } else { &self.down }
    }

    /// The least possible duration.
    pub(super) fn least(&self) -> f64 {
        self.candidates.iter().next().unwrap_or(0.0)
    }

    /// The least possible duration that is not less than `t`, or than a little before it: one that ends up to `slack` ahead
    /// of `t` counts as `t`.
    pub(super) fn from(&self, t: f64, slack: f64) -> f64 {
        if self.is_possible(t) || self.just_before(t, slack).is_some() {
            return t;
        }
        // Behind the last one all durations are possible, whatever rounding says.
        self.candidates.iter().find(|&next| next > t).unwrap_or(t)
    }

    /// The last candidate up to `slack` ahead of `t`.
    fn just_before(&self, t: f64, slack: f64) -> Option<f64> {
        let near = |&candidate: &f64| candidate <= t && t - candidate <= slack;
        self.candidates.iter().filter(near).last()
    }

    /// How to move for a duration that [`from`](Self::from) gives for the same `slack`.
    pub(super) fn way(&self, t: f64, slack: f64) -> Way {
        let t = if self.is_possible(t) {
            t
        } else {
            self.just_before(t, slack).unwrap_or(t)
        };
        let (up, down) = (self.up.reach(t), self.down.reach(t));
        if up.beyond <= self.tolerance.at(t, up.w) {
            return Way::Shape(1.0, up.shape(&self.up));
        }
        if down.beyond <= self.tolerance.at(t, down.w) {
            return Way::Shape(-1.0, down.shape(&self.down));
        }
        let plateau = Plateau::new(&self.task, self.vf, self.af, t);
        match plateau.between(-down.w, up.w) {
            Some((sign, shape)) => Way::Shape(sign, shape),
            None => {
                let weight = down.beyond / (up.beyond + down.beyond);
                Way::Mean { up, down, weight }
            }
        }
    }

    fn is_possible(&self, t: f64) -> bool {
        self.turn.is_possible(t) && {
            let (up, down) = (self.up.reach(t), self.down.reach(t));
            up.beyond >= -self.tolerance.at(t, up.w) && down.beyond >= -self.tolerance.at(t, down.w)
        }
    }

    fn find_candidates(&mut self) {
        let mut breaks = Times::<BREAKS>::NONE;
        for (t, rounding) in self.turn.crossings().into_iter().flatten() {
            breaks.insert(t);
            // Whoever follows a plan is here from some point on: both sides end at the target but for rounding, and
            // going for the rounding could cost a detour. The velocity's is the larger one, so the time is that which
            // meets the position.
            let up = self.up.reach(t);
            let later = -up.beyond / up.rate();
            if later.abs() <= rounding && t + later >= 0.0 {
                self.candidates.insert(t + later);
            } else if up.beyond.abs() <= self.tolerance.at(t, up.w) {
                self.candidates.insert(t);
            }
        }
        let Some(first) = breaks.iter().next() else {
            return; // not for numbers that are finite
        };
        for side in [&self.up, &self.down] {
            for t in side.turning_points().into_iter().flatten() {
                if t > first {
                    breaks.insert(t);
                }
            }
        }
        let mut found = Times::<FOUND>::NONE;
        let mut left: Option<(f64, [Reach; 2])> = None;
        for right in breaks.iter() {
            let reaches = [self.up.reach(right), self.down.reach(right)];
            // A target at a turning point but for rounding.
            if reaches
                .iter()
                .any(|reach| reach.beyond.abs() <= self.tolerance.at(right, reach.w))
            {
                found.insert(right);
            }
            if let Some((left, before)) = left
                && self.turn.is_possible(0.5 * (left + right))
            {
                for (side, (from, to)) in [&self.up, &self.down]
                    .into_iter()
                    .zip(before.iter().zip(&reaches))
                {
                    if (from.beyond > 0.0) != (to.beyond > 0.0) {
                        found.insert(crossing(side, (left, from), (right, to)));
                    }
                }
            }
            left = Some((right, reaches));
        }
        // Behind the last break both cruise, and come to the target if they are not there yet.
        let mut latest = 0.0_f64;
        if let Some((last, reaches)) = left {
            latest = last;
            for (side, reach) in [&self.up, &self.down].into_iter().zip(reaches) {
                if reach.beyond < 0.0 {
                    let t = side.cruise_on(last, -reach.beyond);
                    found.insert(t);
                    latest = latest.max(t);
                }
            }
        }
        for t in found.iter() {
            if self.is_possible(t) {
                self.candidates.insert(t);
            }
        }
        if self.candidates.len == 0 {
            self.candidates.insert(latest);
        }
    }
}

/// When the end of the farthest motion crosses the target, between two durations.
fn crossing(side: &Farthest, (left, from): (f64, &Reach), (right, to): (f64, &Reach)) -> f64 {
    let point = |at, reach: &Reach| Point {
        at,
        value: reach.beyond,
    };
    root(point(left, from), point(right, to), 0.0, |t| {
        side.reach(t).beyond
    })
}

/// When the end's velocity and acceleration can be met, wherever the axis is then.
///
/// The position's problem one derivative lower. The velocities that can be reached in one duration are an interval; its
/// ends are "acceleration up, then down" and the reverse, and the areas under them give the equations.
#[derive(Debug, Clone, Copy)]
struct Turn {
    a0: f64,
    af: f64,
    /// Square of the acceleration in between, or what takes its place with a hold, that leads to the end's velocity:
    /// the highest and the lowest.
    peak: f64,
    valley: f64,
    tolerance: f64,
}

impl Turn {
    fn new(task: &Task, vf: f64, af: f64) -> Self {
        let (v0, a0) = (task.v, task.a);
        let squares = 0.5 * (a0 * a0 + af * af);
        Self {
            a0,
            af,
            peak: squares + (vf - v0),
            valley: squares - (vf - v0),
            tolerance: 2.0 * DRIFT * (v0.abs() + vf.abs() + squares + typical_velocity(task)),
        }
    }

    fn is_possible(&self, t: f64) -> bool {
        let Self { a0, af, .. } = *self;
        let shortest = (af - a0).abs();
        let (highest, lowest) = (0.5 * (t + a0 + af), 0.5 * (t - a0 - af));
        t >= shortest * (1.0 - ROUNDING)
            && area(highest) >= self.peak - self.tolerance
            && area(lowest) >= self.valley - self.tolerance
    }

    /// Where possible durations begin or end, in no order, and what the rounding of velocities makes of them.
    fn crossings(&self) -> [Option<(f64, f64)>; 4] {
        let Self { a0, af, .. } = *self;
        let shortest = (af - a0).abs();
        let ways = [(self.peak, a0 + af), (self.valley, -a0 - af)];
        let mut times = [None; 4];
        for (i, (area, sum)) in ways.into_iter().enumerate() {
            if area < -self.tolerance {
                continue;
            }
            let extreme = if area > 1.0 {
                0.5 * (area + 1.0)
            } else {
                area.max(0.0).sqrt()
            };
            let rounding = self.tolerance / extreme.min(1.0).max(self.tolerance.sqrt());
            for (j, extreme) in [extreme, -extreme].into_iter().enumerate() {
                let t = 2.0 * extreme - sum;
                if t >= shortest - 2.0 * rounding && self.is_possible(t.max(shortest)) {
                    times[2 * i + j] = Some((t.max(shortest), rounding));
                }
            }
        }
        times
    }
}

/// Area under an acceleration ramp to `x`, held at one for what `x` is more than that: in units of twice the area.
fn area(x: f64) -> f64 {
    let x = x.abs();
    if x <= 1.0 { x * x } else { 2.0 * x - 1.0 }
}

/// Rounding to expect of the distance from the end of a motion to the target.
#[derive(Debug, Clone, Copy)]
struct Tolerance {
    fixed: f64,
    velocity: f64,
    offset: f64,
}

impl Tolerance {
    fn new(task: &Task, vf: f64, af: f64) -> Self {
        let (v0, a0) = (task.v.abs(), task.a.abs());
        let (vf, af) = (vf.abs(), af.abs());
        Self {
            fixed: task.fuzz + DRIFT * (task.d.abs() + a0 * (a0 * a0 + v0) + af * (af * af + vf)),
            velocity: v0 + vf + a0 * a0 + af * af + typical_velocity(task),
            offset: a0 + af,
        }
    }

    fn at(&self, t: f64, w: f64) -> f64 {
        self.fixed + DRIFT * (self.velocity + w.abs()) * (t + self.offset)
    }
}

/// Velocity that the rounding of the task's velocity may come from: an axis that slows down was faster before. A limit
/// that is much larger is seldom reached.
fn typical_velocity(task: &Task) -> f64 {
    task.top.min(1e3)
}

/// A few times in ascending order. If there is no room left, a new one takes the place of the last.
#[derive(Debug, Clone, Copy)]
struct Times<const C: usize> {
    list: [f64; C],
    len: usize,
}

impl<const C: usize> Times<C> {
    const NONE: Self = Self {
        list: [0.0; C],
        len: 0,
    };

    fn insert(&mut self, t: f64) {
        if self.iter().any(|other| other == t) {
            return;
        }
        let mut i = self.len.min(C - 1);
        while i > 0 && self.list[i - 1] > t {
            self.list[i] = self.list[i - 1];
            i -= 1;
        }
        self.list[i] = t;
        self.len = (self.len + 1).min(C);
    }

    fn iter(&self) -> impl Iterator<Item = f64> + '_ {
        self.list[..self.len].iter().copied()
    }
}

/// Relative rounding of a state that some thousand plans led to, each from the state that the one before gave. Equal
/// steps are rounded alike, so what they are rounded by adds up.
const DRIFT: f64 = 1024.0 * ROUNDING;

/// Four of the turn and six turning points of each side.
const BREAKS: usize = 16;

/// Each break may be a candidate, and between two breaks each side may cross once; behind the last, too.
const FOUND: usize = 48;

/// Each side crosses the target five times at most, and four durations are where the velocity can be met.
pub(super) const CANDIDATES: usize = 16;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::otg::least_time::least_time;
    use crate::otg::tests::cases;

    proptest! {
        #![proptest_config(cases(3000))]

        /// Rest is a motion too: the other solution, which shares none of the equations, has to agree.
        #[test]
        fn a_target_at_rest_takes_as_long_as_by_the_other_solution(
            exponent in -1.5_f64..2.5, coasting in -1.0_f64..1.0, bend in -1.0_f64..1.0, distance in -3.0_f64..1.0, up in any::<bool>(),
        ) {
            let top = 10_f64.powf(exponent);
            let room = 2.0 * top * (1.0 + coasting * 1_f64.copysign(bend));
            let a = bend * f64::min(1.0, room.sqrt());
            let task = Task { d: 0.0, v: top * coasting - 0.5 * a * a.abs(), a, top, fuzz: 0.0 };
            let way = top * (1.0 + top) * 10_f64.powf(distance);
            let task = Task { d: task.stop_point().0 + if up { way } else { -way }, ..task };
            let (got, expected) = (Passing::new(&task, 0.0, 0.0).least(), least_time(task).duration);
            prop_assert!((got - expected).abs() <= 1e-9 * expected, "{got} instead of {expected}");
        }
    }

    #[test]
    fn an_axis_early_at_a_moving_target_has_durations_that_are_blocked() {
        // At the target's velocity and a little behind its place: to be there later it has to go back first.
        let task = Task {
            d: 1e-3,
            v: 0.5,
            a: 0.0,
            top: 1.0,
            fuzz: 0.0,
        };
        let passing = Passing::new(&task, 0.5, 0.0);
        let least = passing.least();
        assert!(least < 2e-3, "{least}");
        let next = passing.from(0.1, 0.0);
        assert!(next > 2.0, "{next}");
        // It slows down to nothing and less, and comes again with as much.
        let (low, high) = (passing.down.reach(next), passing.up.reach(next));
        assert!(low.beyond.abs() < 1e-12 && high.beyond > 0.0);
        assert!(low.w > 0.0, "backwards, in the frame that is upside down");
    }

    #[test]
    fn full_lists_keep_the_last_time() {
        let mut times = Times::<3>::NONE;
        for t in [1.0, 4.0, 2.0, 2.0, 3.0, 5.0] {
            times.insert(t);
        }
        assert!(times.iter().eq([1.0, 2.0, 5.0]));
    }
}

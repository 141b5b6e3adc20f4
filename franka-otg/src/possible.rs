//! Which durations are possible for a target in motion.

use crate::farthest::{Farthest, Reach};
use crate::root::{Point, root};
use crate::task::{ROUNDING, Task};
use crate::times::Times;
use crate::velocity_change::{DRIFT, TIGHT, VelocityChange, typical_velocity};

/// Decides about durations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Possible {
    pub(crate) up: Farthest,
    /// The same with all directions reversed.
    pub(crate) down: Farthest,
    change: VelocityChange,
    size: Size,
    vf: f64,
    af: f64,
}

/// Durations at which possible ones begin or end.
pub(crate) type Candidates = Times<CANDIDATES>;

impl Possible {
    /// For a task inside its limits and a target with velocity `vf` and acceleration `af`.
    pub(crate) fn new(task: &Task, vf: f64, af: f64) -> Self {
        Self {
            up: Farthest::new(task, vf, af),
            down: Farthest::new(&task.mirrored(-1.0), -vf, -af),
            change: VelocityChange::new(task, vf, af),
            size: Size::new(task, vf, af),
            vf,
            af,
        }
    }

    /// Whether an axis that is at its target after `other` is there after `t`, too, but for
    /// rounding of its position and velocity.
    pub(crate) fn are_same(&self, t: f64, other: f64) -> bool {
        let apart = (t - other).abs();
        let (speed, bend) = (self.vf.abs(), self.af.abs());
        let position = apart * (speed + apart * (bend + apart));
        let velocity = apart * (bend + apart);
        position <= self.drift(t) && velocity <= DRIFT * self.change.size()
    }

    /// What the position of the target may be rounded by after a chain of plans.
    pub(crate) fn drift(&self, t: f64) -> f64 {
        DRIFT * self.size.at(t, self.vf)
    }

    /// Whether a motion of duration `t` ends at the target but for rounding.
    pub(crate) fn meets(&self, reach: &Reach, t: f64) -> bool {
        reach.beyond <= TIGHT * self.size.at(t, reach.w)
    }

    /// Whether the axis can be at its target after `t`.
    pub(crate) fn is_possible(&self, t: f64) -> bool {
        self.change.is_possible(t) && {
            let (up, down) = (self.up.reach(t), self.down.reach(t));
            up.beyond >= -TIGHT * self.size.at(t, up.w)
                && down.beyond >= -TIGHT * self.size.at(t, down.w)
        }
    }

    /// Durations at which possible ones begin, and some at which they end.
    pub(crate) fn candidates(&self) -> Candidates {
        let mut candidates = Candidates::NONE;
        let mut breaks = Times::<BREAKS>::NONE;
        for (t, rounding) in self.change.crossings().into_iter().flatten() {
            breaks.insert(t);
            // Whoever follows a plan is here from some point on: both sides end at the target but
            // for rounding, and going for the rounding could cost a detour. The velocity's is the
            // larger one, so the time is that which meets the position.
            let up = self.up.reach(t);
            let later = -up.beyond / up.rate();
            if later.abs() <= rounding && t + later >= 0.0 {
                candidates.insert(t + later);
            } else if up.beyond.abs() <= DRIFT * self.size.at(t, up.w) {
                candidates.insert(t);
            }
        }
        let Some(first) = breaks.iter().next() else {
            return candidates; // not for numbers that are finite
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
                .any(|reach| reach.beyond.abs() <= TIGHT * self.size.at(right, reach.w))
            {
                found.insert(right);
            }
            if let Some((left, before)) = left
                && self.change.is_possible(0.5 * (left + right))
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
                candidates.insert(t);
            }
        }
        if candidates.iter().next().is_none() {
            candidates.insert(latest);
        }
        candidates
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

/// What the distance from the end of a motion to the target is rounded relative to.
#[derive(Debug, Clone, Copy)]
struct Size {
    fixed: f64,
    velocity: f64,
    offset: f64,
}

impl Size {
    fn new(task: &Task, vf: f64, af: f64) -> Self {
        let (v0, a0) = (task.v.abs(), task.a.abs());
        let (vf, af) = (vf.abs(), af.abs());
        Self {
            fixed: task.fuzz / ROUNDING + task.d.abs() + a0 * (a0 * a0 + v0) + af * (af * af + vf),
            velocity: v0 + vf + a0 * a0 + af * af + typical_velocity(task),
            offset: a0 + af,
        }
    }

    fn at(&self, t: f64, w: f64) -> f64 {
        self.fixed + (self.velocity + w.abs()) * (t + self.offset)
    }
}

/// Four of the velocity and six turning points of each side.
const BREAKS: usize = 16;

/// Each break may be a candidate, and between two breaks each side may cross once; behind the last,
/// too.
const FOUND: usize = 48;

/// Possible durations are three intervals at most; what rounding finds twice may take the places
/// that are left.
pub(crate) const CANDIDATES: usize = 8;

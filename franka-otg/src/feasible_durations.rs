//! The feasible durations for a target in motion.

use crate::extremal_profile::{ExtremalProblem, ExtremalProfile};
use crate::root::{Point, root};
use crate::task::{ROUNDING, Task};
use crate::times::Times;
use crate::velocity_change::{DRIFT, TIGHT, VelocityChange, typical_velocity};

/// Decides if a duration is feasible.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FeasibleDurations {
    pub(crate) up: ExtremalProblem,
    /// The same problem with all directions reversed.
    pub(crate) down: ExtremalProblem,
    change: VelocityChange,
    size: Size,
    vf: f64,
    af: f64,
}

/// Durations at which feasible intervals may begin or end.
pub(crate) type Candidates = Times<CANDIDATES>;

impl FeasibleDurations {
    /// Prepares the decision for a task inside its limits, and for a target with velocity `vf` and
    /// acceleration `af`.
    pub(crate) fn new(task: &Task, vf: f64, af: f64) -> Self {
        Self {
            up: ExtremalProblem::new(task, vf, af),
            down: ExtremalProblem::new(&task.mirrored(-1.0), -vf, -af),
            change: VelocityChange::new(task, vf, af),
            size: Size::new(task, vf, af),
            vf,
            af,
        }
    }

    /// Returns true if an axis that is at its target after `other` is also at the target after `t`,
    /// within the rounding of its position and velocity.
    pub(crate) fn are_same(&self, t: f64, other: f64) -> bool {
        let apart = (t - other).abs();
        let (speed, bend) = (self.vf.abs(), self.af.abs());
        let position = apart * (speed + apart * (bend + apart));
        let velocity = apart * (bend + apart);
        position <= NEAR * self.drift(t) && velocity <= NEAR * DRIFT * self.change.size()
    }

    /// Returns the largest rounding of the target's position after a chain of plans.
    pub(crate) fn drift(&self, t: f64) -> f64 {
        DRIFT * self.size.at(t, self.vf)
    }

    /// Returns true if a motion of duration `t` ends at the target, within rounding.
    pub(crate) fn meets(&self, reach: &ExtremalProfile, t: f64) -> bool {
        reach.beyond <= TIGHT * self.size.at(t, reach.w)
    }

    /// Returns true if the axis can be at its target after `t`.
    pub(crate) fn is_feasible(&self, t: f64) -> bool {
        self.change.is_feasible(t) && {
            let (up, down) = (self.up.profile(t), self.down.profile(t));
            up.beyond >= -TIGHT * self.size.at(t, up.w)
                && down.beyond >= -TIGHT * self.size.at(t, down.w)
        }
    }

    /// Returns the durations at which feasible intervals begin, and some of the durations at which
    /// they end.
    pub(crate) fn candidates(&self) -> Candidates {
        let mut candidates = Candidates::NONE;
        let mut breaks = Times::<BREAKS>::NONE;
        for (t, rounding) in self.change.crossings().into_iter().flatten() {
            breaks.insert(t);
            // On the last part of a plan, both extremal motions end at the target within rounding.
            // The plan must not make a detour to remove this rounding. The rounding of the velocity
            // is larger, so the time is chosen to match the position.
            let up = self.up.profile(t);
            let later = -up.beyond / up.rate();
            if later.abs() <= rounding && t + later >= 0.0 {
                candidates.insert(t + later);
            } else if up.beyond.abs() <= DRIFT * self.size.at(t, up.w) {
                candidates.insert(t);
            }
        }
        let Some(first) = breaks.iter().next() else {
            return candidates; // does not occur for finite numbers
        };
        for side in [&self.up, &self.down] {
            for t in side.turning_points().into_iter().flatten() {
                if t > first {
                    breaks.insert(t);
                }
            }
        }
        let mut found = Times::<FOUND>::NONE;
        let mut left: Option<(f64, [ExtremalProfile; 2])> = None;
        for right in breaks.iter() {
            let reaches = [self.up.profile(right), self.down.profile(right)];
            // Within rounding, the target may be at a turning point.
            if reaches
                .iter()
                .any(|reach| reach.beyond.abs() <= TIGHT * self.size.at(right, reach.w))
            {
                found.insert(right);
            }
            if let Some((left, before)) = left
                && self.change.is_feasible(0.5 * (left + right))
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
        // After the last break, both extremal motions cruise. They reach the target if they have
        // not passed it yet.
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
            if self.is_feasible(t) {
                candidates.insert(t);
            }
        }
        if candidates.iter().next().is_none() {
            candidates.insert(latest);
        }
        candidates
    }
}

/// Returns the duration, between two durations, at which the end of the extremal motion crosses the
/// target.
fn crossing(
    side: &ExtremalProblem,
    (left, from): (f64, &ExtremalProfile),
    (right, to): (f64, &ExtremalProfile),
) -> f64 {
    let point = |at, reach: &ExtremalProfile| Point {
        at,
        value: reach.beyond,
    };
    root(point(left, from), point(right, to), 0.0, |t| {
        side.profile(t).beyond
    })
}

/// Magnitude that determines the rounding of the distance between a motion's end and the target.
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

/// Share of the drift by which a duration may differ from a feasible duration. If the share was 1,
/// two of ten million plans had a relative error above 1e-12 at the target, just after the
/// beginning of blocked durations. If it was a quarter, one of ten million plans that were renewed
/// in each cycle made a detour.
const NEAR: f64 = 0.5;

/// Largest number of breaks: four of the velocity, and six turning points of each side.
const BREAKS: usize = 16;

/// Largest number of candidates found. Each break may be a candidate. Between two breaks, and after
/// the last break, each extremal motion may cross the target once.
const FOUND: usize = 48;

/// Largest number of candidates kept. Feasible durations form at most three intervals. The other
/// entries are for ends that are found twice because of rounding.
pub(crate) const CANDIDATES: usize = 8;

//! Targets in motion: the feasible durations, and a profile for each.
//!
//! An axis cannot wait at a target that moves. An axis that would be early must move back and
//! approach again, so infeasible (*blocked*) durations may exist between feasible durations. For
//! one duration, the reachable positions still form an interval, because the dynamics are linear
//! and the limits convex. The ends of the interval are the ends of the extremal motions up and
//! down, in closed form (`extremal_profile`). Therefore:
//!
//! - two evaluations show if the interval of a duration contains the target, and the duration is
//!   feasible if it does;
//! - as the duration grows, the ends of the interval pass the target only a few times, and
//!   feasibility can change only at these durations. Each end is monotone between its turning
//!   points, which also have closed forms. One bracketed search per monotone piece finds the least
//!   duration and the ends of the blocked intervals (`feasible_durations`);
//! - each feasible duration has a profile: the mean of the two extremal motions, weighted so that
//!   it ends at the target. A mean of motions within convex limits is also within these limits, so
//!   such a profile always exists. If a motion through a constant velocity fits, that motion is
//!   used instead ([`Plateau`]).
//!
//! The velocity of the target must also be reachable. This is the same problem with one derivative
//! less. If the target accelerates, it may have its own blocked interval (`velocity_change`).
//!
//! The usual solution computes all profiles that fit, with quartic and sixth-order equations in
//! eleven families per direction. Half of these fail because of rounding where two families meet.

use crate::feasible_durations::{Candidates, FeasibleDurations};
use crate::plateau::Plateau;
use crate::shape::Shape;
use crate::task::Task;

/// One axis and a target that moves, in units of the axis.
///
/// The struct does not store quantities that a few operations can compute from the task. Each axis
/// of a plan contains this struct, even if the axis moves to rest, so it should be small.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MovingTarget {
    task: Task,
    vf: f64,
    af: f64,
    candidates: Candidates,
}

/// The motion for one duration.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Solution {
    /// One shape and its direction, 1 or -1.
    Shape(f64, Shape),
    /// The mean of two shapes.
    Mean {
        /// The extremal motion upwards, and the distance of its end beyond the target.
        up: (Shape, f64),
        /// The extremal motion downwards, in the frame in which this motion is upwards, and the
        /// distance of its end beyond the target.
        down: (Shape, f64),
        /// Weight of the motion upwards.
        weight: f64,
    },
}

impl MovingTarget {
    /// Computes the feasible durations of a task inside its limits, for a target with velocity `vf`
    /// and acceleration `af`. The limits must allow both.
    pub(crate) fn new(task: &Task, vf: f64, af: f64) -> Self {
        Self {
            task: *task,
            vf,
            af,
            candidates: FeasibleDurations::new(task, vf, af).candidates(),
        }
    }

    fn feasible(&self) -> FeasibleDurations {
        FeasibleDurations::new(&self.task, self.vf, self.af)
    }

    /// Returns the least feasible duration.
    pub(crate) fn least(&self) -> f64 {
        self.candidates.iter().next().unwrap_or(0.0)
    }

    /// Returns the smallest feasible duration that is not below `t`, within rounding.
    pub(crate) fn from(&self, t: f64) -> f64 {
        if self.can_take(t) {
            return t;
        }
        // After the last candidate, all durations are feasible, even if rounding suggests
        // otherwise.
        self.candidates.iter().find(|&next| next > t).unwrap_or(t)
    }

    /// Returns the last candidate before `t`, if `t` itself is blocked.
    pub(crate) fn before(&self, t: f64) -> Option<f64> {
        if self.can_take(t) {
            return None;
        }
        self.candidates.iter().filter(|&earlier| earlier < t).last()
    }

    /// Returns true if the axis can be at its target after `t`, within rounding.
    pub(crate) fn can_take(&self, t: f64) -> bool {
        let feasible = self.feasible();
        feasible.is_feasible(t) || self.same(&feasible, t).is_some()
    }

    /// Returns the candidate that equals `t`, within rounding.
    fn same(&self, feasible: &FeasibleDurations, t: f64) -> Option<f64> {
        self.candidates
            .iter()
            .find(|&candidate| feasible.are_same(t, candidate))
    }

    /// Returns the motion for a duration that [`from`](Self::from) returned.
    pub(crate) fn solve(&self, t: f64) -> Solution {
        let feasible = self.feasible();
        let t = if feasible.is_feasible(t) {
            t
        } else {
            self.same(&feasible, t).unwrap_or(t)
        };
        let (up, down) = (feasible.up.profile(t), feasible.down.profile(t));
        if feasible.meets(&up, t) {
            return Solution::Shape(1.0, up.shape(&feasible.up));
        }
        if feasible.meets(&down, t) {
            return Solution::Shape(-1.0, down.shape(&feasible.down));
        }
        let plateau = Plateau::new(&self.task, self.vf, self.af, t);
        match plateau.between(-down.w, up.w) {
            Some((sign, shape)) => Solution::Shape(sign, shape),
            None => {
                let weight = down.beyond / (up.beyond + down.beyond);
                Solution::Mean {
                    up: (up.shape(&feasible.up), up.beyond),
                    down: (down.shape(&feasible.down), down.beyond),
                    weight,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::least_time::least_time;
    use crate::tests::cases;

    proptest! {
        #![proptest_config(cases(3000))]

        /// Compares this solution, for a target at rest, with the independent solution for targets
        /// at rest.
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
            let (got, expected) = (MovingTarget::new(&task, 0.0, 0.0).least(), least_time(task).duration);
            prop_assert!((got - expected).abs() <= 1e-9 * expected, "{got} instead of {expected}");
        }
    }

    #[test]
    fn early_axis_at_a_moving_target_has_blocked_durations() {
        // The axis has the target's velocity and is slightly short of the target. To arrive later,
        // it must first move back.
        let task = Task {
            d: 1e-3,
            v: 0.5,
            a: 0.0,
            top: 1.0,
            fuzz: 0.0,
        };
        let target = MovingTarget::new(&task, 0.5, 0.0);
        let least = target.least();
        assert!(least < 2e-3, "{least}");
        let next = target.from(0.1);
        assert!(next > 2.0, "{next}");
        // The axis reverses, and approaches again with the same velocity.
        let feasible = target.feasible();
        let (low, high) = (feasible.down.profile(next), feasible.up.profile(next));
        assert!(low.beyond.abs() < 1e-12 && high.beyond > 0.0);
        assert!(low.w > 0.0, "backwards, in the frame that is upside down");
    }
}

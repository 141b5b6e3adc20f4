//! Targets in motion: which durations are possible, and a profile for each.
//!
//! At a target with a velocity an axis cannot wait. One that would be early has to make room first
//! and come again, so there may be durations that cannot be met between others that can: *blocked*
//! ones. What remains true is that for one duration the positions that can be reached are an
//! interval, since the dynamics are linear and the limits convex. Its ends are the farthest motions
//! up and down (`farthest`), in closed form. Hence
//!
//! - a duration is possible if its interval contains the target: two evaluations, no case to try;
//! - the interval's ends pass the target a few times at most, and in between durations stay
//!   possible or impossible. Each end is monotone between its turning points, which are closed too,
//!   so one bracketed search per piece finds them all: the least duration and the ends of the
//!   blocked intervals;
//! - there is a profile for each possible duration: the mean of the two farthest motions, weighted
//!   so that it ends at the target. A mean of motions inside convex limits is inside them. It is
//!   what always works; where a constant velocity fits in between that is the better course
//!   ([`Plateau`]).
//!
//! The velocity of the end has to be in reach as well, which is the same problem one derivative
//! lower and for the same reason has a blocked interval of its own if the target accelerates
//! (`velocity_change`).
//!
//! Looking for all profiles that fit, the usual way, needs quartic and sixth-order equations in
//! eleven families per direction, half of which fail by rounding where two families meet.

use crate::least_time::Shape;
use crate::plateau::Plateau;
use crate::possible::{Candidates, Possible};
use crate::task::Task;

/// One axis and a target that moves, in units of the axis.
///
/// What follows from the task in a few operations is not kept: there is one of these for each axis
/// of a plan, and most axes of most plans go to rest.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passing {
    task: Task,
    vf: f64,
    af: f64,
    candidates: Candidates,
}

/// How to move for one duration.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Way {
    /// One shape in a direction, 1 or -1.
    Shape(f64, Shape),
    /// The mean of two.
    Mean {
        /// As far up as possible, and how far that is beyond the target.
        up: (Shape, f64),
        /// As far down as possible, seen in its own frame.
        down: (Shape, f64),
        /// Weight of the first.
        weight: f64,
    },
}

impl Passing {
    /// The possible durations of a task inside its limits, for a target with velocity `vf` and
    /// acceleration `af` that can be met inside them.
    pub(crate) fn new(task: &Task, vf: f64, af: f64) -> Self {
        Self {
            task: *task,
            vf,
            af,
            candidates: Possible::new(task, vf, af).candidates(),
        }
    }

    fn possible(&self) -> Possible {
        Possible::new(&self.task, self.vf, self.af)
    }

    /// The least possible duration.
    pub(crate) fn least(&self) -> f64 {
        self.candidates.iter().next().unwrap_or(0.0)
    }

    /// The least possible duration that is not less than `t`, but for rounding.
    pub(crate) fn from(&self, t: f64) -> f64 {
        if self.can_take(t) {
            return t;
        }
        // Behind the last one all durations are possible, whatever rounding says.
        self.candidates.iter().find(|&next| next > t).unwrap_or(t)
    }

    /// The last candidate before `t`, if `t` itself is blocked.
    pub(crate) fn before(&self, t: f64) -> Option<f64> {
        if self.can_take(t) {
            return None;
        }
        self.candidates.iter().filter(|&earlier| earlier < t).last()
    }

    /// Whether the axis can be at its target after `t`, but for rounding.
    pub(crate) fn can_take(&self, t: f64) -> bool {
        let possible = self.possible();
        possible.is_possible(t) || self.same(&possible, t).is_some()
    }

    /// The candidate that `t` is, but for rounding.
    fn same(&self, possible: &Possible, t: f64) -> Option<f64> {
        self.candidates
            .iter()
            .find(|&candidate| possible.are_same(t, candidate))
    }

    /// How to move for a duration that [`from`](Self::from) gives.
    pub(crate) fn way(&self, t: f64) -> Way {
        let possible = self.possible();
        let t = if possible.is_possible(t) {
            t
        } else {
            self.same(&possible, t).unwrap_or(t)
        };
        let (up, down) = (possible.up.reach(t), possible.down.reach(t));
        if possible.meets(&up, t) {
            return Way::Shape(1.0, up.shape(&possible.up));
        }
        if possible.meets(&down, t) {
            return Way::Shape(-1.0, down.shape(&possible.down));
        }
        let plateau = Plateau::new(&self.task, self.vf, self.af, t);
        match plateau.between(-down.w, up.w) {
            Some((sign, shape)) => Way::Shape(sign, shape),
            None => {
                let weight = down.beyond / (up.beyond + down.beyond);
                Way::Mean {
                    up: (up.shape(&possible.up), up.beyond),
                    down: (down.shape(&possible.down), down.beyond),
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

        /// Rest is a motion too: the other solution, which shares none of the equations, has to
        /// agree.
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
        // At the target's velocity and a little behind its place: to be there later it has to go
        // back first.
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
        let next = passing.from(0.1);
        assert!(next > 2.0, "{next}");
        // It slows down to nothing and less, and comes again with as much.
        let possible = passing.possible();
        let (low, high) = (possible.down.reach(next), possible.up.reach(next));
        assert!(low.beyond.abs() < 1e-12 && high.beyond > 0.0);
        assert!(low.w > 0.0, "backwards, in the frame that is upside down");
    }
}

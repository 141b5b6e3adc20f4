//! Damped least squares in seven variables, each within an interval.
//!
//! ```text
//! minimise  1/2 |A x − t|² + 1/2 d |x − x0|²   subject to  lower <= x <= upper
//! ```
//!
//! The search guesses the set of active bounds and corrects the guess:
//!
//! 1. hold the active variables on their bounds, and minimise over the other variables;
//! 2. hold the variables that are then beyond a bound, and free the variables whose gradient points
//!    inside;
//! 3. stop if steps 1 and 2 changed nothing. After [`GUESSES`] passes, change one bound at a time.
//!
//! The first two steps alone usually need two or three passes, but rarely they cycle (Hintermüller,
//! Ito and Kunisch, The Primal-Dual Active Set Strategy as a Semismooth Newton Method, 2003). A
//! search that changes one bound at a time always terminates, because it descends and stays inside
//! the box (primal active sets: Nocedal and Wright, Numerical Optimization, 2006, section 16.5).
//!
//! `A` has six rows, so only the term with `d` makes the minimum unique. `d` may be 1e-11 of the
//! other terms. The normal equations `AᵀA + d` resolve the remaining direction to five digits. A
//! refinement step, with a residual computed from `A` itself, yields ten digits. A second step
//! yields full precision. Passes that guess need no refinement.

mod joint_box;
mod problem;

use crate::JointVector;
use crate::ldl::Ldl;

pub use joint_box::{JointBox, Side};
pub(crate) use problem::Problem;

/// The result of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// The minimum was found.
    Optimal,
    /// The search stopped after [`PASSES_MAX`] passes. The result is inside the box, but possibly
    /// not the minimum.
    PassLimit,
    /// An argument was not finite. The result is inside the box, but is otherwise arbitrary.
    Degenerate,
}

/// Number of passes after which a search stops.
///
/// Each pass computes one factorisation. Of two million random problems of differential IK, half
/// needed seven passes or fewer, and none needed more than 25.
pub const PASSES_MAX: usize = 32;

/// Number of passes that correct the whole guess at once.
const GUESSES: usize = 4;

pub(crate) struct Minimum {
    pub(crate) x: JointVector,
    pub(crate) active: [Side; 7],
    pub(crate) outcome: Outcome,
    pub(crate) passes: usize,
}

/// Searches for the minimum, starting with the bounds `active`.
pub(crate) fn minimise(
    problem: &Problem<'_>,
    bounds: &JointBox,
    active: [Side; 7],
    passes_max: usize,
) -> Minimum {
    let mut search = Search {
        problem,
        bounds,
        linear: problem.linear(),
        x: bounds.clamp(problem.posture),
        active: [Side::Free; 7],
    };
    for (i, side) in active.into_iter().enumerate() {
        search.hold(i, side);
    }
    let mut passes = 0;
    let outcome = loop {
        if passes == passes_max {
            break Outcome::PassLimit;
        }
        let guessing = passes < GUESSES;
        if passes == GUESSES {
            search.settle();
        }
        passes += 1;
        let Some(factor) = search.factor() else {
            break Outcome::Degenerate;
        };
        let (mut goal, mut gradient) = search.minimum_of_free(&factor);
        if !guessing || search.accepts(&goal, &gradient) {
            gradient = search.refine(&factor, &mut goal);
        }
        if !goal.iter().chain(&gradient).all(|x| x.is_finite()) {
            break Outcome::Degenerate;
        }
        let done = if guessing {
            search.mend(&goal, &gradient)
        } else {
            search.descend(&goal, &gradient)
        };
        if done {
            break Outcome::Optimal;
        }
    };
    Minimum {
        // A held variable is on its bound. At the optimum, rounding may put a free variable beyond
        // its bounds.
        x: bounds.clamp(&search.x),
        active: search.active,
        outcome,
        passes,
    }
}

struct Search<'a> {
    problem: &'a Problem<'a>,
    bounds: &'a JointBox,
    linear: [f64; 7],
    /// The current point; held variables are on their bounds.
    x: JointVector,
    active: [Side; 7],
}

impl Search<'_> {
    /// Makes bound `side` of variable `i` active, if the variable has a bound on that side.
    fn hold(&mut self, i: usize, side: Side) {
        let value = match side {
            Side::Free => return,
            Side::Lower => self.bounds.lower[i],
            Side::Upper => self.bounds.upper[i],
        };
        if value.is_finite() {
            self.x[i] = value;
            self.active[i] = side;
        } else {
            self.active[i] = Side::Free;
        }
    }

    /// Factorises the normal equations of the free variables; held variables keep their places.
    #[inline(always)]
    fn factor(&self) -> Option<Ldl<7>> {
        let free = self.active.map(|side| side == Side::Free);
        let matrix: [[f64; 7]; 7] = core::array::from_fn(|i| {
            core::array::from_fn(|j| match (free[i] && free[j], i == j) {
                (true, _) => self.problem.normal[i][j],
                (false, true) => 1.0,
                (false, false) => 0.0,
            })
        });
        Ldl::of(&matrix)
    }

    /// Returns the minimum with the active variables fixed, and the gradient there. The precision
    /// is the precision of the normal equations.
    #[inline(always)]
    fn minimum_of_free(&self, factor: &Ldl<7>) -> (JointVector, [f64; 7]) {
        let normal = &self.problem.normal;
        let held = self.active.map(|side| side != Side::Free);
        let mut right = self.linear;
        for j in 0..7 {
            if held[j] {
                for (right, n) in right.iter_mut().zip(&normal[j]) {
                    *right -= n * self.x[j];
                }
            }
        }
        let right = core::array::from_fn(|i| if held[i] { self.x[i] } else { right[i] });
        let goal = factor.solve(&right);
        let gradient = core::array::from_fn(|i| {
            if !held[i] {
                return 0.0;
            }
            let mut sum = -self.linear[i];
            for (n, x) in normal[i].iter().zip(&goal) {
                sum += n * x;
            }
            sum
        });
        (crate::joint_vector(goal), gradient)
    }

    /// Refines the result of `minimum_of_free` to full precision, and returns the gradient there.
    #[inline(always)]
    fn refine(&self, factor: &Ldl<7>, goal: &mut JointVector) -> [f64; 7] {
        let mut gradient = self.problem.gradient(goal);
        for _ in 0..REFINEMENTS {
            let right = core::array::from_fn(|i| match self.active[i] {
                Side::Free => -gradient[i],
                _ => 0.0,
            });
            let step = factor.solve(&right);
            for i in 0..7 {
                goal[i] += step[i];
            }
            gradient = self.problem.gradient(goal);
        }
        gradient
    }

    /// Returns true if the guess that led to this minimum needs no correction.
    #[inline(always)]
    fn accepts(&self, goal: &JointVector, gradient: &[f64; 7]) -> bool {
        (0..7).all(|i| match self.active[i] {
            Side::Free => self.bounds.side_beyond(i, goal[i]) == Side::Free,
            side => self.inward(i, side, gradient[i]) == 0.0,
        })
    }

    /// Activates the bounds that `goal` exceeds, and frees the variables whose gradient points
    /// inside. Returns true if nothing changed.
    fn mend(&mut self, goal: &JointVector, gradient: &[f64; 7]) -> bool {
        let mut done = true;
        for i in 0..7 {
            match self.active[i] {
                Side::Free => {
                    self.x[i] = goal[i];
                    let side = self.bounds.side_beyond(i, goal[i]);
                    if side != Side::Free {
                        self.hold(i, side);
                        done = false;
                    }
                }
                side => {
                    if self.inward(i, side, gradient[i]) > 0.0 {
                        self.active[i] = Side::Free;
                        done = false;
                    }
                }
            }
        }
        done
    }

    /// Moves towards `goal` while the function decreases. Bounds on the path become active, and the
    /// path continues along them. If the path met no bound, the function frees the variable with
    /// the steepest descent into the box. Returns true if no variable can be freed.
    fn descend(&mut self, goal: &JointVector, gradient: &[f64; 7]) -> bool {
        if self.walk(goal) {
            return false;
        }
        let mut steepest = None;
        let mut slope = 0.0;
        for (i, gradient) in gradient.iter().enumerate() {
            let fall = self.inward(i, self.active[i], *gradient);
            if fall > slope {
                slope = fall;
                steepest = Some(i);
            }
        }
        if let Some(i) = steepest {
            self.active[i] = Side::Free;
        }
        steepest.is_none()
    }

    /// Moves to `goal`, and changes direction at every bound. Returns true if the path met a bound.
    fn walk(&mut self, goal: &JointVector) -> bool {
        let mut direction: [f64; 7] = core::array::from_fn(|i| match self.active[i] {
            Side::Free => goal[i] - self.x[i],
            _ => 0.0,
        });
        let mut left = 1.0;
        let mut met = false;
        loop {
            let (share, blocking) = self.first_bound(&direction, left);
            let share = if met {
                share.min(self.downhill(&direction))
            } else {
                share
            };
            for (i, d) in direction.iter().enumerate() {
                let x = self.x[i] + share * d;
                self.x[i] = x.max(self.bounds.lower[i]).min(self.bounds.upper[i]);
            }
            left -= share;
            let Some((i, side, until)) = blocking else {
                return met;
            };
            if share < until {
                return met; // uphill from here
            }
            self.hold(i, side);
            direction[i] = 0.0;
            met = true;
        }
    }

    /// Returns the share of `direction`, at most `left`, after which a variable meets a bound, and
    /// that bound.
    fn first_bound(&self, direction: &[f64; 7], left: f64) -> (f64, Option<(usize, Side, f64)>) {
        let mut share = left;
        let mut first = None;
        for (i, d) in direction.iter().enumerate() {
            let (side, bound) = if *d < 0.0 {
                (Side::Lower, self.bounds.lower[i])
            } else if *d > 0.0 {
                (Side::Upper, self.bounds.upper[i])
            } else {
                continue;
            };
            let until = ((bound - self.x[i]) / d).max(0.0);
            if until < share {
                share = until;
                first = Some((i, side, until));
            }
        }
        (share, first)
    }

    /// Returns the share of `direction` after which the objective increases again.
    fn downhill(&self, direction: &[f64; 7]) -> f64 {
        let gradient = self.problem.gradient(&self.x);
        let (mut slope, mut curvature) = (0.0, 0.0);
        for i in 0..7 {
            slope -= gradient[i] * direction[i];
            curvature += self.problem.normal[i][i] * direction[i] * direction[i];
            for j in 0..i {
                curvature += 2.0 * self.problem.normal[i][j] * direction[i] * direction[j];
            }
        }
        if slope > 0.0 { slope / curvature } else { 0.0 }
    }

    /// Returns the slope of the objective into the box at the bound that holds variable `i`. The
    /// slope is zero if it is only rounding error, or if the interval has no interior.
    #[inline(always)]
    fn inward(&self, i: usize, side: Side, gradient: f64) -> f64 {
        let fall = match side {
            Side::Free => return 0.0,
            Side::Lower => -gradient,
            Side::Upper => gradient,
        };
        if fall <= 0.0 || self.bounds.lower[i] == self.bounds.upper[i] {
            return 0.0;
        }
        let mut scale = self.problem.damping * (self.x[i] - self.problem.posture[i]).abs();
        for (a, t) in self.problem.rows.data.0[i]
            .iter()
            .zip(self.problem.task.iter())
        {
            scale += (a * t).abs();
        }
        if fall > ROUNDING * scale { fall } else { 0.0 }
    }

    /// Moves the point into the box, so that a descent can begin.
    fn settle(&mut self) {
        self.x = self.bounds.clamp(&self.x);
    }
}

/// Number of refinement steps for an exact minimum.
const REFINEMENTS: usize = 2;
/// Bound, relative to the terms of a gradient, below which the gradient is rounding error.
const ROUNDING: f64 = 1e-15;

#[cfg(test)]
mod tests;

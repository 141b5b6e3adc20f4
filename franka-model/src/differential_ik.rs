//! Joint velocities for a twist of the end effector, exactly within a box.
//!
//! ```text
//! minimise  |Jp x − vp|² + W² |Jo x − vo|² + λ² |x − x_posture|²   subject to  lower <= x <= upper
//! ```
//!
//! `x` are joint velocities and `(vp, vo)` is a twist, or both are displacements. In the nullspace
//! of the task, `x` follows the posture term. If a bound is active, the other joints compensate as
//! well as possible. Clamping an unbounded solution would neither follow the posture term nor
//! compensate.
//!
//! # Position first
//!
//! `W` weighs radians of orientation against metres of position. It has no effect if position and
//! orientation can both be met. Otherwise, joints are at their bounds or the arm is singular. The
//! small default then sacrifices the orientation, except for a share of `W²/r²`, where `r` is the
//! lever of the joints that turn the hand. The solver then adds the remaining position error to the
//! target and solves once more, which squares this share (one step of the method of multipliers:
//! Hestenes, 1969). The answer is continuous in all of its arguments.
//!
//! # Damping
//!
//! ```text
//! λ² = W² (floor² + ceiling² loss²) + position_ceiling² position_loss²
//! loss = max(0, 1 − w²/onset²)
//! ```
//!
//! The damping `floor` is too small to affect the motion visibly. The damping rises as the
//! manipulability `w` falls (Nakamura and Hanafusa, 1986, in `w²`). For the whole task, it rises in
//! proportion to the weight of orientations, which leaves the position undamped. For the position,
//! it rises only if the position itself loses a direction. `w²` is a polynomial in sines and
//! cosines of q, so `λ²` and its derivative are continuous along any path, and the first part does
//! not depend on the tool's length. Near a singularity, tracking ends smoothly, first in the
//! directions that need large joint velocities.

use crate::jacobian::squared_manipulabilities;
use crate::{Jacobian, JointVector, Twist};

pub use crate::box_qp::{JointBox, Outcome, PASSES_MAX, Side};
use crate::box_qp::{Problem, minimise};

/// Dependence of the damping `λ` on the manipulability; see the [module](self).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping {
    /// Damping far from singularities, in radians per radian. Its square is the share of a rotation
    /// that is not executed. It must be positive, because it makes the minimum unique.
    pub floor: f64,
    /// Additional damping in a singularity of the pose, in the same unit.
    pub ceiling: f64,
    /// Manipulability below which the damping rises. The ready pose has 0.080.
    pub onset: f64,
    /// Additional damping in a singularity of the position, metres per radian.
    pub position_ceiling: f64,
    /// Manipulability of the position, `sqrt(det(Jp Jpᵀ))` `[m³]`, below which the damping rises.
    /// Good postures have 0.1.
    pub position_onset: f64,
}

impl Default for Damping {
    /// Returns a damping that costs less than 10⁻⁵ of a rotation and 10⁻⁹ of a translation at the
    /// ready pose. In a singularity, an orientation requires at most 8 rad/s per rad/s. With a
    /// stretched elbow, a position may require hundreds of rad/s per m/s, if only a turn of the
    /// hand can keep it. The box then bounds the velocities.
    fn default() -> Self {
        Self {
            floor: 1.5e-3,
            ceiling: 0.067,
            onset: 0.025,
            position_ceiling: 0.005,
            position_onset: 0.003,
        }
    }
}

/// The parameters of the problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DifferentialIk {
    /// Position error, in metres, that weighs as much as one radian of orientation error; positive.
    pub orientation_weight: f64,
    /// True if the solver adds the position's residual to the target and solves again; see the
    /// [module](self).
    pub position_first: bool,
    /// Damping of the solution.
    pub damping: Damping,
}

impl DifferentialIk {
    /// Returns parameters that sacrifice position and orientation equally if both cannot be met. A
    /// radian counts as 0.3 m, about its effect at the far side of a held object.
    ///
    /// The joints are therefore slower near singularities: at most 50 rad/s per m/s, regardless of
    /// the box. Near a singularity, the hand leaves its line and returns to it later. Use these
    /// parameters for motions whose path does not matter.
    pub const fn smooth() -> Self {
        Self {
            orientation_weight: 0.3,
            position_first: false,
            damping: Damping {
                floor: 1e-4 / 0.3,
                ceiling: 0.02 / 0.3,
                onset: 0.025,
                position_ceiling: 0.0,
                position_onset: 1e-3,
            },
        }
    }
}

impl Default for DifferentialIk {
    /// Returns parameters with the position first: a radian counts as 4 mm.
    fn default() -> Self {
        Self {
            orientation_weight: 0.004,
            position_first: true,
            damping: Damping::default(),
        }
    }
}

/// The answer to one problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Joint velocities (or displacements), inside the box.
    pub velocity: JointVector,
    /// `J x − v`: the residual of the end effector's velocity, unweighted.
    pub residual: Twist,
    /// Active bounds. Pass them to the next, similar problem to save passes.
    pub active: [Side; 7],
    /// Result of the search. `velocity` is the minimum only with [`Outcome::Optimal`].
    pub outcome: Outcome,
    /// Number of factorisations.
    pub passes: usize,
}

impl DifferentialIk {
    /// Solves one problem in at most [`PASSES_MAX`] passes, for any arguments.
    ///
    /// `jacobian` and `twist` are in the same axes about the same point. `posture` is the preferred
    /// joint velocity in the nullspace of the task. `start` is the active set of the previous
    /// problem, or `Default::default()`; it affects the run time, not the answer.
    pub fn solve(
        &self,
        jacobian: &Jacobian,
        twist: &Twist,
        posture: &JointVector,
        bounds: &JointBox,
        start: [Side; 7],
    ) -> Solution {
        let (weighted, task) = self.weighted(jacobian, twist);
        let damping = self.squared_damping(jacobian);
        let problem = Problem::new(&weighted, &task, posture, damping);
        let mut minimum = minimise(&problem, bounds, start, PASSES_MAX);
        let first = jacobian * minimum.x - twist;
        let lacks = first.iter().take(3).any(|lack| lack.abs() > NOTHING);
        if self.position_first && lacks {
            let mut more = task;
            for i in 0..3 {
                more[i] -= first[i];
            }
            let again = Problem {
                task: &more,
                ..problem
            };
            let passes = minimum.passes;
            minimum = minimise(&again, bounds, minimum.active, PASSES_MAX - passes);
            minimum.passes += passes;
        }
        Solution {
            velocity: minimum.x,
            residual: jacobian * minimum.x - twist,
            active: minimum.active,
            outcome: minimum.outcome,
            passes: minimum.passes,
        }
    }

    /// Returns Jacobian and twist with their orientation rows in metres.
    #[inline(always)]
    fn weighted(&self, jacobian: &Jacobian, twist: &Twist) -> (Jacobian, Twist) {
        let (mut weighted, mut task) = (*jacobian, *twist);
        for column in weighted.data.0.iter_mut().chain(&mut task.data.0) {
            for orientation in &mut column[3..] {
                *orientation *= self.orientation_weight;
            }
        }
        (weighted, task)
    }

    /// Returns `λ²` for a Jacobian.
    pub fn squared_damping(&self, jacobian: &Jacobian) -> f64 {
        let Damping {
            floor,
            ceiling,
            onset,
            position_ceiling,
            position_onset,
        } = self.damping;
        let [position, pose] = squared_manipulabilities(jacobian);
        let lost = |squared: f64, onset: f64, ceiling: f64| {
            let loss = (1.0 - squared / (onset * onset)).max(0.0) * ceiling;
            loss * loss
        };
        let rotation = floor * floor + lost(pose, onset, ceiling);
        let weight = self.orientation_weight;
        weight * weight * rotation + lost(position, position_onset, position_ceiling)
    }
}

/// Residual velocity of the end effector, `[m/s]`, below which no second solution is computed.
const NOTHING: f64 = 1e-9;

#[cfg(test)]
mod tests;

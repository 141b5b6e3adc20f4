//! Joint velocities for a twist of the end effector, within exact bounds (a box).
//!
//! ```text
//! minimise  |Jp x − vp|² + W² |Jo x − vo|² + λ² |x − x_posture|²   subject to  lower <= x <= upper
//! ```
//!
//! `x` are joint velocities and `(vp, vo)` is a twist, or both are displacements. In the nullspace
//! of the task, `x` follows the posture term. If a bound is active, the other joints compensate as
//! well as possible. An unbounded solution that is clamped afterwards does neither.
//!
//! # Position first
//!
//! `W` weighs radians of orientation against metres of position. `W` has no effect if position and
//! orientation can both be met. If joints are at their bounds or the arm is singular, the small
//! default puts almost the whole error into the orientation. The position keeps a share of `W²/r²`,
//! where `r` is the lever of the joints that turn the hand. To reduce this share to its square, the
//! solver adds the remaining position error to the target and solves again (one step of the method
//! of multipliers: Hestenes, 1969). The answer is a continuous function of all arguments.
//!
//! # Damping
//!
//! ```text
//! λ² = W² (floor² + ceiling² loss²) + position_ceiling² position_loss²
//! loss = max(0, 1 − w²/onset²)
//! ```
//!
//! The damping `floor` is too small to affect the motion visibly. The damping rises as the
//! manipulability `w` falls (Nakamura and Hanafusa, 1986, in `w²`). For the whole task, the damping
//! is proportional to the weight of orientations, so the position stays undamped. For the position,
//! the damping rises only if the arm cannot move the position in some direction. `w²` is a
//! polynomial in sines and cosines of q, so `λ²` and its derivative are continuous along any path,
//! and the term with `loss` does not depend on the tool's length. Near a singularity, tracking ends
//! smoothly, first in the directions that need large joint velocities.

use crate::jacobian::squared_manipulabilities;
use crate::{Jacobian, JointVector, Twist};

pub use crate::box_qp::{JointBox, Outcome, PASSES_MAX, Side};
use crate::box_qp::{Problem, minimise};

/// Dependence of the damping `λ` on the manipulability; see the [module](self).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping {
    /// Damping far from singularities, in radians per radian. The square of this value is the share
    /// of a rotation that the arm does not execute. The value must be positive, because it makes
    /// the minimum unique.
    pub floor: f64,
    /// Additional damping in a singularity of the pose, in the same unit.
    pub ceiling: f64,
    /// Manipulability below which the damping rises. At the ready pose, the manipulability is
    /// 0.080.
    pub onset: f64,
    /// Additional damping in a singularity of the position, in metres per radian.
    pub position_ceiling: f64,
    /// Manipulability of the position, `sqrt(det(Jp Jpᵀ))` `[m³]`, below which the damping rises.
    /// In good postures, it is 0.1.
    pub position_onset: f64,
}

impl Default for Damping {
    /// Returns a damping that changes a rotation by less than 10⁻⁵ and a translation by less than
    /// 10⁻⁹ at the ready pose. In a singularity, a rotation of the hand requires joint velocities
    /// of at most 8 rad/s per rad/s. If the elbow is stretched, a translation may require hundreds
    /// of rad/s per m/s, because only turns of the hand can produce it.
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

/// Parameters of the problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DifferentialIk {
    /// Position error, in metres, that weighs as much as one radian of orientation error. It must
    /// be positive.
    pub orientation_weight: f64,
    /// True if the solver adds the position's residual to the target and solves again; see the
    /// [module](self).
    pub position_first: bool,
    /// Damping of the solution.
    pub damping: Damping,
}

impl DifferentialIk {
    /// Returns parameters that sacrifice position and orientation equally if both cannot be met. A
    /// radian counts as 0.3 m, which is about how far it moves the far side of a held object.
    ///
    /// Near singularities, the joints are therefore slower than with the default: at most 50 rad/s
    /// per m/s, regardless of the box. Near a singularity, the hand leaves its line and returns to
    /// it later. Use these parameters for motions whose path does not matter.
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
    /// Returns parameters that give the position priority over the orientation: a radian counts as
    /// 4 mm.
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
    /// Unweighted residual of the end effector's velocity, `J x − v`.
    pub residual: Twist,
    /// Active bounds. Pass them to the next, similar problem to save passes.
    pub active: [Side; 7],
    /// Result of the search. `velocity` is the minimum only if this is [`Outcome::Optimal`].
    pub outcome: Outcome,
    /// Number of factorisations.
    pub passes: usize,
}

impl DifferentialIk {
    /// Solves one problem in at most [`PASSES_MAX`] passes, for any arguments.
    ///
    /// `jacobian` and `twist` must use the same axes and the same reference point. `posture` is the
    /// preferred joint velocity in the nullspace of the task. `start` is the active set of the
    /// previous problem, or `Default::default()`; it affects the run time, not the answer.
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

    /// Returns the Jacobian and the twist with their orientation rows converted to metres.
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

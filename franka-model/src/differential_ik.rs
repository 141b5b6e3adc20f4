//! Joint velocities for a twist of the end effector, exactly inside a box.
//!
//! ```text
//! minimise  |W (J x − v)|² + λ² |x − x_posture|²   subject to  lower <= x <= upper
//! ```
//!
//! `x` are joint velocities and `v` a twist, or both displacements. `W` weighs radians of the task
//! against metres. Where the task leaves freedom, `x` follows the posture term; where a bound
//! binds, the other joints take over as far as they can. A clamp after the fact would do neither.
//!
//! # Damping
//!
//! `λ` is [`Damping::floor`] where the arm is well conditioned, small enough not to be seen in the
//! motion, and rises towards [`Damping::ceiling`] with the loss of manipulability `w`
//! (Nakamura and Hanafusa, 1986, in `w²`): `λ² = floor² + ceiling² (1 − w²/onset²)²` below
//! `w = onset`. `w²` is a polynomial in sines and cosines of q, so `λ²` and its derivative are
//! continuous along any path, and neither depends on the tool's length. Tracking near a singularity
//! is given up smoothly, in the directions that need large joint velocities first.

use crate::jacobian::squared_manipulability;
use crate::{Jacobian, JointVector, Twist};

use crate::box_qp::minimise;
pub use crate::box_qp::{JointBox, Outcome, PASSES_MAX, Side};

/// How `λ` depends on the manipulability; see the module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping {
    /// `λ` away from singularities, in the unit of the Jacobian. Must be positive: it makes the
    /// minimum unique.
    pub floor: f64,
    /// What `λ` reaches in a singularity.
    pub ceiling: f64,
    /// The manipulability below which `λ` rises; 0.080 at the ready pose.
    pub onset: f64,
}

impl Damping {
    /// `λ²` at a Jacobian.
    pub fn squared(&self, jacobian: &Jacobian) -> f64 {
        let ratio = squared_manipulability(jacobian) / (self.onset * self.onset);
        let loss = (1.0 - ratio).max(0.0) * self.ceiling;
        self.floor * self.floor + loss * loss
    }
}

impl Default for Damping {
    /// A floor that costs less than 10⁻⁶ of the twist at the ready pose, and a ceiling with which
    /// 0.1 m/s straight into a singularity asks for at most 1 rad/s.
    fn default() -> Self {
        Self {
            floor: 1e-4,
            ceiling: 0.05,
            onset: 0.02,
        }
    }
}

/// The constants of the problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DifferentialIk {
    /// Metres of position error that count as much as one radian of orientation error.
    pub orientation_weight: f64,
    /// How `λ` is chosen.
    pub damping: Damping,
}

impl Default for DifferentialIk {
    /// A radian counts as 0.3 m: about what it moves at the far side of a held object.
    fn default() -> Self {
        Self {
            orientation_weight: 0.3,
            damping: Damping::default(),
        }
    }
}

/// The answer to one problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// Joint velocities (or displacements), inside the box.
    pub velocity: JointVector,
    /// `J x − v`: what the end effector does beyond what was asked, unweighted.
    pub residual: Twist,
    /// Which bounds bind. Passing it to the next, similar problem saves passes.
    pub active: [Side; 7],
    /// Whether `velocity` is the minimum.
    pub outcome: Outcome,
    /// Factorisations that it took.
    pub passes: usize,
}

impl DifferentialIk {
    /// Solves one problem; at most [`PASSES_MAX`] passes, whatever the numbers.
    ///
    /// `jacobian` and `twist` are in the same axes about the same point. `posture` is the joint
    /// velocity to have where the task does not care. `start` is the active set of the problem
    /// before, or `Default::default()`: it changes the time, not the answer.
    pub fn solve(
        &self,
        jacobian: &Jacobian,
        twist: &Twist,
        posture: &JointVector,
        bounds: &JointBox,
        start: [Side; 7],
    ) -> Solution {
        let mut weighted = *jacobian;
        weighted
            .fixed_rows_mut::<3>(3)
            .scale_mut(self.orientation_weight);
        let mut task = *twist;
        task.fixed_rows_mut::<3>(3)
            .scale_mut(self.orientation_weight);

        let damping = self.damping.squared(jacobian);
        let mut hessian = weighted.tr_mul(&weighted);
        for i in 0..7 {
            hessian[(i, i)] += damping;
        }
        let linear = weighted.tr_mul(&task) + posture * damping;
        let minimum = minimise(&hessian, &linear, bounds, posture, start);
        Solution {
            velocity: minimum.x,
            residual: jacobian * minimum.x - twist,
            active: minimum.active,
            outcome: minimum.outcome,
            passes: minimum.passes,
        }
    }
}

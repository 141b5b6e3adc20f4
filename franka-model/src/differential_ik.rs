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

pub use crate::box_qp::{JointBox, Outcome, PASSES_MAX, Side};
use crate::box_qp::{Start, minimise};

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
    /// A floor that costs less than 10⁻⁵ of the twist at the ready pose. Ceiling and onset go
    /// together: at most 50 rad/s per m/s of end effector anywhere, and nearer to a singularity
    /// the box does the rest.
    fn default() -> Self {
        Self {
            floor: 1e-4,
            ceiling: 0.02,
            onset: 0.025,
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
        let start = Start {
            near: posture,
            active: start,
            passes_max: PASSES_MAX,
        };
        let minimum = minimise(&hessian, &linear, bounds, &start);
        Solution {
            velocity: minimum.x,
            residual: jacobian * minimum.x - twist,
            active: minimum.active,
            outcome: minimum.outcome,
            passes: minimum.passes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::{EndEffector, Frame, Model, READY, joint_vector};

    const UNBOUNDED: JointVector = joint_vector([f64::INFINITY; 7]);

    fn jacobian(q: &JointVector) -> Jacobian {
        Model::fr3().zero_jacobian(Frame::EndEffector, q, &EndEffector::default())
    }

    fn solve(
        jacobian: &Jacobian,
        twist: &Twist,
        posture: &JointVector,
        bound: &JointVector,
    ) -> Solution {
        let bounds = JointBox::symmetric(bound);
        DifferentialIk::default().solve(jacobian, twist, posture, &bounds, Default::default())
    }

    #[test]
    fn the_twist_is_met_where_nothing_binds() {
        let mut random = Random::new(51);
        let jacobian = jacobian(&READY);
        for _ in 0..100 {
            let twist = jacobian * random.joints(1.0);
            let solution = solve(&jacobian, &twist, &JointVector::zeros(), &UNBOUNDED);
            assert_eq!(solution.outcome, Outcome::Optimal);
            assert!(solution.residual.norm() < 1e-5 * twist.norm());
        }
    }

    #[test]
    fn the_posture_moves_the_joints_without_moving_the_hand() {
        let mut random = Random::new(52);
        let jacobian = jacobian(&READY);
        for _ in 0..100 {
            let posture = random.joints(1.0);
            let solution = solve(&jacobian, &Twist::zeros(), &posture, &UNBOUNDED);
            assert!(solution.residual.norm() < 1e-6);
            // What is left of the posture is its part in the nullspace: orthogonal to the rest.
            let rest = posture - solution.velocity;
            assert!(solution.velocity.dot(&rest).abs() < 1e-5);
            let nullspace_share =
                jacobian.transpose().svd(true, false).u.map(|range| {
                    (posture - range * range.tr_mul(&posture) - solution.velocity).norm()
                });
            assert!(nullspace_share.expect("asked for") < 1e-6);
        }
    }

    #[test]
    fn a_bound_joint_leaves_its_share_to_the_others() {
        // The elbow may not move fast, yet the hand goes sideways as asked.
        let jacobian = jacobian(&READY);
        let twist = Twist::new(0.0, 0.1, 0.0, 0.0, 0.0, 0.0);
        let free = solve(&jacobian, &twist, &JointVector::zeros(), &UNBOUNDED);
        let mut bound = UNBOUNDED;
        bound[0] = 0.5 * free.velocity[0].abs();
        let bound = solve(&jacobian, &twist, &JointVector::zeros(), &bound);
        assert_eq!(bound.velocity[0].abs(), 0.5 * free.velocity[0].abs());
        assert!(bound.active[0] != Side::Free);
        assert!(bound.residual.norm() < 1e-5 * twist.norm());
    }

    #[test]
    fn velocities_stay_inside_the_box_everywhere() {
        let mut random = Random::new(53);
        let limits = Model::fr3().joint_limits();
        for _ in 0..5000 {
            let q = random.posture(Model::fr3());
            let (lower, upper) = limits.velocity_envelope(&q, 0.0);
            let bounds = JointBox::new(&lower, &upper);
            let twist = Twist::from_fn(|_, _| random.uniform(-2.0, 2.0));
            let ik = DifferentialIk::default();
            let solution = ik.solve(
                &jacobian(&q),
                &twist,
                &random.joints(0.5),
                &bounds,
                Default::default(),
            );
            assert_eq!(solution.outcome, Outcome::Optimal);
            assert_eq!(bounds.clamp(&solution.velocity), solution.velocity);
        }
    }

    #[test]
    fn damping_bounds_the_joint_velocities_near_singularities() {
        let mut random = Random::new(54);
        let stretched = crate::elbow::FLIP_ANGLE;
        let mut singular = 0;
        for case in 0..20_000 {
            let mut q = random.posture(Model::fr3());
            let near = random.uniform(-0.1, 0.1);
            match case % 4 {
                0 => q[1] = near,                                // shoulder
                1 => q[4] = core::f64::consts::FRAC_PI_2 + near, // wrist
                2 => q[3] = stretched + near,                    // elbow
                _ => {}
            }
            let jacobian = jacobian(&q);
            let direction = random.vector3(1.0).normalize();
            let twist = Twist::new(direction.x, direction.y, direction.z, 0.0, 0.0, 0.0);
            let solution = solve(&jacobian, &twist, &JointVector::zeros(), &UNBOUNDED);
            assert!(solution.velocity.norm() < 50.0);
            singular += usize::from(squared_manipulability(&jacobian) < 1e-6);
        }
        assert!(singular > 1000);
    }

    #[test]
    fn damping_is_smooth_along_a_path_into_a_singularity() {
        let damping = Damping::default();
        // With all angles zero no axis points along x: the hand cannot roll.
        let at = |s: f64| damping.squared(&jacobian(&(READY * (1.0 - s))));
        let steps = 2000;
        let values: std::vec::Vec<f64> = (0..=steps)
            .map(|k| at(f64::from(k) / f64::from(steps)))
            .collect();
        let floor = damping.floor * damping.floor;
        let top = floor + damping.ceiling * damping.ceiling;
        assert_eq!(values[0], floor);
        assert!((values[values.len() - 1] - top).abs() < 1e-12);
        // First differences change gradually: no step in the derivative.
        for window in values.windows(3) {
            let bend = window[0] - 2.0 * window[1] + window[2];
            assert!(bend.abs() < 1e-4 * top, "{bend:e}");
        }
    }
}

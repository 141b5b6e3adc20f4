//! The inertia at the end effector. It is factorised once per cycle for the laws and the guards.
//!
//! `M` is the joint-space inertia and `J` the Jacobian. Then `W = J M^-1 J'` is the mobility of the
//! end effector, and `Lambda = W^-1` is its inertia (Khatib, IEEE Journal on Robotics and
//! Automation 3(1), 1987). The torques `tau` exert the wrench `Lambda J M^-1 tau` on a support that
//! keeps the end effector from moving.
//!
//! `W` is exact if the arm can move in all directions. Near a singularity, `W` is damped. Where the
//! inertia along an axis exceeds its value in [`GREATEST_INERTIA`], the damping grows smoothly from
//! zero to the inverse of that value. Therefore no result jumps, no division by zero occurs, and no
//! inertia along an axis exceeds four thirds of its value in that table.

use franka_model::{Dynamics, Jacobian, JointVector, MassMatrix, Wrench};
use nalgebra::{Cholesky, Const, Matrix3, SMatrix};

/// Inertia above which the end effector counts as unable to move in a direction: along x, y, z
/// `[kg]`, and about x, y, z `[kg m^2]`. At the ready pose the arm has 11 kg and 0.5 kg m^2 if all
/// other directions are held.
const GREATEST_INERTIA: [f64; 6] = [100.0, 100.0, 100.0, 5.0, 5.0, 5.0];

/// Inertia of the rotors at the joints, `[kg m^2]`. The robot's model does not contain it. It is
/// about the mean of the values in `mujoco_menagerie` for both arms. `franka_fr3` has 0.195 (joints
/// 1 to 4) and 0.074 (5 to 7), `franka_emika_panda` has 0.1. Not measured on a robot.
pub(crate) const ROTORS: [f64; 7] = [0.15, 0.15, 0.15, 0.15, 0.09, 0.09, 0.09];

#[derive(Debug)]
pub(crate) struct TaskSpace {
    /// `M = L L'`.
    mass: Cholesky<f64, Const<7>>,
    /// `L^-1 J'`.
    root: SMatrix<f64, 7, 6>,
    inertia: Cholesky<f64, Const<6>>,
    /// Inertia of the position with free rotation, and inertia of the rotation with free position.
    blocks: [Matrix3<f64>; 2],
}

impl TaskSpace {
    /// Computes the inertia from links and rotors together.
    #[inline]
    pub(crate) fn of(dynamics: &Dynamics) -> Self {
        let rotors = MassMatrix::from_diagonal(&ROTORS.into());
        Self::new(&dynamics.jacobian, &(dynamics.mass + rotors))
    }

    /// Replaces an unphysical `mass` (for example from an impossible load) with the identity. The
    /// geometry remains valid.
    fn new(jacobian: &Jacobian, mass: &MassMatrix) -> Self {
        let mass = Cholesky::new(*mass)
            .unwrap_or_else(|| Cholesky::pack_dirty(SMatrix::<f64, 7, 7>::identity()));
        let mut root = jacobian.transpose();
        mass.l_dirty()
            .solve_lower_triangular_unchecked_mut(&mut root);
        let mobility = root.tr_mul(&root);
        let block = |at: usize| {
            let block = mobility.fixed_view::<3, 3>(at, at).into_owned();
            let greatest = core::array::from_fn(|i| GREATEST_INERTIA[at + i]);
            damped(&block, &greatest).inverse()
        };
        Self {
            mass,
            root,
            inertia: damped(&mobility, &GREATEST_INERTIA),
            blocks: [block(0), block(3)],
        }
    }

    /// Returns the wrench that `tau` exerts on a support that keeps the end effector from moving,
    /// `Lambda J M^-1 tau`.
    pub(crate) fn reaction(&self, tau: &JointVector) -> Wrench {
        let mut half = *tau;
        self.mass
            .l_dirty()
            .solve_lower_triangular_unchecked_mut(&mut half);
        self.inertia.solve(&self.root.tr_mul(&half))
    }

    /// Returns how the joints move when the end effector's position is moved and its rotation is
    /// free, `[rad/m]`. The matrix is `M^-1 J' Lambda` of the position alone. Of all such motions,
    /// this motion has the least kinetic energy.
    ///
    /// The transpose maps torques to the force on a hand that holds the end effector at a point,
    /// `[N]`.
    pub(crate) fn yielding(&self) -> SMatrix<f64, 7, 3> {
        let mut yielding = self.root.fixed_columns::<3>(0) * self.blocks[0];
        self.mass
            .l_dirty()
            .tr_solve_lower_triangular_mut(&mut yielding);
        yielding
    }

    /// Returns the inertia of the end effector's position with free rotation.
    pub(crate) fn translational(&self) -> &Matrix3<f64> {
        &self.blocks[0]
    }

    /// Returns the inertia of the end effector's rotation with free position.
    pub(crate) fn rotational(&self) -> &Matrix3<f64> {
        &self.blocks[1]
    }
}

/// Returns the factorisation of a mobility, damped if an inertia exceeds `greatest`.
fn damped<const N: usize>(
    mobility: &SMatrix<f64, N, N>,
    greatest: &[f64; N],
) -> Cholesky<f64, Const<N>> {
    let factor = Cholesky::new(*mobility);
    // Ratio of the greatest inertia to the inertia along each axis while all other axes are held.
    // It is above zero if the mobility is not singular. A pivot of the factorisation would hold
    // only the axes before it, so it would not detect a direction that is lost along several axes
    // at once.
    let room = factor.as_ref().map_or(0.0, |factor| {
        let mut root = SMatrix::<f64, N, N>::identity();
        factor
            .l_dirty()
            .solve_lower_triangular_unchecked_mut(&mut root);
        let along = |i: usize| greatest[i] / root.column(i).norm_squared();
        (0..N).map(along).fold(1.0, f64::min)
    });
    match factor {
        Some(factor) if room >= 1.0 => factor,
        _ => {
            let mut raised = *mobility;
            for i in 0..N {
                raised[(i, i)] += (1.0 - room).powi(2) / greatest[i];
            }
            // If the input is not finite, which is not expected, the factor is replaced.
            Cholesky::new(raised).unwrap_or_else(|| Cholesky::pack_dirty(SMatrix::identity()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::{EndEffector, Frame, Load, Model, READY};

    const OBLIQUE: [f64; 7] = [0.0286, 1.3625, 2.5929, -0.4261, -2.2731, 2.3005, -2.0489];

    fn space_at(q: &JointVector) -> (TaskSpace, Jacobian, MassMatrix) {
        let jacobian = Model::fr3().zero_jacobian(Frame::EndEffector, q, &EndEffector::default());
        let mass = Model::fr3().mass(q, &Load::NONE);
        (TaskSpace::new(&jacobian, &mass), jacobian, mass)
    }

    #[test]
    fn torques_of_a_wrench_press_with_that_wrench() {
        let (space, jacobian, _) = space_at(&READY);
        let wrench = Wrench::new(10.0, -20.0, 5.0, 1.0, 0.5, -2.0);
        let reaction = space.reaction(&jacobian.tr_mul(&wrench));
        assert!((reaction - wrench).amax() < 1e-10, "{reaction}");
    }

    /// Computes the wrench that keeps the end effector from accelerating, from the full equations
    /// of motion.
    #[test]
    fn the_reaction_holds_the_end_effector_still() {
        let (space, jacobian, mass) = space_at(&READY);
        let tau = JointVector::from([5.0, -3.0, 2.0, 7.0, 1.0, -0.5, 0.3]);
        let held = tau - jacobian.tr_mul(&space.reaction(&tau));
        let inverse = mass.try_inverse().expect("a physical arm");
        assert!((jacobian * inverse * held).amax() < 1e-9);
        assert!((inverse * held).amax() > 0.1, "the elbow still moves");
    }

    #[test]
    fn task_space_agrees_with_the_models_operational_space() {
        let (space, jacobian, mass) = space_at(&READY);
        let model = franka_model::OperationalSpace::new(&jacobian, &mass).expect("physical");
        let translational = model.translational_inertia().expect("regular");
        let rotational = model.rotational_inertia().expect("regular");
        assert!((space.translational() - translational).amax() < 1e-9);
        assert!((space.rotational() - rotational).amax() < 1e-9);
    }

    #[test]
    fn the_damping_sets_in_without_a_jump() {
        let tau = JointVector::from([5.0, -3.0, 2.0, 7.0, 1.0, -0.5, 0.3]);
        let reaction = |elbow: f64| {
            let mut q = READY;
            q[3] = elbow;
            space_at(&q).0.reaction(&tau)
        };
        let (mut last, mut steps, mut greatest) = (reaction(-1.0), 0.0_f64, 0.0_f64);
        for i in 1..=20_000 {
            let now = reaction(-1.0 + 5e-5 * f64::from(i));
            steps = steps.max((now - last).amax());
            greatest = greatest.max(now.amax());
            last = now;
        }
        assert!(steps < 0.02 * greatest, "{steps} of {greatest}");
        assert!(greatest < 1e3, "{greatest}");
    }

    /// Moves between two postures where no pivot of the factorisation shows that a direction is
    /// lost.
    #[test]
    fn a_direction_that_is_lost_along_several_axes_is_damped() {
        let q = JointVector::from(OBLIQUE);
        let (space, jacobian, _) = space_at(&q);
        let least = jacobian.svd(false, false).singular_values.min();
        assert!(least < 5e-3, "{least}: it is all but lost");
        let inertia = space.inertia.inverse();
        for (axis, greatest) in GREATEST_INERTIA.into_iter().enumerate() {
            let along = inertia[(axis, axis)];
            assert!(along <= greatest * 4.0 / 3.0 + 1e-9, "axis {axis}: {along}");
        }
    }

    #[test]
    fn torques_press_on_a_point_as_on_a_wall_that_they_lean_on() {
        let (space, jacobian, mass) = space_at(&READY);
        let yielding = space.yielding();
        let position = jacobian.fixed_rows::<3>(0).into_owned();
        assert!((position * yielding - Matrix3::identity()).amax() < 1e-12);
        let tau = JointVector::from([5.0, -3.0, 2.0, 7.0, 1.0, -0.5, 0.3]);
        let inverse = mass.try_inverse().expect("a physical arm");
        let held = tau - position.tr_mul(&yielding.tr_mul(&tau));
        assert!((position * inverse * held).amax() < 1e-10);
    }

    #[test]
    fn a_mass_that_is_none_leaves_the_geometry() {
        let (_, jacobian, mass) = space_at(&READY);
        let space = TaskSpace::new(&jacobian, &-mass);
        let wrench = Wrench::new(10.0, -20.0, 5.0, 1.0, 0.5, -2.0);
        assert!((space.reaction(&jacobian.tr_mul(&wrench)) - wrench).amax() < 1e-9);
    }
}

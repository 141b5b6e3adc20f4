//! The inertia at the end effector, factorised once a cycle for all that need it.
//!
//! With the joint-space inertia `M` and the Jacobian `J`, `W = J M^-1 J'` is the mobility of the end effector and
//! `Lambda = W^-1` its inertia (Khatib, IEEE Journal on Robotics and Automation 3(1), 1987). The torques `tau` press with
//! the wrench `Lambda J M^-1 tau` on whoever holds the end effector still.
//!
//! `W` is taken as it is where the arm can move in all directions. Near a singularity it is damped: each pivot of its
//! factorisation that falls below a bound, one over the greatest inertia in [`GREATEST_INERTIA`], lets the damping grow
//! from zero, smoothly, to that bound. So nothing jumps and nothing divides by zero.

use franka_model::{Dynamics, Jacobian, JointVector, MassMatrix, Wrench};
use nalgebra::{Cholesky, Const, Matrix3, Matrix6, SMatrix};

/// Inertia, x y z `[kg]` and about x y z `[kg m^2]`, from which on a direction counts as lost. At the ready pose the
/// arm has 11 kg and 0.5 kg m^2 with all other directions held.
const GREATEST_INERTIA: [f64; 6] = [100.0, 100.0, 100.0, 5.0, 5.0, 5.0];

/// Inertia at the end effector, in base axes.
#[derive(Debug)]
pub(crate) struct TaskSpace {
    /// `M = L L'`.
    mass: Cholesky<f64, Const<7>>,
    /// `L^-1 J'`.
    root: SMatrix<f64, 7, 6>,
    /// Of the mobility.
    mobility: Matrix6<f64>,
    inertia: Cholesky<f64, Const<6>>,
}

impl TaskSpace {
    pub(crate) fn of(dynamics: &Dynamics) -> Self {
        Self::new(&dynamics.jacobian, &dynamics.mass)
    }

    /// A `mass` that is no physical arm's, as of a load that cannot be, counts as the identity: the geometry remains.
    fn new(jacobian: &Jacobian, mass: &MassMatrix) -> Self {
        let mass = Cholesky::new(*mass)
            .unwrap_or_else(|| Cholesky::pack_dirty(SMatrix::<f64, 7, 7>::identity()));
        let mut root = jacobian.transpose();
        mass.l_dirty()
            .solve_lower_triangular_unchecked_mut(&mut root);
        let mobility = root.tr_mul(&root);
        Self {
            mass,
            root,
            mobility,
            inertia: damped(&mobility, &GREATEST_INERTIA),
        }
    }

    /// The wrench with which `tau` presses on whoever holds the end effector still, `Lambda J M^-1 tau`.
    pub(crate) fn reaction(&self, tau: &JointVector) -> Wrench {
        let mut half = *tau;
        self.mass
            .l_dirty()
            .solve_lower_triangular_unchecked_mut(&mut half);
        self.inertia.solve(&self.root.tr_mul(&half))
    }

    /// Inertia of the end effector's position, its rotation left free.
    pub(crate) fn translational(&self) -> Matrix3<f64> {
        self.block(0)
    }

    /// Inertia about the end effector, its position left free.
    pub(crate) fn rotational(&self) -> Matrix3<f64> {
        self.block(3)
    }

    fn block(&self, at: usize) -> Matrix3<f64> {
        let block = self.mobility.fixed_view::<3, 3>(at, at).into_owned();
        let greatest = core::array::from_fn(|i| GREATEST_INERTIA[at + i]);
        damped(&block, &greatest).inverse()
    }
}

/// The factorisation of a mobility, damped where some inertia exceeds the `greatest`.
fn damped<const N: usize>(
    mobility: &SMatrix<f64, N, N>,
    greatest: &[f64; N],
) -> Cholesky<f64, Const<N>> {
    let factor = Cholesky::new(*mobility);
    // The least pivot against its bound: no mobility is singular while this is above zero.
    let room = factor.as_ref().map_or(0.0, |factor| {
        let pivot = |i: usize| factor.l_dirty()[(i, i)].powi(2) * greatest[i];
        (0..N).map(pivot).fold(1.0, f64::min)
    });
    match factor {
        Some(factor) if room >= 1.0 => factor,
        _ => {
            let mut raised = *mobility;
            for i in 0..N {
                raised[(i, i)] += (1.0 - room).powi(2) / greatest[i];
            }
            // Numbers that are none; the robot will not send them.
            Cholesky::new(raised).unwrap_or_else(|| Cholesky::pack_dirty(SMatrix::identity()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka_model::{EndEffector, Frame, Load, Model, READY};

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

    /// The wrench of the constraint that keeps the end effector from accelerating, from the equations of motion in full.
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
    fn agrees_with_the_operational_space_of_the_model_where_the_arm_is_regular() {
        let (space, jacobian, mass) = space_at(&READY);
        let model = franka_model::OperationalSpace::new(&jacobian, &mass).expect("physical");
        let translational = model.translational_inertia().expect("regular");
        let rotational = model.rotational_inertia().expect("regular");
        assert!((space.translational() - translational).amax() < 1e-9);
        assert!((space.rotational() - rotational).amax() < 1e-9);
    }

    /// Through the straight elbow, where the arm cannot reach further.
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

    #[test]
    fn a_mass_that_is_none_leaves_the_geometry() {
        let (_, jacobian, mass) = space_at(&READY);
        let space = TaskSpace::new(&jacobian, &-mass);
        let wrench = Wrench::new(10.0, -20.0, 5.0, 1.0, 0.5, -2.0);
        assert!((space.reaction(&jacobian.tr_mul(&wrench)) - wrench).amax() < 1e-9);
    }
}

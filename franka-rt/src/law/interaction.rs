//! The torques of springs and dampers for the error between arm and reference, under either law.

use franka_model::{Jacobian, JointVector};
use nalgebra::Matrix6;

use crate::law::blended_gains::BlendedGains;
use crate::law::operational;
use crate::law::task_space::TaskSpace;

/// The springs or the dampers of a law in one cycle, at the measured posture.
#[derive(Debug)]
pub(crate) struct Interaction<'a> {
    /// Gain matrix at the end effector, in base axes.
    cartesian: Matrix6<f64>,
    /// Gains at the joints.
    joint: JointVector,
    /// Weight of the null-space projection of the joints' gains.
    projection: f64,
    jacobian: &'a Jacobian,
    space: Option<&'a TaskSpace>,
}

impl<'a> Interaction<'a> {
    /// Returns the springs, which act on position errors, `[rad]`.
    ///
    /// If the gains [need](BlendedGains::needs_task_space) `space`, it must be `Some`. With `None`,
    /// the law is the hybrid law.
    pub(crate) fn springs(
        gains: &BlendedGains,
        jacobian: &'a Jacobian,
        space: Option<&'a TaskSpace>,
    ) -> Self {
        let diagonals = (&gains.cartesian_stiffness, &gains.joint_stiffness);
        Self::new(diagonals, gains, jacobian, space)
    }

    /// Returns the dampers, which act on velocity errors, `[rad/s]`. The argument `space` is the
    /// same as for the springs.
    pub(crate) fn dampers(
        gains: &BlendedGains,
        jacobian: &'a Jacobian,
        space: Option<&'a TaskSpace>,
    ) -> Self {
        let diagonals = (&gains.cartesian_damping, &gains.joint_damping);
        Self::new(diagonals, gains, jacobian, space)
    }

    fn new(
        (cartesian, joint): (&[f64; 6], &[f64; 7]),
        gains: &BlendedGains,
        jacobian: &'a Jacobian,
        space: Option<&'a TaskSpace>,
    ) -> Self {
        let plain = Matrix6::from_diagonal(&(*cartesian).into());
        let cartesian = match space {
            Some(space) if gains.operational > 0.0 => {
                plain + (operational::coupled(cartesian, space) - plain) * gains.operational
            }
            _ => plain,
        };
        Self {
            cartesian,
            joint: (*joint).into(),
            projection: gains.projection,
            jacobian,
            space,
        }
    }

    /// Returns the torques for these errors of the joints, `[N m]`.
    pub(crate) fn torques(&self, error: &JointVector) -> JointVector {
        let at_joints = self.joint.component_mul(error);
        let mut at_end_effector = self.cartesian * (self.jacobian * error);
        if let Some(space) = self.space.filter(|_| self.projection > 0.0) {
            at_end_effector -= space.reaction(&at_joints) * self.projection;
        }
        at_joints + self.jacobian.tr_mul(&at_end_effector)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Gains, Law, task_space};
    use franka_model::{
        Dynamics, EndEffector, GRAVITY_EARTH, Load, MassMatrix, Model, READY, Twist, Wrench,
    };
    use nalgebra::Matrix3;
    use proptest::prelude::*;

    /// Error of the arm from its reference, `[rad]`, and the velocity error for the dampers,
    /// `[rad/s]`.
    struct Errors {
        q: JointVector,
        dq: JointVector,
    }

    fn mobility(dynamics: &Dynamics) -> MassMatrix {
        let mass = dynamics.mass + MassMatrix::from_diagonal(&task_space::ROTORS.into());
        mass.try_inverse().expect("a physical arm")
    }

    fn dynamics_at(q: &JointVector, dq: &JointVector) -> Dynamics {
        let load = Load {
            mass: 0.73,
            ..Load::NONE
        };
        Model::fr3().dynamics(q, dq, &EndEffector::default(), &load, &GRAVITY_EARTH)
    }

    /// Returns `S Lambda S` of one block, and inverts the full inertia for it.
    fn coupled(block: Matrix3<f64>, gains: &[f64]) -> Matrix3<f64> {
        let inertia = block.try_inverse().expect("regular");
        let root = |i: usize| (gains[i] / inertia[(i, i)]).sqrt();
        Matrix3::from_fn(|i, j| root(i) * inertia[(i, j)] * root(j))
    }

    /// Computes the law from its definition, with every matrix written out in full.
    fn definition(gains: &Gains, errors: &Errors, dynamics: &Dynamics) -> JointVector {
        let jacobian = &dynamics.jacobian;
        let inverse = mobility(dynamics);
        let mobility = jacobian * inverse * jacobian.transpose();
        let at_end_effector = |diagonal: &[f64; 6]| {
            if gains.law == Law::Hybrid {
                return Matrix6::from_diagonal(&(*diagonal).into());
            }
            let mut matrix = Matrix6::zeros();
            for at in [0, 3] {
                let block = mobility.fixed_view::<3, 3>(at, at).into_owned();
                let block = coupled(block, &diagonal[at..at + 3]);
                matrix.fixed_view_mut::<3, 3>(at, at).copy_from(&block);
            }
            matrix
        };
        let projected = gains.project_joint_gains || gains.law == Law::OperationalSpace;
        let null_space = if projected {
            let inertia = mobility.try_inverse().expect("regular");
            MassMatrix::identity() - jacobian.transpose() * inertia * jacobian * inverse
        } else {
            MassMatrix::identity()
        };
        let matrix = |cartesian: &[f64; 6], joint: &[f64; 7]| {
            let joint = MassMatrix::from_diagonal(&(*joint).into());
            jacobian.transpose() * at_end_effector(cartesian) * jacobian + null_space * joint
        };
        matrix(&gains.cartesian_stiffness, &gains.joint_stiffness) * errors.q
            + matrix(&gains.cartesian_damping, &gains.joint_damping) * errors.dq
    }

    fn of(gains: &BlendedGains, errors: &Errors, dynamics: &Dynamics) -> JointVector {
        let (jacobian, space) = (&dynamics.jacobian, TaskSpace::of(dynamics));
        let springs = Interaction::springs(gains, jacobian, Some(&space));
        let dampers = Interaction::dampers(gains, jacobian, Some(&space));
        springs.torques(&errors.q) + dampers.torques(&errors.dq)
    }

    fn errors() -> Errors {
        Errors {
            q: JointVector::from_fn(|i, _| 0.03 - 0.01 * i as f64),
            dq: JointVector::from_fn(|i, _| 0.3 - 0.05 * i as f64),
        }
    }

    fn laws(gains: Gains) -> [Gains; 3] {
        [
            gains,
            Gains {
                project_joint_gains: true,
                ..gains
            },
            Gains {
                law: Law::OperationalSpace,
                ..gains
            },
        ]
    }

    fn joints(most: f64) -> impl Strategy<Value = JointVector> {
        prop::array::uniform7(-most..most).prop_map(JointVector::from)
    }

    fn anywhere() -> impl Strategy<Value = JointVector> {
        let limits = Model::fr3().joint_limits();
        prop::array::uniform7(0.0..1.0).prop_map(move |share| {
            JointVector::from_fn(|i, _| {
                limits.lower[i] + share[i] * (limits.upper[i] - limits.lower[i])
            })
        })
    }

    proptest! {
        #[test]
        fn equals_the_matrices_of_the_definition(offset in joints(0.4)) {
            let q = READY + offset;
            let dynamics = dynamics_at(&q, &JointVector::zeros());
            let errors = errors();
            for gains in [Gains::cartesian(), Gains::joint(), Gains::droid()] {
                for gains in laws(gains) {
                    let expected = definition(&gains, &errors, &dynamics);
                    let got = of(&BlendedGains::new(&gains, None), &errors, &dynamics);
                    // The inverse of the inertia has a condition number of 10^5.
                    let error = (got - expected).amax();
                    prop_assert!(error < 1e-8 * (1.0 + expected.amax()), "{gains:?}: {error}");
                }
            }
        }

        #[test]
        fn projected_joint_gains_do_not_move_the_end_effector(offset in joints(0.4)) {
            let q = READY + offset;
            let dynamics = dynamics_at(&q, &JointVector::zeros());
            let errors = errors();
            let gains = Gains { project_joint_gains: true, ..Gains::joint() };
            let tau = of(&BlendedGains::new(&gains, None), &errors, &dynamics);
            let inverse = mobility(&dynamics);
            let free = dynamics.jacobian * inverse * JointVector::from_fn(|i, _| 600.0 * errors.q[i]);
            let moved = dynamics.jacobian * inverse * tau;
            prop_assert!(moved.amax() < 1e-8 * (1.0 + free.amax()), "{moved} of {free}");
            prop_assert!(tau.amax() > 1e-3);
        }

        /// Includes stretched and folded arms, for which the inertia at the end effector is
        /// unbounded.
        #[test]
        fn is_bounded_at_every_pose(q in anywhere(), stretch in 0.0..1.0f64, error in joints(0.1)) {
            let mut q = q;
            // Joint 4 nearly straight and joint 6 near the axis: toward two singularities.
            q[3] *= stretch.powi(8);
            q[5] = (q[5] - core::f64::consts::PI) * stretch.powi(8) + core::f64::consts::PI;
            let dynamics = dynamics_at(&q, &JointVector::zeros());
            let pose = dynamics.jacobian * error;
            let space = TaskSpace::of(&dynamics);
            for gains in laws(Gains::cartesian()) {
                let gains = BlendedGains::new(&gains, None);
                let springs = Interaction::springs(&gains, &dynamics.jacobian, Some(&space));
                let tau = springs.torques(&error);
                prop_assert!(tau.iter().all(|tau| tau.is_finite()));
                // Correlations are at most one, so each other axis adds at most the geometric mean
                // of the two gains.
                let wrench = springs.cartesian * pose;
                prop_assert!(wrench.amax() <= 750.0 * pose.abs().sum() * 1.01);
                // In the metric of the inertia, the projection of a vector is no longer than the
                // vector.
                let length = |tau: &JointVector| (tau.dot(&(mobility(&dynamics) * tau))).sqrt();
                let joints = JointVector::from(gains.joint_stiffness).component_mul(&error);
                let rest = tau - dynamics.jacobian.tr_mul(&wrench);
                prop_assert!(length(&rest) <= length(&joints) * (1.0 + 1e-6));
            }
        }

        /// Springs return no more energy than they stored, and dampers only dissipate energy,
        /// because the matrices at the end effector are symmetric and positive semidefinite.
        #[test]
        fn the_dampers_at_the_end_effector_only_take_energy(q in anywhere(), dq in joints(1.0)) {
            let dynamics = dynamics_at(&q, &dq);
            let space = TaskSpace::of(&dynamics);
            for gains in laws(Gains::cartesian()) {
                let gains = BlendedGains::new(&gains, None);
                let dampers = Interaction::dampers(&gains, &dynamics.jacobian, Some(&space));
                let twist: Twist = dynamics.jacobian * dq;
                let wrench: Wrench = dampers.cartesian * -twist;
                prop_assert!(wrench.dot(&twist) <= 1e-9);
            }
        }
    }

    #[test]
    fn every_law_is_silent_at_rest_on_the_reference() {
        let dynamics = dynamics_at(&READY, &JointVector::zeros());
        let zero = JointVector::zeros();
        let errors = Errors { q: zero, dq: zero };
        for gains in laws(Gains::cartesian()) {
            assert_eq!(
                of(&BlendedGains::new(&gains, None), &errors, &dynamics),
                zero
            );
        }
    }

    /// In the middle of a fade between two laws, the torque is the mean of the two laws' torques,
    /// so the transition is even.
    #[test]
    fn a_change_of_law_goes_evenly_from_torque_to_torque() {
        let dynamics = dynamics_at(&READY, &JointVector::zeros());
        let errors = errors();
        let [plain, projected, operational] =
            laws(Gains::cartesian()).map(|gains| BlendedGains::new(&gains, None));
        let at = |gains| of(&gains, &errors, &dynamics);
        for (from, to) in [(plain, projected), (plain, operational)] {
            assert!((at(from) - at(to)).amax() > 0.1);
            let mut fade = crate::law::fade::Fade::at(from);
            fade.towards(to);
            for cycle in 1..=300 {
                let share = f64::from(cycle) / 300.0;
                let expected = at(from) * (1.0 - share) + at(to) * share;
                assert!((at(fade.step()) - expected).amax() < 1e-9, "cycle {cycle}");
            }
        }
    }
}

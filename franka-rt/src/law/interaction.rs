//! Both laws as one: what the springs and dampers do about how far the arm is from its reference.

use franka_model::{Jacobian, JointVector, Twist, Wrench};

use crate::law::hybrid::{self, Reference};
use crate::law::operational;
use crate::law::task_space::TaskSpace;
use crate::law::tuning::Tuning;

/// How far the arm is from its reference, at the joints and at the end effector.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Errors {
    /// Of the positions, `[rad]`.
    pub(crate) q: JointVector,
    /// Of the velocities that the dampers see, `[rad/s]`.
    pub(crate) dq: JointVector,
    /// Of the pose, to first order, `[m]` and `[rad]`.
    pub(crate) pose: Twist,
    /// Of the twist, `[m/s]` and `[rad/s]`.
    pub(crate) twist: Twist,
}

impl Errors {
    /// At the measured `q` and `dq`; `feedforward` is the velocity that the dampers let pass.
    pub(crate) fn new(
        reference: &Reference,
        feedforward: &JointVector,
        q: &JointVector,
        dq: &JointVector,
        jacobian: &Jacobian,
    ) -> Self {
        let q = reference.q - q;
        let dq = feedforward - dq;
        Self {
            q,
            dq,
            pose: jacobian * q,
            twist: jacobian * dq,
        }
    }
}

/// Torques of springs and dampers, before shaping.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interaction {
    /// Of those at the end effector alone, base axes, `[N]` and `[N m]`.
    pub(crate) wrench: Wrench,
    /// Of all of them, `[N m]`.
    pub(crate) tau: JointVector,
}

impl Interaction {
    /// `space` has to be there if the tuning [needs](Tuning::needs_task_space) it; without it the law is the hybrid one.
    pub(crate) fn new(
        tuning: &Tuning,
        errors: &Errors,
        jacobian: &Jacobian,
        space: Option<&TaskSpace>,
    ) -> Self {
        let joints = JointVector::from_fn(|i, _| {
            tuning.joint_stiffness[i] * errors.q[i] + tuning.joint_damping[i] * errors.dq[i]
        });
        let mut wrench = hybrid::wrench(tuning, errors);
        let mut at_end_effector = wrench;
        if let Some(space) = space {
            if tuning.operational > 0.0 {
                let other = operational::wrench(tuning, errors, space);
                wrench += (other - wrench) * tuning.operational;
            }
            at_end_effector = wrench;
            if tuning.projection > 0.0 {
                at_end_effector -= space.reaction(&joints) * tuning.projection;
            }
        }
        Self {
            wrench,
            tau: joints + jacobian.tr_mul(&at_end_effector),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Gains, Law};
    use franka_model::{Dynamics, EndEffector, GRAVITY_EARTH, Load, Model, READY};
    use nalgebra::{Matrix3, Matrix6, SMatrix};
    use proptest::prelude::*;

    type Matrix7 = SMatrix<f64, 7, 7>;

    fn dynamics_at(q: &JointVector, dq: &JointVector) -> Dynamics {
        let load = Load {
            mass: 0.73,
            ..Load::NONE
        };
        Model::fr3().dynamics(q, dq, &EndEffector::default(), &load, &GRAVITY_EARTH)
    }

    /// `S Lambda S` of one block, its inertia formed by inverting in full.
    fn coupled(block: Matrix3<f64>, gains: &[f64]) -> Matrix3<f64> {
        let inertia = block.try_inverse().expect("regular");
        let root = |i: usize| (gains[i] / inertia[(i, i)]).sqrt();
        Matrix3::from_fn(|i, j| root(i) * inertia[(i, j)] * root(j))
    }

    /// The law as its definition has it, every matrix formed in full.
    fn definition(gains: &Gains, errors: &Errors, dynamics: &Dynamics) -> JointVector {
        let jacobian = &dynamics.jacobian;
        let inverse = dynamics.mass.try_inverse().expect("a physical arm");
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
            Matrix7::identity() - jacobian.transpose() * inertia * jacobian * inverse
        } else {
            Matrix7::identity()
        };
        let matrix = |cartesian: &[f64; 6], joint: &[f64; 7]| {
            let joint = Matrix7::from_diagonal(&(*joint).into());
            jacobian.transpose() * at_end_effector(cartesian) * jacobian + null_space * joint
        };
        matrix(&gains.cartesian_stiffness, &gains.joint_stiffness) * errors.q
            + matrix(&gains.cartesian_damping, &gains.joint_damping) * errors.dq
    }

    fn of(gains: &Gains, errors: &Errors, dynamics: &Dynamics) -> Interaction {
        let space = TaskSpace::of(dynamics);
        let tuning = Tuning::new(gains, None);
        Interaction::new(&tuning, errors, &dynamics.jacobian, Some(&space))
    }

    fn errors_at(q: &JointVector, dynamics: &Dynamics) -> Errors {
        let reference = Reference::at_rest(q + JointVector::from_fn(|i, _| 0.03 - 0.01 * i as f64));
        let dq = JointVector::from_fn(|i, _| 0.1 * i as f64 - 0.3);
        let feedforward = JointVector::from_fn(|i, _| 0.05 * i as f64);
        Errors::new(&reference, &feedforward, q, &dq, &dynamics.jacobian)
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
            let errors = errors_at(&q, &dynamics);
            for gains in [Gains::cartesian(), Gains::joint(), Gains::droid()] {
                for gains in laws(gains) {
                    let expected = definition(&gains, &errors, &dynamics);
                    let got = of(&gains, &errors, &dynamics).tau;
                    // The inverse of the inertia has a condition of 10^5.
                    let error = (got - expected).amax();
                    prop_assert!(error < 1e-8 * (1.0 + expected.amax()), "{gains:?}: {error}");
                }
            }
        }

        /// What is projected does not accelerate the end effector.
        #[test]
        fn projected_joint_gains_do_not_move_the_end_effector(offset in joints(0.4)) {
            let q = READY + offset;
            let dynamics = dynamics_at(&q, &JointVector::zeros());
            let errors = errors_at(&q, &dynamics);
            let gains = Gains { project_joint_gains: true, ..Gains::joint() };
            let tau = of(&gains, &errors, &dynamics).tau;
            let inverse = dynamics.mass.try_inverse().expect("a physical arm");
            let free = dynamics.jacobian * inverse * JointVector::from_fn(|i, _| 600.0 * errors.q[i]);
            let moved = dynamics.jacobian * inverse * tau;
            prop_assert!(moved.amax() < 1e-8 * (1.0 + free.amax()), "{moved} of {free}");
            prop_assert!(tau.amax() > 1e-3);
        }

        /// Also where the arm is stretched out or folded, where inertias at the end effector have no bound.
        #[test]
        fn is_bounded_at_every_pose(q in anywhere(), stretch in 0.0..1.0f64, error in joints(0.1)) {
            let mut q = q;
            // Joint 4 near straight and joint 6 near the axis: toward two singularities.
            q[3] *= stretch.powi(8);
            q[5] = (q[5] - core::f64::consts::PI) * stretch.powi(8) + core::f64::consts::PI;
            let dynamics = dynamics_at(&q, &JointVector::zeros());
            let errors = Errors {
                q: error,
                dq: error * 10.0,
                pose: dynamics.jacobian * error,
                twist: dynamics.jacobian * error * 10.0,
            };
            for gains in laws(Gains::cartesian()) {
                let interaction = of(&gains, &errors, &dynamics);
                prop_assert!(interaction.tau.iter().all(|tau| tau.is_finite()));
                // Correlations are at most one: each axis adds at most the geometric mean of its gain and the other's.
                let most: f64 = (0..6)
                    .map(|i| 90.0_f64.max(750.0) * (errors.pose[i].abs() + errors.twist[i].abs()))
                    .sum();
                prop_assert!(interaction.wrench.amax() <= most * 1.01);
                // In the metric of the inertia a projection is no longer than what is projected.
                let length = |tau: &JointVector| {
                    let inverse = dynamics.mass.try_inverse().expect("a physical arm");
                    (tau.dot(&(inverse * tau))).sqrt()
                };
                let joints = JointVector::from_fn(|i, _| {
                    gains.joint_stiffness[i] * errors.q[i] + gains.joint_damping[i] * errors.dq[i]
                });
                let rest = interaction.tau - dynamics.jacobian.tr_mul(&interaction.wrench);
                prop_assert!(length(&rest) <= length(&joints) * (1.0 + 1e-6));
            }
        }

        /// Springs give back no more than they took, dampers only take: the matrices at the end effector are symmetric
        /// and not negative.
        #[test]
        fn the_dampers_at_the_end_effector_only_take_energy(q in anywhere(), dq in joints(1.0)) {
            let dynamics = dynamics_at(&q, &dq);
            let errors = Errors {
                q: JointVector::zeros(),
                dq: -dq,
                pose: Twist::zeros(),
                twist: dynamics.jacobian * -dq,
            };
            for gains in laws(Gains::cartesian()) {
                let wrench = of(&gains, &errors, &dynamics).wrench;
                prop_assert!(wrench.dot(&errors.twist) >= -1e-9);
            }
        }
    }

    #[test]
    fn every_law_is_silent_at_rest_on_the_reference() {
        let dynamics = dynamics_at(&READY, &JointVector::zeros());
        let zero = JointVector::zeros();
        let errors = Errors::new(
            &Reference::at_rest(READY),
            &zero,
            &READY,
            &zero,
            &dynamics.jacobian,
        );
        for gains in laws(Gains::cartesian()) {
            assert_eq!(of(&gains, &errors, &dynamics).tau, zero);
        }
    }

    /// The middle of a fade between two laws is the mean of their torques, so the way from one to the other is even.
    #[test]
    fn a_change_of_law_goes_evenly_from_torque_to_torque() {
        let dynamics = dynamics_at(&READY, &JointVector::zeros());
        let errors = errors_at(&READY, &dynamics);
        let space = TaskSpace::of(&dynamics);
        let [plain, projected, operational] =
            laws(Gains::cartesian()).map(|gains| Tuning::new(&gains, None));
        let at = |tuning| Interaction::new(&tuning, &errors, &dynamics.jacobian, Some(&space)).tau;
        for (from, to) in [(plain, projected), (plain, operational)] {
            assert!((at(from) - at(to)).amax() > 0.1);
            let mut fade = crate::law::tuning::Fade::at(from);
            fade.towards(to);
            for cycle in 1..=300 {
                let share = f64::from(cycle) / 300.0;
                let expected = at(from) * (1.0 - share) + at(to) * share;
                assert!((at(fade.step()) - expected).amax() < 1e-9, "cycle {cycle}");
            }
        }
    }
}

//! The force cap: spring and damper together press on whoever holds the end effector with no more than this force.
//!
//! The leash bounds the spring alone. A quick push lets the damper add to it, and the springs of the joints press at the
//! end effector too; this guard is about their sum.
//!
//! The force is that of the wrench with which the arm presses on a hand that holds the end effector still. Of the
//! springs and dampers at the end effector it is their own wrench, at every pose. What the joints' springs add, and what
//! the torque clamp takes away, goes through the dynamically consistent inverse, `Lambda J M^-1 tau`: of all inverses of
//! `J'` it is the one that the equations of motion have for an end effector that does not move, and it does not count
//! torques that only move the elbow. Near singularities, where a small torque may press with any force along the
//! direction that is lost, that second share is damped and reads low; the first never does.
//!
//! Where the force exceeds the cap, the whole wrench is scaled down to it. Its direction and the torques of the null
//! space stay, and in the metric of the inertia no torque grows. Scaling spring and damper alike makes of them a
//! saturated spring and damper: at full force the arm still brakes before it reaches its reference, since the sum changes
//! its sign where it did before.

use core::ops::RangeInclusive;

use franka_model::{Jacobian, JointVector};

use crate::law::interaction::Interaction;
use crate::law::task_space::TaskSpace;

/// Force caps that a goal may have, `[N]`. Below, friction alone would keep the arm from following.
pub const FORCE_CAP: RangeInclusive<f64> = 5.0..=200.0;

/// The force cap of goals that do not say another, `[N]`: of poses, of rest and of guiding.
///
/// Just above the weight of the robot's whole payload of 3 kg, and above what the default gains come to when the arm is held
/// back without a push. Motions within the default budget do not meet it (simulated: none of their cycles, also with 3 kg
/// declared and with 0.5 kg undeclared), while a hand that pushes against a held arm at 0.25 m/s would meet 39 to 49 N
/// without it. Goals of joint positions have no cap by default: their way may lead through postures in which the end effector
/// cannot move along some direction, where a small torque of the joints counts as a large force.
pub const DEFAULT_FORCE_CAP: f64 = 30.0;

/// Holds the force of `interaction` under `cap`, `[N]`; gives the torques, `[N m]`, and tells whether it bound.
pub(crate) fn hold(
    interaction: &Interaction,
    cap: f64,
    jacobian: &Jacobian,
    space: &TaskSpace,
) -> (JointVector, bool) {
    let Interaction { wrench, tau } = interaction;
    let wrench = wrench + space.reaction(&(tau - jacobian.tr_mul(wrench)));
    let force = wrench.fixed_rows::<3>(0).norm();
    if force <= cap {
        return (*tau, false);
    }
    let excess = wrench * (1.0 - cap / force);
    (tau - jacobian.tr_mul(&excess), true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::hybrid::Reference;
    use crate::law::interaction::Errors;
    use crate::law::tuning::Tuning;
    use crate::law::{Gains, Law, shaping};
    use franka_model::{Dynamics, EndEffector, GRAVITY_EARTH, Load, Model, READY};
    use nalgebra::Vector3;
    use proptest::prelude::*;

    fn dynamics_at(q: &JointVector) -> Dynamics {
        let still = JointVector::zeros();
        let ee = EndEffector::default();
        Model::fr3().dynamics(q, &still, &ee, &Load::NONE, &GRAVITY_EARTH)
    }

    /// The force on a hand that holds the end effector still, every matrix inverted in full.
    fn force(tau: &JointVector, dynamics: &Dynamics) -> Vector3<f64> {
        let jacobian = &dynamics.jacobian;
        let inverse = dynamics.mass.try_inverse().expect("a physical arm");
        let mobility = jacobian * inverse * jacobian.transpose();
        let inertia = mobility.try_inverse().expect("regular");
        (inertia * jacobian * inverse * tau)
            .fixed_rows::<3>(0)
            .into_owned()
    }

    fn interaction(
        gains: &Gains,
        dynamics: &Dynamics,
        q: JointVector,
        dq: JointVector,
    ) -> Interaction {
        let errors = Errors {
            q,
            dq,
            pose: dynamics.jacobian * q,
            twist: dynamics.jacobian * dq,
        };
        let tuning = Tuning::new(gains, None);
        let space = TaskSpace::of(dynamics);
        let free = Interaction::new(&tuning, &errors, &dynamics.jacobian, Some(&space));
        let (tau, _) = shaping::clamp(&free.tau, &shaping::TORQUE_CLAMP.into());
        Interaction { tau, ..free }
    }

    fn joints(most: f64) -> impl Strategy<Value = JointVector> {
        prop::array::uniform7(-most..most).prop_map(JointVector::from)
    }

    fn gains() -> impl Strategy<Value = Gains> {
        let base = prop::sample::select(vec![Gains::cartesian(), Gains::joint(), Gains::droid()]);
        (base, 0.1..4.0f64, any::<bool>(), any::<bool>()).prop_map(
            |(base, factor, project_joint_gains, operational)| Gains {
                cartesian_stiffness: base.cartesian_stiffness.map(|k| k * factor),
                joint_damping: base.joint_damping.map(|d| d * factor),
                project_joint_gains,
                law: if operational {
                    Law::OperationalSpace
                } else {
                    Law::Hybrid
                },
                ..base
            },
        )
    }

    proptest! {
        #[test]
        fn no_force_exceeds_the_cap_and_its_direction_stays(
            offset in joints(0.4),
            error in joints(0.1),
            velocity in joints(1.0),
            gains in gains(),
            cap in FORCE_CAP,
        ) {
            let dynamics = dynamics_at(&(READY + offset));
            let free = interaction(&gains, &dynamics, error, velocity);
            let space = TaskSpace::of(&dynamics);
            let (tau, binds) = hold(&free, cap, &dynamics.jacobian, &space);
            let (before, after) = (force(&free.tau, &dynamics), force(&tau, &dynamics));
            prop_assert!(after.norm() <= cap * (1.0 + 1e-9), "{} of {cap}", after.norm());
            if binds {
                prop_assert!((after.norm() - cap).abs() <= cap * 1e-9);
                prop_assert!((after.normalize() - before.normalize()).amax() < 1e-8);
            } else {
                prop_assert_eq!(tau, free.tau);
            }
        }

        #[test]
        fn near_singularities_torques_stay_bounded(
            mut q in joints(2.5),
            stretch in 0.0..1.0f64,
            error in joints(0.1),
            gains in gains(),
            cap in FORCE_CAP,
        ) {
            q[3] = -2.0 * stretch.powi(8);
            let dynamics = dynamics_at(&q);
            let free = interaction(&gains, &dynamics, error, error);
            let space = TaskSpace::of(&dynamics);
            let (tau, _) = hold(&free, cap, &dynamics.jacobian, &space);
            prop_assert!(tau.iter().all(|tau| tau.is_finite()));
            let inverse = dynamics.mass.try_inverse().expect("a physical arm");
            let length = |tau: &JointVector| tau.dot(&(inverse * tau)).sqrt();
            // What the damping leaves of the wrench of the springs at the end effector may be as long once more.
            let springs = dynamics.jacobian.tr_mul(&free.wrench);
            prop_assert!(length(&tau) <= length(&free.tau) + length(&springs) + 1e-6);
        }
    }

    #[test]
    fn sets_in_without_a_step() {
        let dynamics = dynamics_at(&READY);
        let space = TaskSpace::of(&dynamics);
        let error = JointVector::from_fn(|i, _| 0.03 - 0.01 * i as f64);
        let at = |scale: f64| {
            let free = interaction(&Gains::cartesian(), &dynamics, error * scale, error * scale);
            hold(&free, 10.0, &dynamics.jacobian, &space)
        };
        let (mut last, mut bound) = (at(0.0), 0);
        for i in 1..=1000 {
            let now = at(3e-3 * f64::from(i));
            assert!((now.0 - last.0).amax() < 0.05, "step {i}");
            bound += u32::from(now.1 != last.1);
            last = now;
        }
        assert_eq!(bound, 1, "binds from somewhere on");
    }

    /// An arm let go a good way off its stiff reference, under a small cap: it comes to rest there and gains no energy.
    #[test]
    fn an_arm_at_full_force_does_not_swing_up() {
        const STEP: f64 = 1e-3;
        let gains =
            Gains::cartesian().with_cartesian_stiffness([1500.0, 1500.0, 1500.0, 30.0, 30.0, 30.0]);
        let (model, ee) = (Model::fr3(), EndEffector::default());
        let reference = Reference::at_rest(READY);
        let tuning = Tuning::new(&gains, Some(10.0));
        let mut q = READY + JointVector::from_fn(|i, _| 0.08 - 0.03 * i as f64);
        let mut dq = JointVector::zeros();
        let (mut bound, mut greatest) = (0, 0.0_f64);
        for cycle in 0..4000 {
            let dynamics = model.dynamics(&q, &dq, &ee, &Load::NONE, &GRAVITY_EARTH);
            let space = TaskSpace::of(&dynamics);
            let errors = Errors::new(
                &reference,
                &JointVector::zeros(),
                &q,
                &dq,
                &dynamics.jacobian,
            );
            let free = Interaction::new(&tuning, &errors, &dynamics.jacobian, Some(&space));
            let (tau, binds) = hold(&free, 10.0, &dynamics.jacobian, &space);
            bound += u32::from(binds);
            // Rotors weigh about as much as this at the joint, and Coriolis torques cancel.
            let mass = dynamics.mass + nalgebra::SMatrix::<f64, 7, 7>::identity() * 0.1;
            dq += mass.try_inverse().expect("positive definite") * tau * STEP;
            q += dq * STEP;
            if cycle > 1000 {
                greatest = greatest.max(dq.amax());
            }
        }
        assert!(bound > 100, "{bound} cycles");
        assert!(dq.amax() < 1e-2, "{dq}");
        assert!((q - READY).amax() < 2e-2, "{q}");
        assert!(greatest < 0.5, "{greatest} rad/s after a second");
    }
}

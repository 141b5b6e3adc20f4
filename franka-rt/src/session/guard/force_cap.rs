//! The force cap: limits the total force of springs and dampers on a person's hand that holds the
//! end effector.
//!
//! The leash bounds only the spring. In a quick push, the damper adds to the spring, and the
//! springs of the joints also press at the end effector. This guard limits the sum of these forces.
//! The torques of the motion itself (inertia and Coriolis) are added after the guard.
//!
//! The limited force is the force on a hand that holds the end effector at a point:
//! `Lambda J M^-1 tau`, with the `J` and `Lambda` of the position alone. It follows from the
//! equations of motion if that point does not move while the rest of the arm may move. If the arm
//! rests against a wall, it is the force on the wall. Torques that only turn the hand or move the
//! elbow do not count.
//!
//! Near a singularity, a small torque may cause any force in the direction in which the end
//! effector cannot move. The computed force is damped there, and too low. The position has few
//! singularities. If the rotation were also held, there would be many more, and joint paths pass
//! through them. Every torque would count as thousands of newtons there.
//!
//! First the force of the spring is reduced to the cap, and then the sum of spring and damper.
//! Therefore the damper still brakes an arm that returns to its reference at full force, and only
//! the excess over the cap is removed. If spring and damper were scaled together, their sum would
//! be a constant force without damping.
//!
//! The excess over the cap is removed as a force at the end effector, `J' (F - F')`. The torques
//! that turn the hand and move the elbow do not change. An arm that leans on an obstacle stays in
//! balance. In the metric of the inertia, neither the torques of the springs nor the torques of the
//! dampers grow.

use core::ops::RangeInclusive;

use franka_model::{Jacobian, JointVector};
use nalgebra::Vector3;

use crate::law::task_space::TaskSpace;

/// Greatest force that springs and dampers may exert at the end effector.
///
/// Only the session's own law supports a cap. If the robot's controller turns setpoints into
/// torques ([`Backend::RobotController`](crate::session::Backend::RobotController)), a goal with
/// [`Self::Newtons`] is refused.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ForceCap {
    /// The cap is [`Self::DEFAULT_NEWTONS`].
    #[default]
    Default,
    /// The cap in newtons, within [`Self::RANGE`].
    Newtons(f64),
    /// No cap: springs and dampers exert their full force.
    Off,
}

impl ForceCap {
    /// Accepted force caps, `[N]`. With a lower cap, friction alone could keep the arm from
    /// following.
    pub const RANGE: RangeInclusive<f64> = 5.0..=200.0;

    /// Default force cap of goals, `[N]`.
    ///
    /// It is just above the weight of the robot's full payload, 3 kg. It is also above the force of
    /// the default gains while the arm is held back without a push.
    ///
    /// In simulated motions within the default budget, the force never reached this cap, even with
    /// 3 kg declared or 0.5 kg undeclared. Without a cap, a hand that pushes against a held arm at
    /// 0.25 m/s would meet 40 to 54 N, and 67 to 115 N with stiff joints.
    pub const DEFAULT_NEWTONS: f64 = 30.0;

    /// Returns the cap, `[N]`; `None` without a cap.
    pub fn newtons(self) -> Option<f64> {
        match self {
            Self::Default => Some(Self::DEFAULT_NEWTONS),
            Self::Newtons(newtons) => Some(newtons),
            Self::Off => None,
        }
    }
}

/// Limits the force of `springs` and `dampers`, given as torques `[N m]`, to `cap`, `[N]`. Returns
/// the sum of the limited torques, and true if the cap changed it.
pub(crate) fn hold(
    springs: &JointVector,
    dampers: &JointVector,
    cap: f64,
    jacobian: &Jacobian,
    space: &TaskSpace,
) -> (JointVector, bool) {
    let yielding = space.yielding();
    let (pull, damping) = (yielding.tr_mul(springs), yielding.tr_mul(dampers));
    let held = within(&(within(&pull, cap) + damping), cap);
    let excess = pull + damping - held;
    let tau = springs + dampers;
    if excess == Vector3::zeros() {
        return (tau, false);
    }
    (tau - jacobian.fixed_rows::<3>(0).tr_mul(&excess), true)
}

/// Shortens the force to the length `most`, if it is longer.
fn within(force: &Vector3<f64>, most: f64) -> Vector3<f64> {
    let length = force.norm();
    if length <= most {
        *force
    } else {
        force * (most / length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::blended_gains::BlendedGains;
    use crate::law::interaction::Interaction;
    use crate::law::{Gains, Law, task_space};
    use franka_model::{
        CYCLE, Dynamics, EndEffector, GRAVITY_EARTH, Load, MassMatrix, Model, READY,
    };
    use proptest::prelude::*;

    fn dynamics_at(q: &JointVector) -> Dynamics {
        let still = JointVector::zeros();
        let ee = EndEffector::default();
        Model::fr3().dynamics(q, &still, &ee, &Load::NONE, &GRAVITY_EARTH)
    }

    fn mobility(dynamics: &Dynamics) -> MassMatrix {
        let mass = dynamics.mass + MassMatrix::from_diagonal(&task_space::ROTORS.into());
        mass.try_inverse().expect("a physical arm")
    }

    /// Returns the force on a hand that holds the end effector at a point. Inverts every matrix in
    /// full.
    fn force(tau: &JointVector, dynamics: &Dynamics) -> Vector3<f64> {
        let jacobian = dynamics.jacobian.fixed_rows::<3>(0).into_owned();
        let inverse = mobility(dynamics);
        let point = jacobian * inverse * jacobian.transpose();
        point.try_inverse().expect("regular") * jacobian * inverse * tau
    }

    fn torques(
        gains: &Gains,
        dynamics: &Dynamics,
        q: &JointVector,
        dq: &JointVector,
    ) -> (JointVector, JointVector) {
        let tuning = BlendedGains::new(gains, None);
        let (jacobian, space) = (&dynamics.jacobian, TaskSpace::of(dynamics));
        let springs = Interaction::springs(&tuning, jacobian, Some(&space));
        let dampers = Interaction::dampers(&tuning, jacobian, Some(&space));
        (springs.torques(q), dampers.torques(dq))
    }

    fn held(
        (springs, dampers): &(JointVector, JointVector),
        cap: f64,
        dynamics: &Dynamics,
    ) -> (JointVector, bool) {
        let space = TaskSpace::of(dynamics);
        hold(springs, dampers, cap, &dynamics.jacobian, &space)
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
        fn no_force_exceeds_the_cap(
            offset in joints(0.4),
            error in joints(0.1),
            velocity in joints(1.0),
            gains in gains(),
            cap in ForceCap::RANGE,
        ) {
            let dynamics = dynamics_at(&(READY + offset));
            let free = torques(&gains, &dynamics, &error, &velocity);
            let (tau, binds) = held(&free, cap, &dynamics);
            let after = force(&tau, &dynamics).norm();
            prop_assert!(after <= cap * (1.0 + 1e-9), "{after} of {cap}");
            if !binds {
                prop_assert_eq!(tau, free.0 + free.1);
            }
        }

        /// If a spring is stretched too far, its force keeps its direction, and the damper brakes
        /// it with its full force.
        #[test]
        fn a_damper_brakes_a_spring_at_full_force(
            offset in joints(0.4),
            error in joints(0.1),
            gains in gains(),
            share in 0.0..1.0f64,
        ) {
            let dynamics = dynamics_at(&(READY + offset));
            let (springs, _) = torques(&gains, &dynamics, &error, &error);
            let free = force(&springs, &dynamics);
            prop_assume!(free.norm() > 1.0);
            let cap = free.norm() / 2.0;
            let pull = free / 2.0;
            let dampers = dynamics.jacobian.fixed_rows::<3>(0).tr_mul(&(pull * -share));
            let (tau, binds) = held(&(springs, dampers), cap, &dynamics);
            prop_assert!(binds);
            let left = force(&tau, &dynamics) - pull * (1.0 - share);
            prop_assert!(left.amax() < 1e-8 * (1.0 + cap), "{left}");
        }

        #[test]
        fn near_singularities_torques_do_not_grow(
            mut q in joints(2.5),
            stretch in 0.0..1.0f64,
            error in joints(0.1),
            gains in gains(),
            cap in ForceCap::RANGE,
        ) {
            q[3] = -2.0 * stretch.powi(8);
            let dynamics = dynamics_at(&q);
            let free = torques(&gains, &dynamics, &error, &error);
            let (tau, _) = held(&free, cap, &dynamics);
            let inverse = mobility(&dynamics);
            let length = |tau: &JointVector| tau.dot(&(inverse * tau)).sqrt();
            let most = length(&free.0) + length(&free.1);
            prop_assert!(length(&tau) <= most * (1.0 + 1e-6), "{tau}");
        }
    }

    #[test]
    fn sets_in_without_a_step() {
        let dynamics = dynamics_at(&READY);
        let error = JointVector::from_fn(|i, _| 0.03 - 0.01 * i as f64);
        let at = |scale: f64| {
            let error = error * scale;
            let free = torques(&Gains::cartesian(), &dynamics, &error, &error);
            held(&free, 10.0, &dynamics)
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

    /// An arm is released far from its stiff reference, under a small cap. It stops at the
    /// reference and gains no energy.
    #[test]
    fn an_arm_at_full_force_does_not_swing_up() {
        let stiff =
            Gains::cartesian().with_cartesian_stiffness([1500.0, 1500.0, 1500.0, 30.0, 30.0, 30.0]);
        for gains in [stiff, Gains::joint()] {
            let (model, ee) = (Model::fr3(), EndEffector::default());
            let mut q = READY + JointVector::from_fn(|i, _| 0.08 - 0.03 * i as f64);
            let mut dq = JointVector::zeros();
            let (mut bound, mut greatest) = (0, 0.0_f64);
            for cycle in 0..6000 {
                let dynamics = model.dynamics(&q, &dq, &ee, &Load::NONE, &GRAVITY_EARTH);
                let free = torques(&gains, &dynamics, &(READY - q), &-dq);
                let (tau, binds) = held(&free, 10.0, &dynamics);
                bound += u32::from(binds);
                // Coriolis torques cancel each other.
                dq += mobility(&dynamics) * tau * CYCLE;
                q += dq * CYCLE;
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
}

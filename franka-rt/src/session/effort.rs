//! Computes torques from a reference. The law comes first, then the guards of the torques, then the
//! robot's limits.
//!
//! ```text
//! springs, dampers, compensation -> clamp -> force cap -> + coriolis + M ddq_ref -> clamp -> velocity barrier -> low-pass -> rate
//! ```

use franka_model::limits::JointLimits;
use franka_model::{Dynamics, Jacobian, JointVector, MassMatrix, Wrench};
use franka_proto::RobotState;
use nalgebra::Matrix6;

use crate::law::Gains;
use crate::law::blended_gains::BlendedGains;
use crate::law::compensation::{Compensation, Demand, Learned};
use crate::law::fade::Fade;
use crate::law::interaction::Interaction;
use crate::law::task_space::{ROTORS, TaskSpace};
use crate::session::guard::torque_clamp::{LimitedTorque, clamp};
use crate::session::guard::torque_rate::limit_rate;
use crate::session::guard::{force_cap, velocity_barrier};
use crate::session::reference::Reference;
use crate::session::{Bindings, Goal, Guard};
use crate::shaping::filter;

/// Values of the law that the next cycle needs.
#[derive(Debug)]
pub(super) struct Effort {
    fade: Fade<BlendedGains>,
    /// Low-passed reference velocity, `[rad/s]`.
    feedforward: JointVector,
    inertia: Inertia,
    compensation: Compensation,
    /// Compensation in the last cycle, `[N m]`.
    compensated: JointVector,
    /// Torques of springs, dampers and compensation in the last cycle, after the clamp and the
    /// force cap, `[N m]`.
    interaction: JointVector,
    /// Torques of springs and compensation in the last cycle, before the clamp, `[N m]`.
    asked: JointVector,
    /// Torques that the law demanded in the last cycle, before the low-pass and the rate limit,
    /// `[N m]`.
    demanded: JointVector,
    /// True if the clamp or the force cap changed a torque in the last cycle.
    bound: bool,
}

/// Response of the law to an obstacle that holds back an arm at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Resistance {
    /// The law assumes that friction holds the arm, and increases its torques.
    Overcome,
    /// The arm rests on the obstacle, and presses on it with its springs alone.
    Yield,
    /// The motion ends, and its torques fade.
    Release,
}

/// The reference's acceleration, which is fed forward as a torque.
///
/// The leash can move the reference with a pushed arm. The reference then accelerates as fast as
/// the joints' bounds allow, and torques for that acceleration would push back. Therefore the
/// feedforward fades out meanwhile. It fades in again while the leash does not hold the reference.
#[derive(Debug)]
struct Inertia {
    /// Acceleration, `[rad/s^2]`.
    acceleration: JointVector,
    /// Number of cycles since the leash last held the reference.
    free: u32,
}

impl Inertia {
    /// Returns the acceleration to feed forward in a cycle with this `reference`. `leashed` is true
    /// if the leash holds the reference.
    fn step(&mut self, reference: &JointVector, leashed: bool) -> JointVector {
        self.free = if leashed {
            0
        } else {
            self.free.saturating_add(1)
        };
        let weight = (f64::from(self.free) / f64::from(RETURN)).min(1.0);
        let towards = if weight < 1.0 { FADE } else { 1.0 };
        self.acceleration += (reference * weight - self.acceleration) * towards;
        self.acceleration
    }
}

/// Keeps the wrench finite at a singular posture, `[m^2]`.
const SINGULAR: f64 = 1e-6;

/// Number of cycles without the leash after which the whole acceleration of the reference counts
/// again.
const RETURN: u32 = 300;

/// Part of the remaining difference that the acceleration covers in one cycle: it fades in about
/// ten cycles.
const FADE: f64 = 0.1;

impl Effort {
    /// Starts with the gains of the first goal, for a reference at rest.
    pub(super) fn new(goal: &Goal) -> Self {
        Self {
            fade: Fade::at(BlendedGains::new(&goal.gains, goal.force_cap.newtons())),
            feedforward: JointVector::zeros(),
            inertia: Inertia {
                acceleration: JointVector::zeros(),
                free: RETURN,
            },
            compensation: Compensation::new(Learned::default()),
            compensated: JointVector::zeros(),
            interaction: JointVector::zeros(),
            asked: JointVector::zeros(),
            demanded: JointVector::zeros(),
            bound: false,
        }
    }

    pub(super) fn know(&mut self, learned: Learned) {
        self.compensation = Compensation::new(learned);
    }

    pub(super) fn learned(&self) -> Learned {
        self.compensation.learned()
    }

    pub(super) fn compensated(&self) -> JointVector {
        self.compensated
    }

    pub(super) fn demanded(&self) -> &JointVector {
        &self.demanded
    }

    /// Returns the end-effector wrench that best matches the last torques, for an arm at rest,
    /// `[N, N m]`.
    pub(super) fn pull(&self, jacobian: &Jacobian) -> Wrench {
        let damped = jacobian * jacobian.transpose() + Matrix6::identity() * SINGULAR;
        let pull = jacobian * self.interaction;
        damped.cholesky().map_or(pull, |factor| factor.solve(&pull))
    }

    /// Returns the joint whose torque a limit reduced most in the last cycle, compared with the
    /// torque of its springs and its compensation, if any.
    pub(super) fn limited(&self) -> Option<LimitedTorque> {
        let most = JointVector::from(self.fade.now().torque_limits);
        LimitedTorque::worst(&self.asked, &most)
    }

    /// True if the compensation still grows in order to move a joint that rests away from its
    /// target.
    pub(super) fn is_working(&self) -> bool {
        self.compensation.is_working()
    }

    pub(super) fn take_up(&mut self, goal: &Goal) {
        self.fade
            .towards(BlendedGains::new(&goal.gains, goal.force_cap.newtons()));
    }

    /// Returns the torques of one cycle, `[N m]`. `dynamics` must be computed at the measured
    /// positions and velocities. `met` is true if the goal has reacted to a contact.
    pub(super) fn step(
        &mut self,
        reference: &Reference,
        state: &RobotState,
        dynamics: &Dynamics,
        limits: &JointLimits,
        (resistance, met): (Resistance, bool),
        bindings: &mut Bindings,
    ) -> JointVector {
        let (q, dq) = (JointVector::from(state.q), JointVector::from(state.dq));
        let last = JointVector::from(state.tau_J_d);
        let tuning = self.fade.step();
        let most = JointVector::from(tuning.torque_limits);
        self.feedforward = reference.dq.zip_map(&self.feedforward, |newest, filtered| {
            filter::mix(tuning.feedforward_share, newest, filtered)
        });

        let jacobian = &dynamics.jacobian;
        let space = tuning.needs_task_space().then(|| TaskSpace::of(dynamics));
        let feedforward = self.feedforward * tuning.feedforward;
        let springs = Interaction::springs(&tuning, jacobian, space.as_ref());
        let dampers = Interaction::dampers(&tuning, jacobian, space.as_ref());
        let error = reference.q - q;
        let springs = springs.torques(&error);
        let leashed = bindings.contains(Guard::Leash);
        self.compensated = self.compensation.step(&Demand {
            dq_ref: &reference.dq,
            ddq_ref: &reference.ddq,
            dq: &dq,
            error: &error,
            springs: &springs,
            bounds: &tuning.compensation,
            held: self.bound || leashed || resistance == Resistance::Yield,
            met,
            ending: resistance == Resistance::Release,
        });
        let springs = springs + self.compensated;
        self.asked = springs;
        let dampers = dampers.torques(&(feedforward - dq));
        let (tau, clamped) = clamp(&(springs + dampers), &most);
        let (tau, capped) = match (tuning.force_cap(), &space) {
            (Some(cap), Some(space)) => {
                // The dampers get the part of the clamp that the springs have not used.
                let (springs, _) = clamp(&springs, &most);
                force_cap::hold(&springs, &(tau - springs), cap, jacobian, space)
            }
            _ => (tau, false),
        };
        self.bound = clamped || capped;
        self.interaction = tau;
        // The clamp and the cap bound only the interaction, so the torques of the motion itself are
        // added after them.
        let acceleration = self.inertia.step(&reference.ddq, leashed);
        let mass = dynamics.mass + MassMatrix::from_diagonal(&ROTORS.into());
        let inertial = mass * (acceleration * tuning.feedforward);
        let (tau, full) = clamp(&(tau + dynamics.coriolis + inertial), &most);
        let brake = JointVector::from(Gains::TORQUE_LIMITS);
        let (tau, braked) = velocity_barrier::brake(&tau, (&q, &dq), reference, limits, &brake);
        self.demanded = tau;
        let filtered = low_pass(tuning.torque_share, &tau, &last);
        let (tau, slowed) = limit_rate(&filtered, &last, &limits.torque_rate);

        bindings.set(Guard::TorqueClamp, clamped || full);
        bindings.set(Guard::ForceCap, capped);
        bindings.set(Guard::VelocityBarrier, braked);
        bindings.set(Guard::TorqueRate, slowed);
        tau
    }
}

/// Applies a low-pass to `tau`: returns the mean of `tau`, with weight `share`, and of the last
/// torques that the robot accepted, `tau_J_d` of its state.
pub(super) fn low_pass(share: f64, tau: &JointVector, last: &JointVector) -> JointVector {
    tau.zip_map(last, |tau, last| filter::mix(share, tau, last))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leashed_acceleration_fades_and_returns_without_a_step() {
        let mut inertia = Inertia {
            acceleration: JointVector::zeros(),
            free: RETURN,
        };
        let asked = JointVector::repeat(5.0);
        assert_eq!(inertia.step(&asked, false), asked);
        let mut last = 5.0;
        for cycle in 0..1000 {
            // The leash holds the reference in some cycles and not in others.
            let leashed = cycle < 200 && cycle % 7 < 5;
            let now = inertia.step(&asked, leashed)[0];
            assert!((now - last).abs() <= 5.0 * FADE + 1e-9, "{cycle}: {now}");
            assert!(!(100..200).contains(&cycle) || now < 0.1, "{cycle}: {now}");
            last = now;
        }
        assert_eq!(last, 5.0);
    }
}

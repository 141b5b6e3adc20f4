//! From a reference to torques: the law, then the guards of the torques, then what the robot accepts.
//!
//! ```text
//! springs and dampers -> clamp -> force cap -> + coriolis + M ddq_ref -> velocity barrier -> robot's range -> low-pass -> rate
//! ```

use franka_model::limits::JointLimits;
use franka_model::{Dynamics, JointVector};
use franka_proto::RobotState;

use crate::law::hybrid::Reference;
use crate::law::interaction::{Errors, Interaction};
use crate::law::shaping;
use crate::law::task_space::TaskSpace;
use crate::law::tuning::{Fade, Tuning};
use crate::session::guard::{force_cap, velocity_barrier};
use crate::session::{Bindings, Goal, Guard};
use crate::shaping::filter;

/// What the law remembers between cycles.
#[derive(Debug)]
pub(super) struct Effort {
    fade: Fade,
    /// Reference velocity behind its low-pass, `[rad/s]`.
    feedforward: JointVector,
}

impl Effort {
    /// With the gains of the first goal, for a reference at rest.
    pub(super) fn new(goal: &Goal) -> Self {
        Self {
            fade: Fade::at(Tuning::new(&goal.gains, goal.force_cap)),
            feedforward: JointVector::zeros(),
        }
    }

    /// Goes over to the gains and the force cap of another goal.
    pub(super) fn take_up(&mut self, goal: &Goal) {
        self.fade.towards(Tuning::new(&goal.gains, goal.force_cap));
    }

    /// The torques of one cycle, `[N m]`; `dynamics` is taken at the measured positions and velocities.
    pub(super) fn step(
        &mut self,
        reference: &Reference,
        state: &RobotState,
        dynamics: &Dynamics,
        limits: &JointLimits,
        bindings: &mut Bindings,
    ) -> JointVector {
        let (q, dq) = (JointVector::from(state.q), JointVector::from(state.dq));
        let last = JointVector::from(state.tau_J_d);
        let most = JointVector::from(shaping::TORQUE_CLAMP);
        let tuning = self.fade.step();
        self.feedforward = reference.dq.zip_map(&self.feedforward, |newest, filtered| {
            filter::mix(tuning.feedforward_share, newest, filtered)
        });

        let jacobian = &dynamics.jacobian;
        let space = tuning.needs_task_space().then(|| TaskSpace::of(dynamics));
        let feedforward = self.feedforward * tuning.feedforward;
        let errors = Errors::new(reference, &feedforward, &q, &dq, jacobian);
        let free = Interaction::new(&tuning, &errors, jacobian, space.as_ref());
        let (tau, clamped) = shaping::clamp(&free.tau, &most);
        let clipped = Interaction { tau, ..free };
        let (tau, capped) = match (tuning.force_cap(), &space) {
            (Some(cap), Some(space)) => force_cap::hold(&clipped, cap, jacobian, space),
            _ => (tau, false),
        };
        // What the motion itself takes stays outside the clamp and the cap, which are for the interaction.
        let inertial = dynamics.mass * (reference.ddq * tuning.feedforward);
        let tau = tau + dynamics.coriolis + inertial;
        let (tau, braked) = velocity_barrier::brake(&tau, &dq, &limits.velocity, &most);
        let (tau, full) = shaping::clamp(&tau, &limits.torque);
        let filtered = shaping::low_pass(&tau, &last);
        let (tau, slowed) = shaping::limit_rate(&filtered, &last, &limits.torque_rate);

        bindings.set(Guard::TorqueClamp, clamped || full);
        bindings.set(Guard::ForceCap, capped);
        bindings.set(Guard::VelocityBarrier, braked);
        bindings.set(Guard::TorqueRate, slowed);
        tau
    }
}

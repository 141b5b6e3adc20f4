//! The generator of joint positions. A moving target is at rest in a frame that moves with the
//! target. The plan is made in that frame.

use franka_model::limits::JointLimits;
use franka_otg::{AxisLimits, Generator, Limits, PlanError, State};

use crate::session::course::limits_of_joint;
use crate::session::reference::Reference;
use crate::session::{Budget, Target, approach, budget};
use crate::shaping::CYCLE;

/// Time for which a moving joint target must stay inside the joint's range, `[s]`: the time of its
/// extrapolation, and the same time again for the stop that follows.
const ROOM: f64 = 2e-3 * Target::MOVES_ON_MS as f64;

/// Target of the joints: positions `[rad]`, and their velocities `[rad/s]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MovingJoints {
    pub(super) q: [f64; 7],
    pub(super) dq: [f64; 7],
}

/// Moves the joints to their target, one nominal millisecond per step.
#[derive(Debug)]
pub(super) struct JointGenerator {
    /// Generator of the axes, in a frame that moves at `drift`. The frame was at rest at zero when
    /// the plan was made.
    axes: Generator<7>,
    /// Velocity of the frame, `[rad/s]`.
    drift: [f64; 7],
    /// Cycles since the plan was made.
    cycles: u32,
    /// Target and budget of the plan, if the target moves.
    planned: Option<(MovingJoints, Budget)>,
}

impl JointGenerator {
    /// Creates a generator that begins at `reference` and moves to `target`. Without a target, it
    /// stops in the least time.
    ///
    /// # Errors
    /// Returns the errors of [`Generator`]. Goals are checked when they are accepted, so only a
    /// defect can cause an error.
    pub(super) fn new(
        robot: &JointLimits,
        reference: &Reference,
        target: Option<MovingJoints>,
        budget: &Budget,
    ) -> Result<Self, PlanError> {
        let plan = Plan::new(robot, reference, target, budget)?;
        Ok(Self {
            axes: Generator::towards(plan.state, plan.limits, plan.to.as_ref())?,
            drift: plan.drift,
            cycles: 0,
            planned: plan.planned,
        })
    }

    /// Moves from `reference` to another target. Without a target, stops. If the target's motion
    /// continues as before, the plan stays as it is.
    ///
    /// # Errors
    /// As for [`Self::new`]; the motion in progress continues.
    pub(super) fn head_for(
        &mut self,
        robot: &JointLimits,
        reference: &Reference,
        target: Option<MovingJoints>,
        budget: &Budget,
    ) -> Result<(), PlanError> {
        if let (Some(target), Some(before)) = (target, &self.planned)
            && self.is_followed(&target, before, budget)
        {
            return Ok(());
        }
        let plan = Plan::new(robot, reference, target, budget)?;
        self.axes
            .restart(plan.state, plan.limits, plan.to.as_ref())?;
        self.drift = plan.drift;
        self.cycles = 0;
        self.planned = plan.planned;
        Ok(())
    }

    /// True if the plan already leads to the motion of `target`, except for rounding errors.
    fn is_followed(
        &self,
        target: &MovingJoints,
        (before, budget_before): &(MovingJoints, Budget),
        budget: &Budget,
    ) -> bool {
        let t = self.time();
        let near = |i: usize| (before.q[i] + before.dq[i] * t - target.q[i]).abs() < ROUNDING;
        // If the frame is slower than the target, it falls behind the target.
        before.dq == target.dq
            && self.drift == target.dq
            && budget_before == budget
            && (0..7).all(near)
    }

    /// Stops within the limits of the plan. If the joints move on a line, they stop on that line.
    ///
    /// # Errors
    /// As for [`Self::new`]; the motion in progress continues.
    pub(super) fn halt(&mut self) -> Result<(), PlanError> {
        self.planned = None;
        if self.drift == [0.0; 7] {
            self.axes.brake();
            return Ok(());
        }
        let Reference { q, dq, ddq } = self.reference();
        let state = State {
            position: q.into(),
            velocity: dq.into(),
            acceleration: ddq.into(),
        };
        let limits = *self.axes.limits();
        self.axes.restart(state, limits, None)?;
        self.drift = [0.0; 7];
        self.cycles = 0;
        Ok(())
    }

    /// Sets the joint positions to `q`, `[rad]`, keeps their velocities, and plans anew from there.
    ///
    /// # Errors
    /// As for [`Self::new`]; the motion in progress continues.
    pub(super) fn set_positions(&mut self, q: [f64; 7]) -> Result<(), PlanError> {
        let t = self.time();
        self.axes.set_state(State {
            position: core::array::from_fn(|i| q[i] - self.drift[i] * t),
            ..*self.axes.state()
        })
    }

    /// Advances by one nominal millisecond.
    pub(super) fn step(&mut self) -> Reference {
        self.cycles = self.cycles.saturating_add(1);
        self.axes.step();
        self.reference()
    }

    fn reference(&self) -> Reference {
        let State {
            position,
            velocity,
            acceleration,
        } = *self.axes.state();
        let (drift, t) = (&self.drift, self.time());
        Reference {
            q: core::array::from_fn(|i| position[i] + drift[i] * t).into(),
            dq: core::array::from_fn(|i| velocity[i] + drift[i]).into(),
            ddq: acceleration.into(),
        }
    }

    /// Returns the seconds since the plan was made.
    fn time(&self) -> f64 {
        f64::from(self.cycles) * CYCLE
    }

    pub(super) fn is_done(&self) -> bool {
        self.axes.is_done()
    }

    /// Returns the end positions of a plan that leads to rest, `[rad]`.
    #[cfg(test)]
    pub(super) fn end(&self) -> [f64; 7] {
        *self.axes.end()
    }

    /// Returns the time until the joints meet the target, `[s]`. Without a target, returns the time
    /// until they rest.
    pub(super) fn remaining(&self) -> f64 {
        self.axes.time_to_target()
    }
}

/// Greatest distance, from rounding alone, between two places of the same motion, `[rad]`.
const ROUNDING: f64 = 1e-9;

/// Start values for the generator, in the frame that moves with the target.
struct Plan {
    state: State<7>,
    limits: Limits<7>,
    to: Option<[f64; 7]>,
    /// Velocity of the frame, `[rad/s]`.
    drift: [f64; 7],
    planned: Option<(MovingJoints, Budget)>,
}

impl Plan {
    fn new(
        robot: &JointLimits,
        reference: &Reference,
        target: Option<MovingJoints>,
        budget: &Budget,
    ) -> Result<Self, PlanError> {
        let mut to = target.map(|target| target.q);
        let mut drift = [0.0; 7];
        let limits = core::array::from_fn(|i| {
            let own = budget.joints[i];
            let limits = limits_of_joint(i, robot, reference, own, target.is_none());
            let (Some(target), Some(to)) = (&target, &mut to) else {
                return limits;
            };
            if target.dq[i] != 0.0 {
                let (lower, upper) = approach::range(i, robot);
                to[i] = to[i].clamp(lower, upper);
                let room = if target.dq[i] > 0.0 {
                    upper - to[i]
                } else {
                    to[i] - lower
                };
                drift[i] = target.dq[i].clamp(-room / ROOM, room / ROOM);
            }
            let limits = approach::limits(i, robot, reference.q[i], to[i], limits);
            let (velocity, left) = budget::beside(drift[i].abs(), limits.velocity);
            drift[i] = velocity.copysign(drift[i]);
            AxisLimits {
                velocity: left,
                ..limits
            }
        });
        let state = State {
            position: reference.q.into(),
            velocity: core::array::from_fn(|i| reference.dq[i] - drift[i]),
            acceleration: reference.ddq.into(),
        };
        Ok(Self {
            state,
            limits: Limits::per_axis(limits)?,
            to,
            drift,
            planned: target
                .filter(|target| target.dq != [0.0; 7])
                .map(|target| (target, *budget)),
        })
    }
}

//! The generator of end-effector poses: three axes of translation, three of rotation, one
//! synchronised plan.
//!
//! The orientation is generated in a chart around the orientation where the plan began,
//! `R = exp(phi) R_anchor`, so that a rotation from rest turns about one fixed axis. Rotation
//! vector and angular velocity are related by the left Jacobian of the rotation group,
//! `omega = J(phi) phi'`; at `phi = 0` it is the identity and has no influence on the acceleration
//! either. So a plan that begins in motion is seeded exactly by re-anchoring the chart where it
//! begins.

use franka_model::Twist;
use franka_model::limits::CartesianLimits;
use franka_model::rotation;
use franka_otg::{Generator, Limits, PlanError, State};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::session::Budget;
use crate::session::budget::Leg;

/// A moving pose of the end effector in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PoseState {
    /// `O_T_EE`, `[m]`.
    pub(crate) pose: Isometry3<f64>,
    /// Velocity of the frame's origin and angular velocity, base axes.
    pub(crate) twist: Twist,
    /// Their derivatives.
    pub(crate) acceleration: Twist,
}

/// A pose and its velocity, for the joints that follow it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovingPose {
    /// `O_T_EE`, `[m]`.
    pub(crate) pose: Isometry3<f64>,
    /// Velocity of the frame's origin and angular velocity, base axes.
    pub(crate) twist: Twist,
}

impl PoseState {
    /// All but the acceleration.
    pub(crate) fn moving(&self) -> MovingPose {
        MovingPose {
            pose: self.pose,
            twist: self.twist,
        }
    }
}

/// Moves the pose to its target, one nominal millisecond per step.
#[derive(Debug)]
pub(crate) struct PoseGenerator {
    axes: Generator<6>,
    anchor: UnitQuaternion<f64>,
    target: Isometry3<f64>,
    budget: Budget,
    /// What the robot allows at most.
    most: &'static CartesianLimits,
}

impl PoseGenerator {
    /// Begins at `start` and heads for `target` within `budget`. A start that moves faster than the
    /// budget allows is braked with more than the budget's acceleration, up to the robot's `most`.
    ///
    /// # Errors
    /// As for [`Generator`]; goals are checked where they are accepted, so only a defect can cause
    /// one.
    pub(crate) fn new(
        start: &PoseState,
        target: Isometry3<f64>,
        budget: Budget,
        most: &'static CartesianLimits,
    ) -> Result<Self, PlanError> {
        let (state, limits, to) = plan(start, &target, &budget, most)?;
        Ok(Self {
            axes: Generator::towards(state, limits, Some(&to))?,
            anchor: start.pose.rotation,
            target,
            budget,
            most,
        })
    }

    /// Heads for another target, at another pace. The same target and pace leave the plan as it is.
    ///
    /// # Errors
    /// See [`Self::new`]; the motion in progress goes on.
    pub(crate) fn retarget(
        &mut self,
        target: Isometry3<f64>,
        budget: Budget,
    ) -> Result<(), PlanError> {
        if target != self.target || budget != self.budget {
            self.begin_again(&self.state(), target, budget)?;
        }
        Ok(())
    }

    /// Moves the pose to `pose` with its velocity kept, and plans anew from there.
    ///
    /// # Errors
    /// See [`Self::new`]; the motion in progress goes on.
    pub(crate) fn reanchor(&mut self, pose: Isometry3<f64>) -> Result<(), PlanError> {
        let start = PoseState {
            pose,
            ..self.state()
        };
        self.begin_again(&start, self.target, self.budget)
    }

    fn begin_again(
        &mut self,
        start: &PoseState,
        target: Isometry3<f64>,
        budget: Budget,
    ) -> Result<(), PlanError> {
        let (state, limits, to) = plan(start, &target, &budget, self.most)?;
        self.axes.restart(state, limits, Some(&to))?;
        self.anchor = start.pose.rotation;
        self.target = target;
        self.budget = budget;
        Ok(())
    }

    /// Advances by one nominal millisecond.
    pub(crate) fn step(&mut self) -> MovingPose {
        let state = self.axes.step();
        let v = translational(&state.velocity);
        let [phi, phi_dot] = [state.position, state.velocity].map(|axes| rotational(&axes));
        let omega = rotation::angular_velocity(&phi, &phi_dot);
        MovingPose {
            pose: self.pose(),
            twist: Twist::new(v.x, v.y, v.z, omega.x, omega.y, omega.z),
        }
    }

    /// The pose now.
    pub(crate) fn pose(&self) -> Isometry3<f64> {
        let position = &self.axes.state().position;
        Isometry3::from_parts(
            Translation3::from(translational(position)),
            rotation::exp(&rotational(position)) * self.anchor,
        )
    }

    /// How fast the target may be approached.
    pub(crate) fn budget(&self) -> &Budget {
        &self.budget
    }

    /// Whether the pose rests at the target.
    pub(crate) fn is_done(&self) -> bool {
        self.axes.is_done()
    }

    /// How the pose moves now.
    pub(crate) fn state(&self) -> PoseState {
        let State {
            position,
            velocity,
            acceleration,
        } = *self.axes.state();
        let [phi, phi_dot, phi_ddot] =
            [position, velocity, acceleration].map(|axes| rotational(&axes));
        let omega = rotation::angular_velocity(&phi, &phi_dot);
        let alpha = rotation::angular_acceleration(&phi, &phi_dot, &phi_ddot);
        let (v, a) = (translational(&velocity), translational(&acceleration));
        PoseState {
            pose: self.pose(),
            twist: Twist::new(v.x, v.y, v.z, omega.x, omega.y, omega.z),
            acceleration: Twist::new(a.x, a.y, a.z, alpha.x, alpha.y, alpha.z),
        }
    }
}

/// What a plan for the six axes begins with, its limits and its target, with the chart anchored at
/// the orientation of `start`.
fn plan(
    start: &PoseState,
    target: &Isometry3<f64>,
    budget: &Budget,
    most: &CartesianLimits,
) -> Result<(State<6>, Limits<6>, [f64; 6]), PlanError> {
    let budget = budget.able_to_stop(&start.twist, &start.acceleration, most);
    let from = start.pose.translation.vector;
    let way = target.translation.vector - from;
    let turn = rotation::error(&target.rotation, &start.pose.rotation);
    let state = State {
        position: [from.x, from.y, from.z, 0.0, 0.0, 0.0],
        velocity: start.twist.into(),
        acceleration: start.acceleration.into(),
    };
    let limits = budget.axes(
        &Leg {
            way,
            velocity: translational(&state.velocity),
            acceleration: translational(&state.acceleration),
        },
        &Leg {
            way: turn,
            velocity: rotational(&state.velocity),
            acceleration: rotational(&state.acceleration),
        },
    );
    let to = target.translation.vector;
    let to = [to.x, to.y, to.z, turn.x, turn.y, turn.z];
    Ok((state, Limits::per_axis(limits)?, to))
}

fn translational(axes: &[f64; 6]) -> Vector3<f64> {
    Vector3::new(axes[0], axes[1], axes[2])
}

fn rotational(axes: &[f64; 6]) -> Vector3<f64> {
    Vector3::new(axes[3], axes[4], axes[5])
}

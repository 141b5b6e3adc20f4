//! The generator of end-effector poses. One synchronised plan moves three axes of translation and
//! three axes of rotation.
//!
//! The orientation is generated in a chart around the orientation where the plan began,
//! `R = exp(phi) R_anchor`, so that a rotation from rest turns about one fixed axis. Rotation
//! vector and angular velocity are related by the left Jacobian of the rotation group,
//! `omega = J(phi) phi'`. At `phi = 0` that Jacobian is the identity and also does not influence
//! the acceleration. Therefore a plan that begins in motion starts with the exact velocity and
//! acceleration if the chart is anchored at the beginning of the plan.
//!
//! A moving target is at rest in a frame that moves with the target. The plan is made in that
//! frame. Once the pose has arrived at the target, it moves with the target.

use franka_model::Twist;
use franka_model::limits::CartesianLimits;
use franka_model::rotation;
use franka_otg::{AxisLimits, Generator, Limits, PlanError, State};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::session::budget::Leg;
use crate::session::goal::moved;
use crate::session::{Budget, budget};
use crate::shaping::CYCLE;

/// A moving pose of the end effector in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PoseState {
    /// `O_T_EE`, `[m]`.
    pub(crate) pose: Isometry3<f64>,
    /// Velocity of the frame's origin and angular velocity, base axes.
    pub(crate) twist: Twist,
    /// Derivatives of the twist.
    pub(crate) acceleration: Twist,
}

/// A pose and its velocity, as the target of the joints.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovingPose {
    /// `O_T_EE`, `[m]`.
    pub(crate) pose: Isometry3<f64>,
    /// Velocity of the frame's origin and angular velocity, base axes.
    pub(crate) twist: Twist,
}

impl From<Isometry3<f64>> for MovingPose {
    fn from(pose: Isometry3<f64>) -> Self {
        let twist = Twist::zeros();
        Self { pose, twist }
    }
}

impl MovingPose {
    /// Returns the moving pose `t` seconds later.
    fn after(self, t: f64) -> Self {
        if self.twist == Twist::zeros() {
            return self;
        }
        let pose = moved(&self.pose, &self.twist, t);
        Self { pose, ..self }
    }

    /// True if `other` is the same moving pose. At rest the two must be exactly equal; in motion
    /// they may differ by rounding errors.
    fn is(&self, other: &Self) -> bool {
        let apart = || {
            let way = self.pose.translation.vector - other.pose.translation.vector;
            let turn = rotation::error(&self.pose.rotation, &other.pose.rotation);
            way.norm().max(turn.norm())
        };
        let moves = self.twist != Twist::zeros();
        self.twist == other.twist && (self.pose == other.pose || moves && apart() < ROUNDING)
    }
}

/// Greatest distance, from rounding alone, between two places of the same motion, in metres and
/// radians.
const ROUNDING: f64 = 1e-9;

impl PoseState {
    /// Returns the state without its acceleration.
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
    /// Generator of the axes, in a frame that moves at `twist`. The frame was the base frame when
    /// the plan was made.
    axes: Generator<6>,
    anchor: UnitQuaternion<f64>,
    twist: Twist,
    /// Cycles since the plan was made.
    cycles: u32,
    /// Target of the plan; `None` if the plan only brakes to rest.
    target: Option<MovingPose>,
    budget: Budget,
    most: &'static CartesianLimits,
}

impl PoseGenerator {
    /// Creates a generator that begins at `start` and moves to `target` within `budget`. If the
    /// start is faster than the budget allows, it is braked with more than the budget's
    /// acceleration, up to the robot's limits, `most`. If the target moves at the budget's speed or
    /// faster, the pose follows it at the budget's speed minus a reserve.
    ///
    /// # Errors
    /// Returns the errors of [`Generator`]. Goals are checked when they are accepted, so only a
    /// defect can cause an error.
    pub(crate) fn new(
        start: &PoseState,
        target: MovingPose,
        budget: Budget,
        most: &'static CartesianLimits,
    ) -> Result<Self, PlanError> {
        let plan = Plan::new(start, &target, &budget, most)?;
        Ok(Self {
            axes: Generator::towards(plan.state, plan.limits, Some(&plan.to))?,
            anchor: start.pose.rotation,
            twist: plan.twist,
            cycles: 0,
            target: Some(target),
            budget,
            most,
        })
    }

    /// Moves to another target, within another budget. If target and budget are the same as before,
    /// the plan stays as it is.
    ///
    /// # Errors
    /// As for [`Self::new`]; the motion in progress continues.
    pub(crate) fn retarget(&mut self, target: MovingPose, budget: Budget) -> Result<(), PlanError> {
        let before = self.target.map(|before| before.after(self.time()));
        let same = before.is_some_and(|before| before.is(&target));
        // If the frame is slower than the target, it falls behind the target.
        if budget != self.budget || !same || self.twist != target.twist {
            self.begin_again(&self.state(), target, budget)?;
        }
        Ok(())
    }

    /// Sets the present pose to `pose`, keeps its velocity, and plans anew from there.
    ///
    /// # Errors
    /// As for [`Self::new`]; the motion in progress continues.
    pub(crate) fn reanchor(&mut self, pose: Isometry3<f64>) -> Result<(), PlanError> {
        let start = PoseState {
            pose,
            ..self.state()
        };
        let Some(target) = self.target else {
            return self.stop_from(&start);
        };
        self.begin_again(&start, target.after(self.time()), self.budget)
    }

    /// Keeps the pose from running ahead of `behind`. A pose that moves on a line stays on it: it
    /// goes back to the place nearest to `behind`, and slows down. Any other pose continues from
    /// `behind` at its velocity.
    ///
    /// # Errors
    /// As for [`Self::new`]; the motion in progress continues.
    pub(crate) fn hold_back(&mut self, behind: Isometry3<f64>) -> Result<(), PlanError> {
        if self.twist == Twist::zeros() {
            let p = behind.translation.vector;
            let turn = rotation::error(&behind.rotation, &self.anchor);
            let place = [p.x, p.y, p.z, turn.x, turn.y, turn.z];
            if self.axes.hold_back(&place, SLOWER)? {
                return Ok(());
            }
        }
        self.reanchor(behind)
    }

    /// Continues at `share` of the present velocity. If the pose moves on a line, it stays on that
    /// line.
    ///
    /// # Errors
    /// As for [`Self::new`]; the motion in progress continues.
    pub(crate) fn slow_down(&mut self, share: f64) -> Result<(), PlanError> {
        if self.twist == Twist::zeros() {
            return self.axes.slow_down(share);
        }
        let now = self.state();
        let start = PoseState {
            twist: now.twist * share,
            ..now
        };
        match self.target {
            Some(target) => self.begin_again(&start, target.after(self.time()), self.budget),
            None => self.stop_from(&start),
        }
    }

    /// Stops within the budget. If the pose moves on a line, it stops on that line.
    ///
    /// # Errors
    /// As for [`Self::new`]; the motion in progress continues.
    pub(crate) fn halt(&mut self) -> Result<(), PlanError> {
        if self.twist == Twist::zeros() {
            self.axes.brake();
            self.target = None;
            return Ok(());
        }
        self.stop_from(&self.state())
    }

    fn stop_from(&mut self, start: &PoseState) -> Result<(), PlanError> {
        // Plan toward a place straight ahead, so that the stop stays on the line to that place.
        let ahead = moved(&start.pose, &start.twist, 1.0);
        self.begin_again(start, ahead.into(), self.budget)?;
        self.axes.brake();
        self.target = None;
        Ok(())
    }

    fn begin_again(
        &mut self,
        start: &PoseState,
        target: MovingPose,
        budget: Budget,
    ) -> Result<(), PlanError> {
        let plan = Plan::new(start, &target, &budget, self.most)?;
        self.axes.restart(plan.state, plan.limits, Some(&plan.to))?;
        self.anchor = start.pose.rotation;
        self.twist = plan.twist;
        self.cycles = 0;
        self.target = Some(target);
        self.budget = budget;
        Ok(())
    }

    /// Advances by one nominal millisecond.
    pub(crate) fn step(&mut self) -> MovingPose {
        self.cycles = self.cycles.saturating_add(1);
        self.axes.step();
        MovingPose {
            pose: self.pose(),
            twist: self.velocity(),
        }
    }

    fn velocity(&self) -> Twist {
        let State {
            position, velocity, ..
        } = self.axes.state();
        let v = translational(velocity);
        let omega = rotation::angular_velocity(&rotational(position), &rotational(velocity));
        let within = |omega: Vector3<f64>| Twist::new(v.x, v.y, v.z, omega.x, omega.y, omega.z);
        if self.twist == Twist::zeros() {
            return within(omega);
        }
        within(self.turn() * omega) + self.twist
    }

    /// Returns the rotation of the frame since the plan was made.
    fn turn(&self) -> UnitQuaternion<f64> {
        rotation::exp(&(parts(&self.twist).1 * self.time()))
    }

    /// Returns the seconds since the plan was made.
    fn time(&self) -> f64 {
        f64::from(self.cycles) * CYCLE
    }

    pub(crate) fn pose(&self) -> Isometry3<f64> {
        let position = &self.axes.state().position;
        let in_frame = Isometry3::from_parts(
            Translation3::from(translational(position)),
            rotation::exp(&rotational(position)) * self.anchor,
        );
        if self.twist == Twist::zeros() {
            return in_frame;
        }
        moved(&in_frame, &self.twist, self.time())
    }

    /// Returns the limits of the approach to the target.
    pub(crate) fn budget(&self) -> &Budget {
        &self.budget
    }

    /// Returns the time until the pose meets the target, `[s]`. Without a target, returns the time
    /// until the pose rests.
    pub(crate) fn remaining(&self) -> f64 {
        self.axes.time_to_target()
    }

    /// True if the pose rests at the target.
    pub(crate) fn is_done(&self) -> bool {
        self.axes.is_done()
    }

    pub(crate) fn state(&self) -> PoseState {
        let State {
            position,
            velocity,
            acceleration,
        } = *self.axes.state();
        let [phi, phi_dot, phi_ddot] =
            [position, velocity, acceleration].map(|axes| rotational(&axes));
        let mut alpha = rotation::angular_acceleration(&phi, &phi_dot, &phi_ddot);
        let a = translational(&acceleration);
        let twist = self.velocity();
        if self.twist != Twist::zeros() {
            let (_, omega) = parts(&twist);
            let (_, frame) = parts(&self.twist);
            // The frame's own acceleration cancels in the second factor.
            alpha = self.turn() * alpha + frame.cross(&omega);
        }
        PoseState {
            pose: self.pose(),
            twist,
            acceleration: Twist::new(a.x, a.y, a.z, alpha.x, alpha.y, alpha.z),
        }
    }
}

/// Share of the velocity that a pose keeps per cycle while its joints cannot follow.
const SLOWER: f64 = 0.98;

/// Start values for the generator of the six axes, in the frame that moves with the target.
struct Plan {
    state: State<6>,
    limits: Limits<6>,
    to: [f64; 6],
    twist: Twist,
}

impl Plan {
    /// Creates the start values with the chart anchored at the orientation of `start`.
    fn new(
        start: &PoseState,
        target: &MovingPose,
        budget: &Budget,
        most: &CartesianLimits,
    ) -> Result<Self, PlanError> {
        let mut budget = budget.able_to_stop(&start.twist, &start.acceleration, most);
        let (linear, angular) = parts(&target.twist);
        let frame = |velocity: Vector3<f64>, limits: &mut AxisLimits| {
            let speed = velocity.norm();
            let (kept, left) = budget::beside(speed, limits.velocity);
            limits.velocity = left;
            velocity * if kept < speed { kept / speed } else { 1.0 }
        };
        let linear = frame(linear, &mut budget.translation);
        let angular = frame(angular, &mut budget.rotation);

        let from = start.pose.translation.vector;
        let way = target.pose.translation.vector - from;
        let turn = rotation::error(&target.pose.rotation, &start.pose.rotation);
        let (v, omega) = parts(&start.twist);
        let (a, alpha) = parts(&start.acceleration);
        // The chart is at its origin, so it has no influence on the acceleration.
        let translation = Leg {
            way,
            velocity: v - linear,
            acceleration: a,
        };
        let rotation = Leg {
            way: turn,
            velocity: omega - angular,
            acceleration: alpha - angular.cross(&omega),
        };
        let axes = |t: &Vector3<f64>, r: &Vector3<f64>| [t.x, t.y, t.z, r.x, r.y, r.z];
        let state = State {
            position: axes(&from, &Vector3::zeros()),
            velocity: axes(&translation.velocity, &rotation.velocity),
            acceleration: axes(&translation.acceleration, &rotation.acceleration),
        };
        Ok(Self {
            state,
            limits: Limits::per_axis(budget.axes(&translation, &rotation))?,
            to: axes(&target.pose.translation.vector, &turn),
            twist: Twist::new(
                linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
            ),
        })
    }
}

/// Returns the linear and the angular part of a twist.
fn parts(twist: &Twist) -> (Vector3<f64>, Vector3<f64>) {
    let axes = &(*twist).into();
    (translational(axes), rotational(axes))
}

fn translational(axes: &[f64; 6]) -> Vector3<f64> {
    Vector3::new(axes[0], axes[1], axes[2])
}

fn rotational(axes: &[f64; 6]) -> Vector3<f64> {
    Vector3::new(axes[3], axes[4], axes[5])
}

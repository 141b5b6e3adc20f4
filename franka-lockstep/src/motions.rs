//! Motions of the client: functions that begin, change, end and await motions in virtual time.

use franka_proto::{MoveControllerMode, MoveRequest, Request};
use franka_rt::control::Callback;
use franka_rt::driver::Program;
use franka_rt::lifecycle::{MotionError, NewMotion};
use franka_rt::session::{Goal, GoalError, GoalId, OnArrival, Target};
use franka_rt::together::StartTicket;
use nalgebra::Isometry3;

use super::{DriverStack, Lockstep, Outcome};

impl Lockstep {
    /// Returns a goal with the default options of the async API: see `franka_async::Motion`.
    pub fn goal(&mut self, target: Target, on_arrival: OnArrival) -> Goal {
        let limits = self.model.joint_limits();
        Goal::new(self.client.next_goal(), target, on_arrival, limits)
    }

    /// Submits a goal.
    ///
    /// # Errors
    /// Returns the errors of [`Lifecycle::begin`](franka_rt::lifecycle::Lifecycle::begin).
    pub fn submit(&mut self, goal: Goal) -> Result<GoalId, MotionError> {
        self.client.begin(NewMotion::to(goal))
    }

    /// Submits a goal that begins together with the goals of other robots.
    ///
    /// # Errors
    /// Returns the errors of [`Lifecycle::begin`](franka_rt::lifecycle::Lifecycle::begin).
    pub fn submit_together(
        &mut self,
        goal: Goal,
        ticket: StartTicket,
    ) -> Result<GoalId, MotionError> {
        self.client.begin(NewMotion::Goal {
            goal: Box::new(goal),
            path: None,
            ticket: Some(ticket),
            session: None,
        })
    }

    /// Starts a control function that begins together with the motions of other robots. See
    /// [`Self::control`].
    ///
    /// # Errors
    /// Returns the errors of [`Lifecycle::begin`](franka_rt::lifecycle::Lifecycle::begin).
    pub fn control_together(
        &mut self,
        callback: Callback,
        request: MoveRequest,
        ticket: StartTicket,
    ) -> Result<GoalId, MotionError> {
        self.guard = None;
        let id = self.client.next_goal();
        self.client.begin(NewMotion::Program {
            id,
            program: Program::Callback(Box::new(callback)),
            request: Box::new(request),
            ticket: Some(ticket),
        })
    }

    /// Submits a motion that ends at `target`.
    ///
    /// # Panics
    /// Panics if the goal is not accepted.
    pub fn begin(&mut self, target: Target) -> GoalId {
        let goal = self.goal(target, OnArrival::ReportAndFinish);
        self.submit(goal).expect("the goal is accepted")
    }

    /// Starts a motion that a program of the test controls. After this call, the harness no longer
    /// checks commands; only the simulated robot does.
    ///
    /// # Errors
    /// Returns the errors of [`Lifecycle::begin`](franka_rt::lifecycle::Lifecycle::begin).
    pub fn control(
        &mut self,
        program: Program,
        request: MoveRequest,
    ) -> Result<GoalId, MotionError> {
        self.guard = None;
        self.client.control(program, request)
    }

    /// Starts a control function. If the function commands no torques, the robot's joint impedance
    /// controller follows its setpoints. See [`Self::control`].
    ///
    /// # Errors
    /// Returns the errors of [`Lifecycle::begin`](franka_rt::lifecycle::Lifecycle::begin).
    pub fn control_function(&mut self, function: Callback) -> Result<GoalId, MotionError> {
        let controller = MoveControllerMode::JointImpedance;
        let request = function.request(self.client.version(), controller);
        self.control(Program::Callback(Box::new(function)), request)
    }

    /// Brakes the arm. Returns the id of the stop, or `None` if nothing moves.
    pub fn stop(&mut self) -> Option<GoalId> {
        self.client.stop()
    }

    /// Cancels a goal, like dropping its future.
    pub fn cancel(&mut self, goal: GoalId) {
        self.client.cancel(goal);
    }

    /// Replaces the target of a goal that holds its target. Returns false if the goal no longer
    /// holds its target.
    ///
    /// # Errors
    /// Returns the errors of [`Lifecycle::update`](franka_rt::lifecycle::Lifecycle::update).
    pub fn update(&mut self, goal: GoalId, target: Target) -> Result<bool, GoalError> {
        let DriverStack {
            lifecycle, state, ..
        } = &mut self.client;
        lifecycle.update(goal, target, state)
    }

    /// Runs until the goal has an outcome, and returns the outcome.
    ///
    /// # Panics
    /// Panics if the goal takes longer than `most` milliseconds.
    pub fn until_resolved(&mut self, goal: GoalId, most: u64) -> Outcome {
        for _ in 0..most {
            if let Some(outcome) = self.client.outcome(goal) {
                return outcome.clone();
            }
            self.tick();
        }
        panic!(
            "goal {goal:?} is unresolved after {most} ms: {:?}",
            self.client.lifecycle
        );
    }

    /// Moves to `target` in a separate motion. Returns the greatest distance between the end
    /// effector and its reference during the motion, `[m]`.
    ///
    /// # Panics
    /// Panics if the goal is refused or not reached.
    pub fn lag_to(&mut self, target: Isometry3<f64>) -> f64 {
        let goal = self.goal(target.into(), OnArrival::ReportAndFinish);
        let goal = self.submit(goal).expect("within reach");
        let mut lag = 0.0_f64;
        while self.client.outcome(goal).is_none() {
            self.tick();
            if self.client.record.goal == goal.0 {
                let arm = self.arm_pose().translation.vector;
                lag = lag.max((arm - self.reference_pose().translation.vector).norm());
            }
        }
        self.until_resolved(goal, 1).expect("it arrives");
        self.until_idle(1000);
        lag
    }

    /// Runs until no motion is active.
    ///
    /// # Panics
    /// Panics if the motions take longer than `most` milliseconds.
    pub fn until_idle(&mut self, most: u64) {
        for _ in 0..most {
            if self.client.lifecycle.is_idle() {
                return;
            }
            self.tick();
        }
        panic!("not idle after {most} ms: {:?}", self.client.lifecycle);
    }

    /// Sends a request that is not a motion, without waiting for its answer.
    ///
    /// # Panics
    /// Panics if the session refuses the request.
    pub fn request(&mut self, request: &Request) {
        self.client.request(request);
    }
}

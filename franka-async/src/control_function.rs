//! Control functions: the user's own code, called with every state on the real-time thread.

use std::future::IntoFuture;
use std::time::Duration;

use franka_proto::{MoveControllerMode, RobotState};
use franka_rt::control::{
    Callback, CartesianPose, CartesianVelocities, GeneratorCommand, JointPositions,
    JointVelocities, Next, Shaper, Torques,
};
use franka_rt::driver::Program;
use franka_rt::lifecycle::NewMotion;
use franka_rt::session::GoalError;
use franka_rt::shaping::DEFAULT_CUTOFF_FREQUENCY;
use franka_rt::together::StartTicket;

use crate::cancel::Canceller;
use crate::move_to::Moving;
use crate::robot::Robot;
use crate::user_value::UserValue;

impl Robot {
    /// Control by torques alone: `function` gets every state, and the robot's time since the
    /// previous state, which is zero at first and more than a millisecond after a loss. It returns
    /// [`Torques`], or `torques.finish()` for the last.
    ///
    /// The function runs on the real-time thread, once a millisecond, with some 300 us to answer:
    /// it must not lock, allocate, print or wait. If it panics, the robot is asked to stop and the
    /// motion resolves as [`MotionError::Panicked`](crate::MotionError::Panicked); the thread lives
    /// on.
    pub fn control_torques<R: Into<Next<Torques>>>(
        &self,
        function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Control {
        Control::new(
            self.clone(),
            Callback::torques(self.version(), kept(function)),
        )
    }

    /// Control by joint positions for the robot's own controller. See [`Self::control_torques`] for
    /// the rules of a function, and [`Control::controller`] and [`Control::with_torques`] for the
    /// source of the torques.
    pub fn control_joint_positions<R: Into<Next<JointPositions>>>(
        &self,
        function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Control {
        self.control_motion(function)
    }

    /// Control by joint velocities; otherwise like [`Self::control_joint_positions`].
    pub fn control_joint_velocities<R: Into<Next<JointVelocities>>>(
        &self,
        function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Control {
        self.control_motion(function)
    }

    /// Control by poses of the end effector; otherwise like [`Self::control_joint_positions`].
    pub fn control_cartesian_pose<R: Into<Next<CartesianPose>>>(
        &self,
        function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Control {
        self.control_motion(function)
    }

    /// Control by twists of the end effector; otherwise like [`Self::control_joint_positions`].
    pub fn control_cartesian_velocities<R: Into<Next<CartesianVelocities>>>(
        &self,
        function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Control {
        self.control_motion(function)
    }

    fn control_motion<C: GeneratorCommand, R: Into<Next<C>>>(
        &self,
        function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Control {
        Control::new(
            self.clone(),
            Callback::motion(self.version(), kept(function)),
        )
    }
}

/// A motion under a control function, before it begins: nothing is sent until it is awaited or
/// detached.
///
/// Awaiting it resolves when the function has finished and the robot has ended the motion. Unlike
/// goals, it neither supersedes the current motion nor is superseded. It is refused as
/// [`MotionError::Busy`](crate::MotionError::Busy) while anything else controls the arm, and so is
/// everything else while it does. **Dropping the future stops the robot**; the function may still
/// be called for the few cycles that this takes.
///
/// `.await` takes it as it is. Functions that take a future, such as `tokio::spawn`,
/// `tokio::time::timeout` and `block_on`, need its `.into_future()`.
#[derive(Debug)]
#[must_use = "a motion does nothing until it is awaited or detached"]
pub struct Control {
    robot: Robot,
    canceller: Canceller,
    callback: Callback,
    controller: MoveControllerMode,
    limit_rate: bool,
    cutoff_frequency: f64,
    ticket: Option<StartTicket>,
}

impl Control {
    fn new(robot: Robot, callback: Callback) -> Self {
        Self {
            callback,
            controller: MoveControllerMode::JointImpedance,
            limit_rate: Shaper::limits_by_default(robot.version()),
            cutoff_frequency: DEFAULT_CUTOFF_FREQUENCY,
            ticket: None,
            canceller: Canceller::new(&robot, robot.next_goal()),
            robot,
        }
    }

    /// Sets which of the robot's own controllers follows the commands; joint impedance by default.
    /// Without effect where torques are commanded. The external one needs [`Self::with_torques`].
    pub fn controller(mut self, controller: MoveControllerMode) -> Self {
        self.controller = controller;
        self
    }

    /// Adds torques to the commands to the motion generator, in the place of the robot's own
    /// controller. Control that has torques already uses the new function alone.
    pub fn with_torques<R: Into<Next<Torques>>>(
        mut self,
        function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Self {
        self.callback = self.callback.with_torques(kept(function));
        self
    }

    /// Sets whether commands pass the limiter; by default they do for protocol 5 and do not for
    /// protocol 10, as in libfranka.
    pub fn limit_rate(mut self, limit: bool) -> Self {
        self.limit_rate = limit;
        self
    }

    /// Sets the cutoff of the low-pass filter, `[Hz]`: 100 by default; 1000 and more switch it off.
    /// With a cutoff that is not above zero, the motion ends with its first command.
    pub fn cutoff_frequency(mut self, cutoff_frequency: f64) -> Self {
        self.cutoff_frequency = cutoff_frequency;
        self
    }

    /// Begins together with the motions of other robots, see
    /// [`Motion::start_with`](crate::Motion::start_with). The function is not called until all are
    /// there. Until then the driver holds the arm: by the desired joint positions or pose of the
    /// robot, by velocities of zero, by torques of zero, which leave it to the robot's gravity
    /// compensation. The function's first call still has a time step of zero. The report's duration
    /// includes the wait.
    ///
    /// # Cancel safety
    /// See [`Motion::start_with`](crate::Motion::start_with).
    pub fn start_with(mut self, ticket: StartTicket) -> Self {
        self.ticket = Some(ticket);
        self
    }

    /// Begins the motion without a future: it continues, and its outcome is only logged.
    pub fn detach(self) {
        let (robot, canceller) = (self.robot.clone(), self.canceller.clone());
        match self.begin() {
            Ok(motion) => drop(canceller.begin(&robot, motion.into())),
            Err(error) => tracing::warn!(%error, "the motion did not begin"),
        }
    }

    /// Returns a handle that stops the motion from elsewhere.
    pub fn canceller(&self) -> Canceller {
        self.canceller.clone()
    }

    fn begin(self) -> Result<NewMotion, GoalError> {
        let robot = &self.robot;
        let version = robot.version();
        let shaper = Shaper::new(version, self.limit_rate, self.cutoff_frequency)
            .with_limits_of(robot.model().joint_limits());
        let request = self.callback.request(version, self.controller);
        let is_external = request.controller == MoveControllerMode::ExternalController;
        if is_external && !self.callback.commands_torques() {
            return Err(GoalError::NoTorques);
        }
        Ok(NewMotion::Program {
            id: self.canceller.id(),
            program: Program::Callback(Box::new(self.callback.with_shaper(shaper))),
            request: Box::new(request),
            ticket: self.ticket,
        })
    }
}

/// The same function, which the bridge can free with everything that it has captured.
fn kept<R>(
    function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
) -> impl FnMut(&RobotState, Duration) -> R + Send + 'static {
    let mut function = UserValue::new("a control function", function);
    move |state: &RobotState, step| (*function)(state, step)
}

impl IntoFuture for Control {
    type Output = <Moving as Future>::Output;
    type IntoFuture = Moving;

    fn into_future(self) -> Moving {
        let (robot, canceller) = (self.robot.clone(), self.canceller.clone());
        Moving::new(robot, canceller, None, self.begin().map(Into::into))
    }
}

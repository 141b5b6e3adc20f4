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
    /// Returns a motion that `function` controls with torques alone. `function` receives every
    /// state, and the robot's time since the previous state. This time is zero in the first call,
    /// and more than a millisecond after a lost state. `function` returns [`Torques`], or
    /// `torques.finish()` for the last torques.
    ///
    /// `function` runs on the real-time thread once a millisecond, and has about 300 us to answer:
    /// it must not lock, allocate, print or wait. If it panics, the driver asks the robot to stop,
    /// and the motion resolves as [`MotionError::Panicked`](crate::MotionError::Panicked). The
    /// thread continues.
    pub fn control_torques<R: Into<Next<Torques>>>(
        &self,
        function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Control {
        Control::new(
            self.clone(),
            Callback::torques(self.version(), kept(function)),
        )
    }

    /// Returns a motion that `function` controls with joint positions, which the robot's own
    /// controller follows. See [`Self::control_torques`] for the rules of a function, and
    /// [`Control::controller`] and [`Control::with_torques`] for the source of the torques.
    pub fn control_joint_positions<R: Into<Next<JointPositions>>>(
        &self,
        function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Control {
        self.control_motion(function)
    }

    /// Returns a motion that `function` controls with joint velocities. Apart from that, it is like
    /// [`Self::control_joint_positions`].
    pub fn control_joint_velocities<R: Into<Next<JointVelocities>>>(
        &self,
        function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Control {
        self.control_motion(function)
    }

    /// Returns a motion that `function` controls with poses of the end effector. Apart from that,
    /// it is like [`Self::control_joint_positions`].
    pub fn control_cartesian_pose<R: Into<Next<CartesianPose>>>(
        &self,
        function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Control {
        self.control_motion(function)
    }

    /// Returns a motion that `function` controls with twists of the end effector. Apart from that,
    /// it is like [`Self::control_joint_positions`].
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

/// A motion that a function controls, and that has not begun: nothing is sent until this value is
/// awaited or detached.
///
/// The future resolves when the function has finished and the robot has ended the motion. Unlike
/// goals, a control function neither supersedes a motion nor is superseded. It is refused as
/// [`MotionError::Busy`](crate::MotionError::Busy) if anything else controls the arm, and other
/// motions are refused while it runs. **Dropping the future stops the robot**; meanwhile, the
/// function may still be called for a few cycles.
///
/// A motion can be awaited as it is. Functions that take a future, such as `tokio::spawn`,
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

    /// Sets which of the robot's own controllers follows the commands; by default, the joint
    /// impedance controller. This has no effect if torques are commanded. The external controller
    /// needs [`Self::with_torques`].
    pub fn controller(mut self, controller: MoveControllerMode) -> Self {
        self.controller = controller;
        self
    }

    /// Adds torques to the commands for the motion generator; the torques replace the robot's own
    /// controller. If torques are set already, the new function replaces the old one.
    pub fn with_torques<R: Into<Next<Torques>>>(
        mut self,
        function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Self {
        self.callback = self.callback.with_torques(kept(function));
        self
    }

    /// Sets whether the rate limiter applies to commands. By default, it applies in protocol 5 and
    /// not in protocol 10, as in libfranka.
    pub fn limit_rate(mut self, limit: bool) -> Self {
        self.limit_rate = limit;
        self
    }

    /// Sets the cutoff frequency of the low-pass filter, `[Hz]`: 100 by default; 1000 or more
    /// switches the filter off. A cutoff that is not above zero ends the motion with its first
    /// command.
    pub fn cutoff_frequency(mut self, cutoff_frequency: f64) -> Self {
        self.cutoff_frequency = cutoff_frequency;
        self
    }

    /// Makes the motion begin together with the motions of other robots: see
    /// [`Motion::start_with`](crate::Motion::start_with). The function is not called until all
    /// motions are ready. Until then, the driver sends commands of the motion's kind that hold the
    /// arm: the robot's own desired joint positions or pose, zero velocities, or zero torques. With
    /// zero torques, only the robot's gravity compensation holds the arm. The first call of the
    /// function still has a time step of zero. The duration in the report includes the wait.
    ///
    /// # Cancel safety
    /// See [`Motion::start_with`](crate::Motion::start_with).
    pub fn start_with(mut self, ticket: StartTicket) -> Self {
        self.ticket = Some(ticket);
        self
    }

    /// Begins the motion without a future: the motion continues, and its outcome is only logged.
    pub fn detach(self) {
        let (robot, canceller) = (self.robot.clone(), self.canceller.clone());
        match self.begin() {
            Ok(motion) => drop(canceller.begin(&robot, motion.into())),
            Err(error) => tracing::warn!(%error, "the motion did not begin"),
        }
    }

    /// Returns a handle with which any task can stop the motion.
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

/// Wraps the function so that the bridge frees it, with everything that it has captured.
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

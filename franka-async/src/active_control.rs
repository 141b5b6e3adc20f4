//! Active control: a thread of the program reads states, writes commands, and runs the control
//! cycle itself.

use std::marker::PhantomData;
use std::time::Duration;

use franka_proto::{MoveControllerMode, MoveRequest, RobotState};
use franka_rt::control::{
    ActiveControl, CartesianPose, CartesianVelocities, Command, GeneratorCommand, JointPositions,
    JointVelocities, Next, Torques,
};
use franka_rt::driver::Program;
use franka_rt::lifecycle::{MotionError, MotionReport, Outcome};
use franka_rt::session::GoalId;
use franka_rt::thread::{BorrowError, Lease, Lender};
use futures::FutureExt;
use tokio::sync::oneshot;

use crate::error::ActiveError;
use crate::input::unserved;
use crate::robot::Robot;

impl Robot {
    /// Begins a motion in which a thread of the program commands torques, and resolves when the
    /// motion runs. The first command is due within a few milliseconds. Pass the result at once to
    /// the thread that reads and writes.
    ///
    /// # Errors
    /// Returns [`MotionError::Busy`] if anything else controls the arm. If the motion ends before
    /// the robot runs it, returns the reason.
    ///
    /// # Cancel safety
    /// Dropping the future stops the robot.
    pub async fn active_torques(&self) -> Result<Active<Torques>, MotionError> {
        let generator = self.version().torque_generator();
        let request = MoveRequest::new(MoveControllerMode::ExternalController, generator);
        Active::begin(self, request).await
    }

    /// Begins a motion in which the thread commands joint positions, which `controller` follows.
    /// With [`MoveControllerMode::ExternalController`], every command also needs torques. Apart
    /// from that, it is like [`Self::active_torques`].
    ///
    /// # Errors
    /// See [`Self::active_torques`].
    ///
    /// # Cancel safety
    /// See [`Self::active_torques`].
    pub async fn active_joint_positions(
        &self,
        controller: MoveControllerMode,
    ) -> Result<Active<JointPositions>, MotionError> {
        self.active_motion(controller).await
    }

    /// Begins a motion in which the thread commands joint velocities. Apart from that, it is like
    /// [`Self::active_joint_positions`].
    ///
    /// # Errors
    /// See [`Self::active_torques`].
    ///
    /// # Cancel safety
    /// See [`Self::active_torques`].
    pub async fn active_joint_velocities(
        &self,
        controller: MoveControllerMode,
    ) -> Result<Active<JointVelocities>, MotionError> {
        self.active_motion(controller).await
    }

    /// Begins a motion in which the thread commands poses of the end effector. Apart from that, it
    /// is like [`Self::active_joint_positions`].
    ///
    /// # Errors
    /// See [`Self::active_torques`].
    ///
    /// # Cancel safety
    /// See [`Self::active_torques`].
    pub async fn active_cartesian_pose(
        &self,
        controller: MoveControllerMode,
    ) -> Result<Active<CartesianPose>, MotionError> {
        self.active_motion(controller).await
    }

    /// Begins a motion in which the thread commands twists of the end effector. Apart from that, it
    /// is like [`Self::active_joint_positions`].
    ///
    /// # Errors
    /// See [`Self::active_torques`].
    ///
    /// # Cancel safety
    /// See [`Self::active_torques`].
    pub async fn active_cartesian_velocities(
        &self,
        controller: MoveControllerMode,
    ) -> Result<Active<CartesianVelocities>, MotionError> {
        self.active_motion(controller).await
    }

    async fn active_motion<C: GeneratorCommand>(
        &self,
        controller: MoveControllerMode,
    ) -> Result<Active<C>, MotionError> {
        let generator = C::ZERO.into().generator();
        Active::begin(self, MoveRequest::new(controller, generator)).await
    }
}

/// A motion under active control, in which a thread of the program runs the control cycle. Send
/// this value to that thread. From the first [`read_once`](Self::read_once) until this value is
/// dropped, only that thread receives states. If the thread neither reads nor writes, the robot
/// receives no commands and stops.
///
/// **If that thread hangs** between two reads, the whole connection receives no states:
/// [`Robot::state`] does not change, and no lost link is reported. After the link timeout, the
/// driver gives up the motion and asks the robot to stop. The next read or write then returns
/// [`MotionError::Stalled`]. Until that call, or until this value is dropped, other motions are
/// refused as [`MotionError::Busy`].
///
/// Commands are neither filtered nor limited. All methods block; do not call them from async code.
/// The driver sets real-time scheduling only for its own thread. For the calling thread, use
/// [`Scheduling::enter`](crate::realtime::Scheduling::enter).
///
/// **Dropping this value** before the last command stops the robot.
#[derive(Debug)]
pub struct Active<C> {
    robot: Robot,
    id: GoalId,
    lender: Lender,
    /// The borrowed cycle; `None` before the first read, and after the cycle was given back.
    lease: Option<Lease>,
    /// Receives the outcome; `None` once the motion has ended.
    outcome: Option<oneshot::Receiver<Outcome>>,
    /// Reason why the motion ended; `None` if it ended with the last command.
    error: Option<MotionError>,
    /// `message_id` of the newest state read.
    previous: Option<u64>,
    commands: PhantomData<fn(C)>,
}

impl<C> Active<C> {
    async fn begin(robot: &Robot, request: MoveRequest) -> Result<Self, MotionError> {
        let id = robot.next_goal();
        let program = Program::Active(ActiveControl);
        let outcome = robot.begin_program(id, program, request).await?;
        Ok(Self {
            robot: robot.clone(),
            id,
            lender: robot.link().lender.clone(),
            lease: None,
            outcome: Some(outcome),
            error: None,
            previous: None,
            commands: PhantomData,
        })
    }

    /// Waits for the next state of the motion. Returns the state, and the robot's time since the
    /// previous state that was read. This time is zero in the first call, and more than a
    /// millisecond after a lost state.
    ///
    /// # Errors
    /// Returns [`ActiveError::Motion`] if the robot has ended the motion or has been silent for the
    /// link timeout, and [`ActiveError::Ended`] in later calls. Returns [`ActiveError::Finished`]
    /// after the last command.
    pub fn read_once(&mut self) -> Result<(RobotState, Duration), ActiveError> {
        if self.outcome.is_none() {
            return Err(self.over());
        }
        loop {
            let lease = self.lease()?;
            let turned = lease.turn();
            // The cycle no longer runs the motion, or the thread has ended; the bridge has the
            // reason.
            let is_over = turned.is_err() || lease.core().is_watching();
            let outcome = match self.given_up() {
                None => is_over.then(|| self.end()),
                given_up => given_up,
            };
            match outcome {
                Some(Ok(_)) => return Err(ActiveError::Finished),
                Some(Err(error)) => return Err(error.into()),
                None => {}
            }
            if let Ok(Some(state)) = turned {
                let previous = self.previous.replace(state.message_id);
                let step = state.message_id - previous.unwrap_or(state.message_id);
                return Ok((state, Duration::from_millis(step)));
            }
        }
    }

    /// Sends a command. After the last command, also waits until the robot has ended the motion.
    fn write(&mut self, next: Next<Command>) -> Result<Option<MotionReport>, ActiveError> {
        if self.outcome.is_none() {
            return Err(self.over());
        }
        match self.given_up() {
            Some(Ok(_)) => return Err(ActiveError::Finished),
            Some(Err(error)) => return Err(error.into()),
            None => {}
        }
        let (command, finished) = match next.into_parts() {
            Ok(parts) => parts,
            Err(code) => {
                self.stop();
                let error = self.error.insert(MotionError::GivenUp { code });
                return Err(error.clone().into());
            }
        };
        self.lease()?.write(&command, finished)?;
        if finished {
            return Ok(Some(self.end()?));
        }
        Ok(None)
    }

    /// If the motion was given up while nothing was read, gives the cycle back and returns the
    /// outcome.
    fn given_up(&mut self) -> Option<Outcome> {
        let outcome = self.outcome.as_mut()?.try_recv().ok()?;
        (self.lease, self.outcome) = (None, None);
        Some(self.noted(outcome))
    }

    /// Stores the end of the motion, for later calls.
    fn noted<T>(&mut self, end: Result<T, MotionError>) -> Result<T, MotionError> {
        self.error = end.as_ref().err().cloned();
        end
    }

    /// Returns the error for a call after the end of the motion.
    fn over(&self) -> ActiveError {
        self.error
            .clone()
            .map_or(ActiveError::Finished, ActiveError::Ended)
    }

    /// Returns the borrowed cycle. The first call borrows it.
    fn lease(&mut self) -> Result<&mut Lease, BorrowError> {
        match &mut self.lease {
            Some(lease) => Ok(lease),
            none => Ok(none.insert(self.lender.borrow()?)),
        }
    }

    /// Gives the cycle back and stops the robot, unless the motion has ended.
    fn stop(&mut self) {
        // Return the cycle first, so that the thread ends the motion.
        self.lease = None;
        if let Some(outcome) = self.outcome.take()
            && outcome.now_or_never().is_none()
        {
            self.robot.cancel(self.id);
        }
    }

    /// Gives the cycle back and waits for the end of the motion.
    fn end(&mut self) -> Outcome {
        self.lease = None;
        let end = match self.outcome.take() {
            Some(outcome) => outcome.blocking_recv().unwrap_or_else(unserved),
            None => Err(MotionError::Stopped),
        };
        self.noted(end)
    }
}

impl Active<Torques> {
    /// Sends torques for the newest state. After the last torques (`torques.finish()`), waits until
    /// the robot has ended the motion, and returns the report.
    ///
    /// # Errors
    /// Returns [`ActiveError::Write`] if the torques cannot be sent; the motion continues. Returns
    /// [`ActiveError::Motion`] if the motion ended for any reason other than the last torques.
    pub fn write_once(
        &mut self,
        torques: impl Into<Next<Torques>>,
    ) -> Result<Option<MotionReport>, ActiveError> {
        let version = self.robot.version();
        let command = |torques| Command::torques(version, torques);
        self.write(torques.into().map(command))
    }
}

impl<C: GeneratorCommand> Active<C> {
    /// Answers the newest state with a command for the robot's motion generator; one of the robot's
    /// own controllers follows this command. After the last command, waits until the robot has
    /// ended the motion, and returns the report.
    ///
    /// # Errors
    /// Returns the errors of [`Active<Torques>::write_once`]. Also returns an error, with the same
    /// text as libfranka, if the motion requires torques.
    pub fn write_motion(
        &mut self,
        motion: impl Into<Next<C>>,
    ) -> Result<Option<MotionReport>, ActiveError> {
        self.write(motion.into().map(|motion| Command {
            motion: Some(motion.into()),
            torques: None,
        }))
    }

    /// Sends a command to the motion generator together with torques, for an external controller.
    /// If the command or the torques are the last, waits until the robot has ended the motion, and
    /// returns the report.
    ///
    /// # Errors
    /// Returns the errors of [`Self::write_motion`]. If the motion accepts no torques, they are
    /// refused with the same text as in libfranka.
    pub fn write_motion_and_torques(
        &mut self,
        motion: impl Into<Next<C>>,
        torques: impl Into<Next<Torques>>,
    ) -> Result<Option<MotionReport>, ActiveError> {
        let next = motion.into().zip(torques.into());
        self.write(next.map(|(motion, torques)| Command {
            motion: Some(motion.into()),
            torques: Some(torques),
        }))
    }
}

impl<C> Drop for Active<C> {
    fn drop(&mut self) {
        self.stop();
    }
}

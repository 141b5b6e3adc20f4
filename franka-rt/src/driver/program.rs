//! Programs of running motions, which answer their states.

use core::time::Duration;

use franka_proto::{RobotState, Version};

use crate::control::{ActiveControl, AsynchronousPositions, Callback, Command, Failure};
use crate::driver::Record;
use crate::session::{SessionCommand, SessionEvent, Target, TargetSession, Trace};
use crate::team::MemberFault;
use crate::together::Gate;

/// Program that answers the states of a running motion. It is created and freed outside the thread.
#[derive(Debug)]
pub enum Program {
    /// A session, which turns goals into torques.
    Target(Box<TargetSession>),
    /// A function of the user, called with every state.
    Callback(Box<Callback>),
    /// Commands from the user's thread: see [`Driver::write`](super::Driver::write).
    Active(ActiveControl),
    /// Sparse joint targets. The robot plans the motion between them.
    Asynchronous(AsynchronousPositions),
}

impl Program {
    /// True if all values of `state` that the program uses are finite. A command that was computed
    /// from other values must not reach the motors.
    pub(super) fn can_read(&self, state: &RobotState) -> bool {
        let numbers = state.q.iter().chain(&state.dq).chain(&state.tau_J_d);
        let finite = numbers.copied().all(f64::is_finite);
        finite
            && match self {
                Self::Target(session) => session.can_read(state),
                Self::Callback(_) | Self::Active(_) | Self::Asynchronous(_) => true,
            }
    }

    /// True if the first goal of the motion was cancelled or replaced. Called only while the motion
    /// waits for other robots.
    pub(super) fn is_withdrawn(&mut self) -> bool {
        match self {
            Self::Target(session) => session.is_withdrawn(),
            Self::Callback(_) | Self::Active(_) | Self::Asynchronous(_) => false,
        }
    }

    /// Brakes the other members of the program's team, if it has one.
    pub(super) fn fail_team(&mut self, fault: MemberFault) {
        if let Self::Target(session) = self {
            session.fail_team(fault);
        }
    }

    /// Brakes the other members of the program's team, if it has one and the robot has been silent
    /// for too long.
    pub(super) fn on_silence(&mut self, silence: Duration) {
        if let Self::Target(session) = self {
            session.on_silence(silence);
        }
    }

    /// Leaves the program's team, if it has one, without a fault.
    pub(super) fn leave_team(&mut self) {
        if let Self::Target(session) = self {
            session.leave_team();
        }
    }

    /// True if the program itself stops a moving arm, without the robot's help, when its goal
    /// requires this.
    pub(super) fn brakes(&self) -> bool {
        matches!(self, Self::Target(_))
    }

    /// Answers a state. While the gate of a common start is closed, it holds the arm. If the start
    /// has failed, it finishes at the current position. [`Command::datagram`] checks that the
    /// command is finite. Stores an event of the program in `event`.
    ///
    /// Returns the command, and true if it is the last one. Returns `None` if nothing is sent now.
    ///
    /// # Errors
    /// Returns a [`Failure`] if no command can be sent now or later.
    pub(super) fn step(
        &mut self,
        gate: Gate,
        version: Version,
        state: &RobotState,
        record: &mut Record,
        event: &mut Option<SessionEvent>,
    ) -> Result<Option<(Command, bool)>, Failure> {
        match self {
            Self::Target(session) => {
                let step = session.answer(gate, state, event);
                let Trace {
                    goal,
                    reference,
                    target,
                    elapsed,
                    remaining,
                    compensation,
                    bindings,
                } = step.trace;
                record.goal = goal.0;
                record.q_ref = reference.q.into();
                record.dq_ref = reference.dq.into();
                record.ddq_ref = reference.ddq.into();
                match target.map(Target::place) {
                    Some(Target::Joints(q)) => record.q_target = Some(q),
                    Some(Target::Pose(pose)) => record.pose_target = Some(pose),
                    _ => {}
                }
                record.elapsed = elapsed;
                record.remaining = remaining;
                record.compensation = compensation.into();
                record.bindings = bindings;
                let command = match step.answer {
                    SessionCommand::Torques(torques) => Command::torques(version, torques),
                    SessionCommand::Setpoint(setpoint) => {
                        setpoint.validate().map_err(Failure::Invalid)?;
                        Command::setpoint(setpoint)
                    }
                };
                Ok(Some((command, step.finished)))
            }
            Self::Callback(callback) => match gate {
                Gate::Open => callback.step(state).map(Some),
                Gate::Closed => Ok(Some((callback.hold(state), false))),
                Gate::Broken(_) => Ok(Some((callback.hold(state), true))),
            },
            // The user's thread may write a command before the next state.
            Self::Active(_) => Ok(None),
            Self::Asynchronous(positions) => Ok(positions.step()),
        }
    }

    /// Computes the parts of the next step that do not need the next state.
    pub(super) fn prepare(&mut self) {
        match self {
            Self::Target(session) => session.prepare(),
            Self::Callback(_) | Self::Active(_) | Self::Asynchronous(_) => {}
        }
    }
}

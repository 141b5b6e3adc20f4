//! Control functions as the program of a motion.

use core::fmt;
use core::time::Duration;
use std::panic::{AssertUnwindSafe, catch_unwind};

use franka_proto::{MoveControllerMode, MoveRequest, RobotState, Version};

use super::{Command, GeneratorCommand, MotionCommand, Next, Torques};
use crate::control::{Failure, Shaper};

/// A boxed control function. It receives a state and the time since the previous state by the
/// robot's clock, and returns a command.
type Function<T> = Box<dyn FnMut(&RobotState, Duration) -> Next<T> + Send>;

/// The program of a motion that passes every state to one or two control functions.
///
/// The rules follow libfranka's control loops. A function receives a state and the time since the
/// previous state by the robot's clock. This time is zero in the first call, and more than a
/// millisecond after a lost state. The low-pass filter, the limiter and the checks process the
/// returned command. If there are two functions, both receive the same state and time. Once one
/// function finishes, the second function is not called any more, so the last command repeats the
/// second function's previous command. Protocol 10 calls the torque function first; protocol 5
/// calls the motion function first. Source: libfranka 0.21 and 0.9, `control_loop.cpp`.
pub struct Callback {
    shaper: Shaper,
    generator_first: bool,
    motion: Option<Source<MotionCommand>>,
    torques: Option<Source<Torques>>,
    /// `message_id` of the previous state.
    previous: Option<u64>,
    /// True if the newest command holds the arm.
    held: bool,
}

/// A function, and the newest command that it returned.
struct Source<T> {
    function: Function<T>,
    newest: T,
}

impl Callback {
    /// Returns a program that commands only torques, with the default shaper. If the protocol has
    /// no motions with torques alone, a motion generator also runs. Its commands are zero
    /// velocities.
    pub fn torques<R: Into<Next<Torques>>>(
        version: Version,
        torques: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Self {
        let idle = Command::torques(version, NO_TORQUES).motion;
        let stand = idle.map(|idle| Source {
            function: Box::new(move |_, _| idle.into()),
            newest: idle,
        });
        Self::new(version, stand).with_torques(torques)
    }

    /// Returns a program that commands a motion generator, with the default shaper. One of the
    /// robot's own controllers follows the generator.
    pub fn motion<C: GeneratorCommand, R: Into<Next<C>>>(
        version: Version,
        mut motion: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Self {
        let motion = move |state: &RobotState, step| motion(state, step).into().map(C::into);
        Self::new(version, Some(Source::new(motion, C::ZERO.into())))
    }

    /// Adds a torque function to a program that commands a motion generator. The torques replace
    /// the robot's own controller.
    #[must_use]
    pub fn with_torques<R: Into<Next<Torques>>>(
        self,
        torques: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
    ) -> Self {
        Self {
            torques: Some(Source::new(torques, NO_TORQUES)),
            ..self
        }
    }

    /// Replaces the shaper. The default is [`Shaper::by_default`].
    #[must_use]
    pub fn with_shaper(self, shaper: Shaper) -> Self {
        Self { shaper, ..self }
    }

    fn new(version: Version, motion: Option<Source<MotionCommand>>) -> Self {
        Self {
            shaper: Shaper::by_default(version),
            generator_first: version.generator_first(),
            motion,
            torques: None,
            previous: None,
            held: false,
        }
    }

    /// True if the program commands torques.
    pub fn commands_torques(&self) -> bool {
        self.torques.is_some()
    }

    /// Returns the request that starts a motion of this program. If the program commands no
    /// torques, the request names `controller`.
    pub fn request(&self, version: Version, controller: MoveControllerMode) -> MoveRequest {
        let controller = match &self.torques {
            Some(_) => MoveControllerMode::ExternalController,
            None => controller,
        };
        let generator = match &self.motion {
            Some(motion) => motion.newest.generator(),
            None => version.torque_generator(),
        };
        MoveRequest::new(controller, generator)
    }

    /// Returns the command that answers a state, and true if it is the last command.
    pub(crate) fn step(&mut self, state: &RobotState) -> Result<(Command, bool), Failure> {
        let first = self.previous.is_none();
        let previous = self.previous.replace(state.message_id);
        let step = Duration::from_millis(state.message_id - previous.unwrap_or(state.message_id));
        // The function that finishes first ends the cycle.
        let finished = if self.generator_first {
            self.step_motion(state, step, first)? || self.step_torques(state, step)?
        } else {
            let torques = self.step_torques(state, step)?;
            torques || self.step_motion(state, step, first)?
        };
        Ok((self.newest(), finished))
    }

    /// Returns the command that holds the arm: the robot's desired position when the hold began, no
    /// velocity, no torque. Does not call a function, so the next call of a function still counts
    /// as the first.
    pub(crate) fn hold(&mut self, state: &RobotState) -> Command {
        if let Some(source) = &mut self.motion
            && !self.held
        {
            source.newest = source.newest.holding(state);
        }
        self.held = true;
        self.newest()
    }

    fn newest(&self) -> Command {
        Command {
            motion: self.motion.as_ref().map(|source| source.newest),
            torques: self.torques.as_ref().map(|source| source.newest),
        }
    }

    /// Calls the motion function. Returns true if it has finished.
    fn step_motion(
        &mut self,
        state: &RobotState,
        step: Duration,
        first: bool,
    ) -> Result<bool, Failure> {
        let Some(source) = &mut self.motion else {
            return Ok(false);
        };
        let (command, finished) = source.call(state, step)?;
        let shaped = command.shaped(&self.shaper, state, first);
        source.newest = shaped.map_err(Failure::Invalid)?;
        Ok(finished)
    }

    fn step_torques(&mut self, state: &RobotState, step: Duration) -> Result<bool, Failure> {
        let Some(source) = &mut self.torques else {
            return Ok(false);
        };
        let (command, finished) = source.call(state, step)?;
        let shaped = self.shaper.torques(&command, state);
        source.newest = shaped.map_err(Failure::Invalid)?;
        Ok(finished)
    }
}

impl<T> Source<T> {
    fn new<R: Into<Next<T>>>(
        mut function: impl FnMut(&RobotState, Duration) -> R + Send + 'static,
        newest: T,
    ) -> Self {
        Self {
            function: Box::new(move |state, step| function(state, step).into()),
            newest,
        }
    }

    /// Returns the function's command, and true if it is the last command. Catches a panic of the
    /// function.
    fn call(&mut self, state: &RobotState, step: Duration) -> Result<(T, bool), Failure> {
        // A function that has panicked is never called again, so its inconsistent state is never
        // read.
        let called = catch_unwind(AssertUnwindSafe(|| (self.function)(state, step)));
        let next = called.map_err(Failure::Panicked)?;
        next.into_parts().map_err(Failure::GivenUp)
    }
}

impl fmt::Debug for Callback {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Callback")
            .field("motion", &self.motion.as_ref().map(|source| &source.newest))
            .field(
                "torques",
                &self.torques.as_ref().map(|source| &source.newest),
            )
            .field("previous", &self.previous)
            .finish_non_exhaustive()
    }
}

const NO_TORQUES: Torques = Torques([0.0; 7]);

#[cfg(test)]
mod tests;

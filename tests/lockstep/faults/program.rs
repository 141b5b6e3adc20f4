//! Programs that follow the course, and those that misbehave.

use std::time::Duration;

use franka_proto::{MoveGeneratorMode, RobotState, Version};
use franka_rt::control::{
    Callback, CartesianPose, CartesianVelocities, Command, Finish, GeneratorCommand,
    JointPositions, JointVelocities, Next, Torques,
};

use crate::faults::course::{
    self, cartesian_pose, cartesian_velocities, joint_positions, joint_velocities,
};
use crate::faults::variant::Channel;

/// Deviation of a program from the course.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Misbehaviour {
    /// It follows the course to its end.
    Faultless,
    /// It finishes this many milliseconds after its first command.
    FinishesAt(u64),
    /// It panics in the call of this number, the first being 0.
    PanicsIn(u64),
    /// The function that commands torques at the same time panics in the call with this number.
    TorquesPanicIn(u64),
    /// It commands a NaN in the call of this number.
    CommandsNanIn(u64),
}

/// The message of a function's panic.
pub(crate) const PANIC_MESSAGE: &str = "a panic on purpose";

/// The progress of one function along the course.
#[derive(Clone, Debug)]
pub(crate) struct CourseFollower {
    misbehaviour: Misbehaviour,
    calls: u64,
    /// The robot's time since the first call, `[ms]`.
    elapsed: u64,
    start: Option<Box<RobotState>>,
}

impl CourseFollower {
    pub(crate) fn new(misbehaviour: Misbehaviour) -> Self {
        Self {
            misbehaviour,
            calls: 0,
            elapsed: 0,
            start: None,
        }
    }

    fn next<C: WithNan + Finish>(
        &mut self,
        state: &RobotState,
        step: Duration,
        command: fn(&RobotState, u64) -> C,
    ) -> Next<C> {
        let call = self.calls;
        self.calls += 1;
        self.elapsed += step.as_millis() as u64;
        let start = self.start.get_or_insert_with(|| Box::new(*state));
        let command = command(start, self.elapsed);
        match self.misbehaviour {
            Misbehaviour::PanicsIn(cycle) if call == cycle => panic!("{PANIC_MESSAGE}"),
            Misbehaviour::CommandsNanIn(cycle) if call == cycle => command.with_nan().into(),
            Misbehaviour::FinishesAt(end) if self.elapsed >= end => command.finish(),
            _ if self.elapsed >= course::END => command.finish(),
            _ => command.into(),
        }
    }

    /// Returns the command that answers `state`, `step` after the previous one, and true if it is
    /// the last.
    pub(crate) fn command(
        &mut self,
        version: Version,
        channel: Channel,
        state: &RobotState,
        step: Duration,
    ) -> (Command, bool) {
        let torques = channel.is_external().then_some(Torques([0.0; 7]));
        match channel.generator {
            MoveGeneratorMode::JointPosition => {
                motion(self.next(state, step, joint_positions), torques)
            }
            MoveGeneratorMode::JointVelocity => {
                motion(self.next(state, step, joint_velocities), torques)
            }
            MoveGeneratorMode::CartesianPosition => {
                motion(self.next(state, step, cartesian_pose), torques)
            }
            MoveGeneratorMode::CartesianVelocity => {
                motion(self.next(state, step, cartesian_velocities), torques)
            }
            MoveGeneratorMode::None => {
                let (torques, finished) = parts(self.next(state, step, course::torques));
                (Command::torques(version, torques), finished)
            }
        }
    }
}

/// The functions of a channel. The function that commands the generator, or else the torques,
/// misbehaves.
pub(crate) fn callback(version: Version, channel: Channel, misbehaviour: Misbehaviour) -> Callback {
    let mut follower = CourseFollower::new(misbehaviour);
    let callback = match channel.generator {
        MoveGeneratorMode::JointPosition => leading(version, follower, joint_positions),
        MoveGeneratorMode::JointVelocity => leading(version, follower, joint_velocities),
        MoveGeneratorMode::CartesianPosition => leading(version, follower, cartesian_pose),
        MoveGeneratorMode::CartesianVelocity => leading(version, follower, cartesian_velocities),
        MoveGeneratorMode::None => {
            return Callback::torques(version, move |state, step| {
                follower.next(state, step, course::torques)
            });
        }
    };
    if channel.is_external() {
        let mut calls = 0;
        callback.with_torques(move |_, _| {
            if misbehaviour == Misbehaviour::TorquesPanicIn(calls) {
                panic!("{PANIC_MESSAGE}");
            }
            calls += 1;
            Torques([0.0; 7])
        })
    } else {
        callback
    }
}

fn leading<C: GeneratorCommand + WithNan + Finish>(
    version: Version,
    mut follower: CourseFollower,
    command: fn(&RobotState, u64) -> C,
) -> Callback {
    Callback::motion::<C, _>(version, move |state, step| {
        follower.next(state, step, command)
    })
}

/// A command to a generator, with torques if there are any.
fn motion<C: GeneratorCommand>(next: Next<C>, torques: Option<Torques>) -> (Command, bool) {
    let (motion, finished) = parts(next);
    let motion = Some(motion.into());
    (Command { motion, torques }, finished)
}

/// Commands that can hold a NaN.
trait WithNan: Sized {
    fn with_nan(self) -> Self;
}

impl WithNan for Torques {
    fn with_nan(mut self) -> Self {
        self.0[6] = f64::NAN;
        self
    }
}

impl WithNan for JointPositions {
    fn with_nan(mut self) -> Self {
        self.0[6] = f64::NAN;
        self
    }
}

impl WithNan for JointVelocities {
    fn with_nan(mut self) -> Self {
        self.0[6] = f64::NAN;
        self
    }
}

impl WithNan for CartesianPose {
    fn with_nan(mut self) -> Self {
        self.O_T_EE[13] = f64::NAN;
        self
    }
}

impl WithNan for CartesianVelocities {
    fn with_nan(mut self) -> Self {
        self.O_dP_EE[5] = f64::NAN;
        self
    }
}

fn parts<C>(next: Next<C>) -> (C, bool) {
    let parts = next.into_parts();
    parts.unwrap_or_else(|code| panic!("no follower gives up, this one with {code}"))
}

//! Programs that follow the course, and those that leave it.

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

/// What a program does other than to follow the course to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Deed {
    /// Nothing.
    Faultless,
    /// It finishes so many milliseconds after its first command.
    FinishesAt(u64),
    /// It panics in the call of this number, the first being 0.
    PanicsIn(u64),
    /// The function that commands torques beside it panics in the call of this number.
    TorquesPanicIn(u64),
    /// In the call of this number it commands what is no number.
    CommandsNanIn(u64),
}

/// What a function that panics says.
pub(crate) const LAST_WORDS: &str = "the pilot has left";

/// One function's way along the course.
#[derive(Clone, Debug)]
pub(crate) struct Pilot {
    deed: Deed,
    calls: u64,
    /// The robot's time since the first call, `[ms]`.
    elapsed: u64,
    start: Option<Box<RobotState>>,
}

impl Pilot {
    pub(crate) fn new(deed: Deed) -> Self {
        Self {
            deed,
            calls: 0,
            elapsed: 0,
            start: None,
        }
    }

    fn next<C: Spoil + Finish>(
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
        match self.deed {
            Deed::PanicsIn(cycle) if call == cycle => panic!("{LAST_WORDS}"),
            Deed::CommandsNanIn(cycle) if call == cycle => command.spoilt().into(),
            Deed::FinishesAt(end) if self.elapsed >= end => command.finish(),
            _ if self.elapsed >= course::END => command.finish(),
            _ => command.into(),
        }
    }

    /// The command that answers `state`, `step` after the one before, and whether it is the last.
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
                let (torques, finished) = self.next(state, step, course::torques).into_parts();
                (Command::torques(version, torques), finished)
            }
        }
    }
}

/// The functions of a channel, of which the one that leads does the deed.
pub(crate) fn callback(version: Version, channel: Channel, deed: Deed) -> Callback {
    let mut pilot = Pilot::new(deed);
    let callback = match channel.generator {
        MoveGeneratorMode::JointPosition => leading(version, pilot, joint_positions),
        MoveGeneratorMode::JointVelocity => leading(version, pilot, joint_velocities),
        MoveGeneratorMode::CartesianPosition => leading(version, pilot, cartesian_pose),
        MoveGeneratorMode::CartesianVelocity => leading(version, pilot, cartesian_velocities),
        MoveGeneratorMode::None => {
            return Callback::torques(version, move |state, step| {
                pilot.next(state, step, course::torques)
            });
        }
    };
    if channel.is_external() {
        let mut calls = 0;
        callback.with_torques(move |_, _| {
            if deed == Deed::TorquesPanicIn(calls) {
                panic!("{LAST_WORDS}");
            }
            calls += 1;
            Torques([0.0; 7])
        })
    } else {
        callback
    }
}

fn leading<C: GeneratorCommand + Spoil + Finish>(
    version: Version,
    mut pilot: Pilot,
    command: fn(&RobotState, u64) -> C,
) -> Callback {
    Callback::motion::<C, _>(version, move |state, step| pilot.next(state, step, command))
}

/// A command to a generator, with torques where they are wanted.
fn motion<C: GeneratorCommand>(next: Next<C>, torques: Option<Torques>) -> (Command, bool) {
    let (motion, finished) = next.into_parts();
    let motion = Some(motion.into());
    (Command { motion, torques }, finished)
}

/// A command with a number in it that is none.
trait Spoil: Sized {
    fn spoilt(self) -> Self;
}

impl Spoil for Torques {
    fn spoilt(mut self) -> Self {
        self.0[6] = f64::NAN;
        self
    }
}

impl Spoil for JointPositions {
    fn spoilt(mut self) -> Self {
        self.0[6] = f64::NAN;
        self
    }
}

impl Spoil for JointVelocities {
    fn spoilt(mut self) -> Self {
        self.0[6] = f64::NAN;
        self
    }
}

impl Spoil for CartesianPose {
    fn spoilt(mut self) -> Self {
        self.O_T_EE[13] = f64::NAN;
        self
    }
}

impl Spoil for CartesianVelocities {
    fn spoilt(mut self) -> Self {
        self.O_dP_EE[5] = f64::NAN;
        self
    }
}

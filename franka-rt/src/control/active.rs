//! Active control: a thread of the program reads the states and writes one command in answer to
//! each state.

use super::{Command, Misfit};
use crate::control::Modes;
use crate::shaping::{InvalidCommand, check};

/// The program of a motion under active control: a thread of the user writes each command.
///
/// No filter and no limiter changes the commands, as with libfranka's `ActiveControl`.
#[derive(Clone, Copy, Debug)]
pub struct ActiveControl;

/// Reason why a command was not sent. The texts begin as in libfranka 0.21, `active_control*.h` and
/// `robot_impl.cpp`.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// No motion that accepts the command is running: the last command was written, or the robot
    /// has ended the motion.
    #[error("writeOnce must not be called after the motion has finished.")]
    NotRunning,
    /// The motion command contains torques, but the robot's own controller runs.
    #[error("Torques can only be commanded in kExternalController mode.")]
    TorquesUnwanted,
    /// The motion command contains no torques, but the motion requires them.
    #[error(
        "Torque command missing, please use writeOnce(const MotionGeneratorType& motion_generator_input, const Torques& \
         control_input) for external controllers. (here `write_motion_and_torques`)"
    )]
    TorquesMissing,
    /// The motion does not accept this kind of command.
    #[error("Wrong writeOnce method called for currently active control!")]
    WrongKind,
    /// The torques are marked as the last ones, but the motion generator still runs, because its
    /// own last command is missing.
    #[error("libfranka robot: Motion generator is still running! Can't stop external control")]
    GeneratorRunning,
    /// The motion does not accept this combination of motion command and torques.
    #[error(transparent)]
    Misfit(#[from] Misfit),
    /// A number of the command is invalid.
    #[error(transparent)]
    Invalid(#[from] InvalidCommand),
}

impl ActiveControl {
    /// Checks that a motion in `modes` accepts `command`. The order of the checks is libfranka's.
    pub(crate) fn check(
        &self,
        command: &Command,
        modes: Modes,
        finished: bool,
    ) -> Result<(), WriteError> {
        match (&command.motion, &command.torques) {
            (Some(motion), torques) if modes.has_generator() => {
                if motion.generator().in_state() != modes.generator {
                    return Err(WriteError::WrongKind);
                }
                match (modes.is_external(), torques) {
                    (false, Some(_)) => return Err(WriteError::TorquesUnwanted),
                    (true, None) => return Err(WriteError::TorquesMissing),
                    _ => {}
                }
            }
            (None, _) if finished && modes.has_generator() => {
                return Err(WriteError::GeneratorRunning);
            }
            _ => {}
        }
        command.check(modes)?;
        if let Some(motion) = &command.motion {
            motion.validate()?;
        }
        if let Some(torques) = &command.torques {
            check::finite(&torques.0)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use franka_proto::{ControllerMode, MotionGeneratorMode};

    use super::*;
    use crate::control::{CartesianPose, CartesianVelocities, JointPositions, JointVelocities};
    use crate::control::{MotionCommand, Torques};

    const POSITIONS: MotionCommand = MotionCommand::JointPositions(JointPositions([0.5; 7]));
    const VELOCITIES: MotionCommand = MotionCommand::JointVelocities(JointVelocities([0.5; 7]));
    const TORQUES: Torques = Torques([2.0; 7]);

    fn check(
        modes: (MotionGeneratorMode, ControllerMode),
        motion: Option<MotionCommand>,
        torques: Option<Torques>,
        finished: bool,
    ) -> Result<(), WriteError> {
        let modes = Modes {
            generator: modes.0,
            controller: modes.1,
        };
        ActiveControl.check(&Command { motion, torques }, modes, finished)
    }

    const INTERNAL: (MotionGeneratorMode, ControllerMode) = (
        MotionGeneratorMode::JointPosition,
        ControllerMode::CartesianImpedance,
    );
    const EXTERNAL: (MotionGeneratorMode, ControllerMode) = (
        MotionGeneratorMode::JointPosition,
        ControllerMode::ExternalController,
    );
    const ALONE: (MotionGeneratorMode, ControllerMode) = (
        MotionGeneratorMode::None,
        ControllerMode::ExternalController,
    );

    #[test]
    fn write_errors_come_in_the_reference_clients_order() {
        use WriteError as E;
        let bad = MotionCommand::JointPositions(JointPositions([f64::NAN; 7]));
        let bad_torques = Torques([f64::NAN; 7]);
        for (modes, motion, torques, finished, expected) in [
            // The kind is checked before the torques, and the torques are checked before the
            // numbers.
            (
                INTERNAL,
                Some(VELOCITIES),
                Some(bad_torques),
                false,
                Err(E::WrongKind),
            ),
            (EXTERNAL, Some(VELOCITIES), None, false, Err(E::WrongKind)),
            (
                INTERNAL,
                Some(bad),
                Some(bad_torques),
                false,
                Err(E::TorquesUnwanted),
            ),
            (EXTERNAL, Some(bad), None, true, Err(E::TorquesMissing)),
            // If only torques come as the last command, the error names the generator. Otherwise it
            // is the misfit.
            (
                INTERNAL,
                None,
                Some(bad_torques),
                true,
                Err(E::GeneratorRunning),
            ),
            (
                EXTERNAL,
                None,
                Some(TORQUES),
                true,
                Err(E::GeneratorRunning),
            ),
            (
                INTERNAL,
                None,
                Some(bad_torques),
                false,
                Err(Misfit::NoController.into()),
            ),
            (
                EXTERNAL,
                None,
                Some(bad_torques),
                false,
                Err(Misfit::Partial.into()),
            ),
            (
                ALONE,
                Some(bad),
                Some(TORQUES),
                false,
                Err(Misfit::NoGenerator.into()),
            ),
            (
                ALONE,
                Some(VELOCITIES),
                None,
                true,
                Err(Misfit::NoGenerator.into()),
            ),
            // Numbers are checked last, in the motion command before the torques.
            (
                INTERNAL,
                Some(bad),
                None,
                false,
                Err(InvalidCommand::NotFinite.into()),
            ),
            (
                EXTERNAL,
                Some(POSITIONS),
                Some(bad_torques),
                true,
                Err(InvalidCommand::NotFinite.into()),
            ),
            (
                ALONE,
                None,
                Some(bad_torques),
                true,
                Err(InvalidCommand::NotFinite.into()),
            ),
            (INTERNAL, Some(POSITIONS), None, true, Ok(())),
            (EXTERNAL, Some(POSITIONS), Some(TORQUES), false, Ok(())),
            (ALONE, None, Some(TORQUES), true, Ok(())),
        ] {
            let checked = check(modes, motion, torques, finished);
            assert_eq!(
                checked, expected,
                "{modes:?} {motion:?} {torques:?} {finished}"
            );
        }
    }

    #[test]
    fn cartesian_commands_are_held_against_what_they_stand_for() {
        let cartesian = |generator| (generator, ControllerMode::JointImpedance);
        let elbow = Some([0.1, 0.5]);
        let mut pose = CartesianPose {
            O_T_EE: core::array::from_fn(|i| if i % 5 == 0 { 1.0 } else { 0.0 }),
            elbow,
        };
        let modes = cartesian(MotionGeneratorMode::CartesianPosition);
        let sign = Err(InvalidCommand::ElbowSign.into());
        assert_eq!(check(modes, Some(pose.into()), None, false), sign);
        pose.O_T_EE[0] = 0.5;
        assert_eq!(
            check(modes, Some(pose.into()), None, false),
            Err(InvalidCommand::Transformation.into()),
            "the pose comes before its elbow"
        );
        let twist = CartesianVelocities {
            O_dP_EE: [0.0; 6],
            elbow,
        };
        let modes = cartesian(MotionGeneratorMode::CartesianVelocity);
        assert_eq!(check(modes, Some(twist.into()), None, false), sign);
    }
}

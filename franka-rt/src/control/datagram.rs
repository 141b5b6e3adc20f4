//! Encodes commands as a datagram, with libfranka's checks.

use franka_proto::{MoveGeneratorMode, RobotCommand, Version};

use super::{GeneratorCommand, JointVelocities, MotionCommand, Torques};
use crate::control::Modes;
use crate::shaping::{InvalidCommand, check};

/// Content of one cycle's datagram: a command to the motion generator, torques, or both. The modes
/// of the motion determine which of them are required.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Command for the motion generator.
    pub motion: Option<MotionCommand>,
    /// Torques for the joints.
    pub torques: Option<Torques>,
}

/// Reason why a command does not fit the current motion. The texts are taken from libfranka 0.21,
/// `robot_impl.cpp`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Misfit {
    /// The command contains a motion command, but no motion generator runs.
    #[error("libfranka robot: Trying to send motion command, but no motion generator running!")]
    NoGenerator,
    /// The command contains torques, but the robot's own controller runs.
    #[error("libfranka robot: Trying to send control command, but no controller running!")]
    NoController,
    /// The command contains only a motion command or only torques, but the motion requires both.
    #[error("libfranka robot: Trying to send partial robot command!")]
    Partial,
}

impl Command {
    /// Returns the command of a motion that is controlled with torques alone. If the protocol has
    /// no such motions, the command also contains zero joint velocities for a motion generator.
    pub fn torques(version: Version, torques: Torques) -> Self {
        let idle = JointVelocities::ZERO.into();
        Self {
            motion: (version.torque_generator() != MoveGeneratorMode::None).then_some(idle),
            torques: Some(torques),
        }
    }

    /// Returns a command of setpoints for the robot's own controller.
    pub(crate) fn setpoint(setpoint: MotionCommand) -> Self {
        Self {
            motion: Some(setpoint),
            torques: None,
        }
    }

    /// Checks that a motion in `modes` accepts the command.
    ///
    /// # Errors
    /// Returns the first [`Misfit`] that applies, in the order of the variants.
    pub fn check(&self, modes: Modes) -> Result<(), Misfit> {
        let (generator, external) = (modes.has_generator(), modes.is_external());
        match (self.motion.is_some(), self.torques.is_some()) {
            (true, _) if !generator => Err(Misfit::NoGenerator),
            (_, true) if !external => Err(Misfit::NoController),
            (motion, torques) if generator && external && motion != torques => Err(Misfit::Partial),
            _ => Ok(()),
        }
    }

    /// Returns the datagram that answers the state `message_id`. Values that the command does not
    /// contain are zero. If `finished` is true, the datagram sets one finishing flag: the flag of
    /// the motion generator if there is a motion command, otherwise the flag of the torques.
    ///
    /// # Errors
    /// Returns [`InvalidCommand::NotFinite`] if any value of the command is not finite.
    pub fn datagram(
        &self,
        message_id: u64,
        finished: bool,
    ) -> Result<RobotCommand, InvalidCommand> {
        let mut command = RobotCommand {
            message_id,
            motion_generation_finished: finished && self.motion.is_some(),
            torque_command_finished: finished && self.motion.is_none(),
            ..RobotCommand::default()
        };
        if let Some(motion) = &self.motion {
            motion.write_to(&mut command);
        }
        if let Some(Torques(tau)) = self.torques {
            command.tau_J_d = tau;
        }
        check::finite(&command.q_c)?;
        check::finite(&command.dq_c)?;
        check::finite(&command.O_T_EE_c)?;
        check::finite(&command.O_dP_EE_c)?;
        check::finite(command.elbow_c.as_ref().map_or(&[], |elbow| &elbow[..]))?;
        check::finite(&command.tau_J_d)?;
        Ok(command)
    }
}

#[cfg(test)]
mod tests {
    use franka_proto::{ControllerMode, MotionGeneratorMode};

    use super::*;
    use crate::control::{CartesianPose, CartesianVelocities, JointPositions};

    const MOTION: MotionCommand = MotionCommand::JointPositions(JointPositions([0.5; 7]));
    const TORQUES: Torques = Torques([2.0; 7]);

    fn modes(generator: MotionGeneratorMode, controller: ControllerMode) -> Modes {
        Modes {
            generator,
            controller,
        }
    }

    #[test]
    fn a_command_fits_the_modes_that_want_it() {
        use ControllerMode::{ExternalController, JointImpedance};
        use MotionGeneratorMode::{Idle, JointPosition, None as Nothing};
        let both = (Some(MOTION), Some(TORQUES));
        let motion = (Some(MOTION), None);
        let torques = (None, Some(TORQUES));
        for (generator, controller, (motion, torques), expected) in [
            (JointPosition, JointImpedance, motion, Ok(())),
            (
                JointPosition,
                JointImpedance,
                torques,
                Err(Misfit::NoController),
            ),
            (
                JointPosition,
                JointImpedance,
                both,
                Err(Misfit::NoController),
            ),
            (JointPosition, ExternalController, both, Ok(())),
            (
                JointPosition,
                ExternalController,
                motion,
                Err(Misfit::Partial),
            ),
            (
                JointPosition,
                ExternalController,
                torques,
                Err(Misfit::Partial),
            ),
            (Nothing, ExternalController, torques, Ok(())),
            (Nothing, ExternalController, both, Err(Misfit::NoGenerator)),
            (Idle, JointImpedance, motion, Err(Misfit::NoGenerator)),
            (Idle, JointImpedance, torques, Err(Misfit::NoController)),
        ] {
            let command = Command { motion, torques };
            let checked = command.check(modes(generator, controller));
            assert_eq!(
                checked, expected,
                "{generator:?} {controller:?} {command:?}"
            );
        }
    }

    #[test]
    #[allow(non_snake_case)]
    fn no_datagram_carries_a_non_finite_number() {
        let identity = core::array::from_fn(|i| if i % 5 == 0 { 1.0 } else { 0.0 });
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let pose = |O_T_EE, elbow| CartesianPose { O_T_EE, elbow }.into();
            let twist = |O_dP_EE, elbow| CartesianVelocities { O_dP_EE, elbow }.into();
            let motions: [MotionCommand; 7] = [
                JointPositions([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, bad]).into(),
                JointVelocities([bad, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).into(),
                pose([bad; 16], None),
                pose(identity, Some([bad, 1.0])),
                pose(identity, Some([0.0, bad])),
                twist([bad; 6], None),
                twist([0.0; 6], Some([bad, -1.0])),
            ];
            let motions = motions.map(|motion| Command {
                motion: Some(motion),
                torques: None,
            });
            let torques = Command::torques(Version::V10, Torques([bad; 7]));
            for command in motions.into_iter().chain([torques]) {
                let made = command.datagram(7, false);
                assert_eq!(made, Err(InvalidCommand::NotFinite), "{command:?}");
            }
        }
    }

    #[test]
    fn the_generators_flag_ends_a_motion_that_has_one() {
        let both = Command {
            motion: Some(MOTION),
            torques: Some(TORQUES),
        };
        let sent = both.datagram(7, true).unwrap();
        assert_eq!(sent.message_id, 7);
        assert_eq!((sent.q_c, sent.tau_J_d), ([0.5; 7], [2.0; 7]));
        assert!(sent.motion_generation_finished && !sent.torque_command_finished);
        let alone = Command::torques(Version::V10, TORQUES);
        let alone = alone.datagram(7, true).unwrap();
        assert!(!alone.motion_generation_finished && alone.torque_command_finished);
        let beside = Command::torques(Version::V5, TORQUES);
        let beside = beside.datagram(7, true).unwrap();
        assert!(beside.motion_generation_finished && !beside.torque_command_finished);
        let going_on = both.datagram(7, false).unwrap();
        assert!(!going_on.motion_generation_finished && !going_on.torque_command_finished);
    }
}

//! The command of one cycle, independent of the version.
#![allow(non_snake_case)]

use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

use crate::protocol::{DecodeError, EncodeError};
use crate::version::Version;
use crate::wire::{self, from_wire, to_wire};

/// The client's command for one cycle. The field names are the vendor's.
///
/// Set the fields of the active generator and controller, and leave the other fields zero. A
/// command has two halves: one for the generator, and one for the controller. The robot reads every
/// field of a half that it uses, and ignores a half that it does not use.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RobotCommand {
    /// `message_id` of the state that this command answers.
    pub message_id: u64,
    /// Joint positions `[rad]`.
    pub q_c: [f64; 7],
    /// Joint velocities `[rad/s]`.
    pub dq_c: [f64; 7],
    /// Pose of the end effector in the base frame, column-major `[m]`.
    pub O_T_EE_c: [f64; 16],
    /// Twist of the end effector in the base frame, linear then angular `[m/s, rad/s]`.
    pub O_dP_EE_c: [f64; 6],
    /// Angle of joint 3 `[rad]` and sign of joint 4 (-1, 0 or 1); with `None`, the robot chooses
    /// the elbow.
    pub elbow_c: Option<[f64; 2]>,
    /// True if this is the last command of a motion with a generator.
    pub motion_generation_finished: bool,
    /// Joint torques without gravity and friction `[N m]`.
    pub tau_J_d: [f64; 7],
    /// True if this is the last command of a torque motion without a generator; protocol 10 only.
    pub torque_command_finished: bool,
}

impl RobotCommand {
    /// Length in bytes of the longest datagram of any version. A buffer of this size is always
    /// sufficient.
    pub const MAX_SIZE: usize = size_of::<wire::RobotCommand<u8>>();

    /// Decodes a datagram of a client. Additional bytes are ignored, as if the kernel had truncated
    /// the datagram.
    ///
    /// # Errors
    /// Returns [`DecodeError::DatagramSize`] if there are fewer bytes than the version's command
    /// has.
    pub fn decode(version: Version, bytes: &[u8]) -> Result<Self, DecodeError> {
        (version.table().command_codec.decode)(bytes)
    }

    /// Writes the datagram for the robot into `buffer` and returns its length in bytes.
    ///
    /// # Errors
    /// Returns `EncodeError::Buffer` if `buffer` is too short ([`RobotCommand::MAX_SIZE`] is always
    /// sufficient). Returns `EncodeError::Unsupported` if the version does not support
    /// `torque_command_finished`. After an error, `buffer` is unchanged.
    pub fn encode(&self, version: Version, buffer: &mut [u8]) -> Result<usize, EncodeError> {
        (version.table().command_codec.encode)(self, buffer)
    }
}

/// Reader and writer of one version's command, for the version table.
#[derive(Clone, Copy)]
pub(crate) struct CommandCodec {
    pub(crate) size: usize,
    decode: fn(&[u8]) -> Result<RobotCommand, DecodeError>,
    encode: fn(&RobotCommand, &mut [u8]) -> Result<usize, EncodeError>,
}

impl CommandCodec {
    pub(crate) const fn of<F: Finish>() -> Self {
        Self {
            size: size_of::<wire::RobotCommand<F>>(),
            decode: decode::<F>,
            encode: encode::<F>,
        }
    }
}

/// The last field of the torque half. It is a byte in protocol 10, and does not exist in protocol
/// 5.
pub(crate) trait Finish:
    Copy + FromBytes + IntoBytes + Immutable + KnownLayout + Unaligned
{
    fn finished(self) -> bool;
    fn of(finished: bool) -> Option<Self>;
}

impl Finish for u8 {
    fn finished(self) -> bool {
        self != 0
    }

    fn of(finished: bool) -> Option<Self> {
        Some(u8::from(finished))
    }
}

impl Finish for () {
    fn finished(self) -> bool {
        false
    }

    fn of(finished: bool) -> Option<Self> {
        (!finished).then_some(())
    }
}

fn decode<F: Finish>(bytes: &[u8]) -> Result<RobotCommand, DecodeError> {
    let (wire, _) = wire::RobotCommand::<F>::ref_from_prefix(bytes)
        .map_err(|_| DecodeError::datagram::<wire::RobotCommand<F>>(bytes))?;
    let motion = &wire.motion;
    Ok(RobotCommand {
        message_id: wire.message_id.get(),
        q_c: from_wire(&motion.q_c),
        dq_c: from_wire(&motion.dq_c),
        O_T_EE_c: from_wire(&motion.O_T_EE_c),
        O_dP_EE_c: from_wire(&motion.O_dP_EE_c),
        elbow_c: (motion.valid_elbow != 0).then(|| from_wire(&motion.elbow_c)),
        motion_generation_finished: motion.motion_generation_finished != 0,
        tau_J_d: from_wire(&wire.control.tau_J_d),
        torque_command_finished: wire.control.torque_command_finished.finished(),
    })
}

fn encode<F: Finish>(command: &RobotCommand, buffer: &mut [u8]) -> Result<usize, EncodeError> {
    let size = size_of::<wire::RobotCommand<F>>();
    let finish = F::of(command.torque_command_finished).ok_or(EncodeError::Unsupported {
        what: "torque_command_finished",
    })?;
    let got = buffer.len();
    let (wire, _) = wire::RobotCommand::<F>::mut_from_prefix(buffer)
        .map_err(|_| EncodeError::Buffer { got, needed: size })?;
    *wire = wire::RobotCommand {
        message_id: command.message_id.into(),
        motion: wire::MotionGeneratorCommand {
            q_c: to_wire(&command.q_c),
            dq_c: to_wire(&command.dq_c),
            O_T_EE_c: to_wire(&command.O_T_EE_c),
            O_dP_EE_c: to_wire(&command.O_dP_EE_c),
            elbow_c: to_wire(&command.elbow_c.unwrap_or_default()),
            valid_elbow: u8::from(command.elbow_c.is_some()),
            motion_generation_finished: u8::from(command.motion_generation_finished),
        },
        control: wire::ControllerCommand {
            tau_J_d: to_wire(&command.tau_J_d),
            torque_command_finished: finish,
        },
    };
    Ok(size)
}

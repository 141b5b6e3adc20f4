//! The client's datagram. While a motion runs, the client sends one datagram for each state.
#![allow(non_snake_case)]

use zerocopy::byteorder::little_endian::U64;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

use super::F64;

/// The client's command for a motion generator.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct MotionGeneratorCommand {
    /// Joint positions `[rad]`.
    pub q_c: [F64; 7],
    /// Joint velocities `[rad/s]`.
    pub dq_c: [F64; 7],
    /// Pose of the end effector in the base frame, column-major `[m]`.
    pub O_T_EE_c: [F64; 16],
    /// Twist of the end effector in the base frame, linear then angular `[m/s, rad/s]`.
    pub O_dP_EE_c: [F64; 6],
    /// Angle of joint 3 `[rad]` and sign of the elbow.
    pub elbow_c: [F64; 2],
    /// Non-zero if `elbow_c` is valid.
    pub valid_elbow: u8,
    /// Non-zero if this is the last command of the motion.
    pub motion_generation_finished: u8,
}

/// The client's command for a torque controller.
///
/// `Finish` is the byte that only protocol 10 has; protocol 5 has `()` in its place.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct ControllerCommand<Finish> {
    /// Joint torques without gravity and friction `[N m]`.
    pub tau_J_d: [F64; 7],
    /// Non-zero if this is the last command of a torque motion.
    pub torque_command_finished: Finish,
}

/// `RobotCommand` of `research_interface/robot/rbk_types.h`, protocols 5 and 10.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct RobotCommand<Finish> {
    /// `message_id` of the state that this command answers.
    pub message_id: U64,
    /// Part for the motion generator.
    pub motion: MotionGeneratorCommand,
    /// Part for the torque controller.
    pub control: ControllerCommand<Finish>,
}

assert_layout!(MotionGeneratorCommand, size: 306, {
    q_c: 0, dq_c: 56, O_T_EE_c: 112, O_dP_EE_c: 240, elbow_c: 288, valid_elbow: 304,
    motion_generation_finished: 305,
});
assert_layout!(ControllerCommand<u8>, size: 57, { tau_J_d: 0, torque_command_finished: 56 });
assert_layout!(ControllerCommand<()>, size: 56, { tau_J_d: 0 });
assert_layout!(RobotCommand<u8>, size: 371, {
    message_id: 0, motion.q_c: 8, motion.dq_c: 64, motion.O_T_EE_c: 120, motion.O_dP_EE_c: 248,
    motion.elbow_c: 296, motion.valid_elbow: 312, motion.motion_generation_finished: 313,
    control.tau_J_d: 314, control.torque_command_finished: 370,
});
assert_layout!(RobotCommand<()>, size: 370, {
    message_id: 0, motion.q_c: 8, motion.dq_c: 64, motion.O_T_EE_c: 120, motion.O_dP_EE_c: 248,
    motion.elbow_c: 296, motion.valid_elbow: 312, motion.motion_generation_finished: 313,
    control.tau_J_d: 314,
});

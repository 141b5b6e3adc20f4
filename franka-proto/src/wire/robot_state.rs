//! The robot's datagram. The robot sends one datagram per millisecond.
#![allow(non_snake_case)]

use zerocopy::byteorder::little_endian::U64;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

use super::{F32, F64};

/// `RobotState` of `research_interface/robot/rbk_types.h`, protocols 5 and 10.
///
/// `R` is the number type of the version: [`F32`] in protocol 10, [`F64`] in protocol 5. `A` is the
/// block that only protocol 10 has, [`Accelerometers`]; protocol 5 has `()` in its place. Units and
/// frames are the same as in [`crate::RobotState`].
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct RobotState<R, A> {
    /// Counter of milliseconds.
    pub message_id: U64,
    /// Measured pose of the end effector in the base frame.
    pub O_T_EE: [R; 16],
    /// Last desired pose of the motion generation, in the base frame.
    pub O_T_EE_d: [R; 16],
    /// Pose of the end effector in the flange frame: `F_T_NE * NE_T_EE`.
    pub F_T_EE: [R; 16],
    /// Pose of the stiffness frame in the end-effector frame.
    pub EE_T_K: [R; 16],
    /// Pose of the nominal end effector in the flange frame.
    pub F_T_NE: [R; 16],
    /// Pose of the end effector in the nominal end-effector frame.
    pub NE_T_EE: [R; 16],
    /// Mass of the end effector.
    pub m_ee: R,
    /// Inertia of the end effector about its centre of mass.
    pub I_ee: [R; 9],
    /// Centre of mass of the end effector in the flange frame.
    pub F_x_Cee: [R; 3],
    /// Mass of the load.
    pub m_load: R,
    /// Inertia of the load about its centre of mass.
    pub I_load: [R; 9],
    /// Centre of mass of the load in the flange frame.
    pub F_x_Cload: [R; 3],
    /// Measured elbow.
    pub elbow: [R; 2],
    /// Desired elbow.
    pub elbow_d: [R; 2],
    /// Measured link-side joint torques, gravity included.
    pub tau_J: [R; 7],
    /// Desired joint torques, gravity excluded.
    pub tau_J_d: [R; 7],
    /// Derivatives of the measured joint torques.
    pub dtau_J: [R; 7],
    /// Measured joint positions.
    pub q: [R; 7],
    /// Desired joint positions.
    pub q_d: [R; 7],
    /// Measured joint velocities.
    pub dq: [R; 7],
    /// Desired joint velocities.
    pub dq_d: [R; 7],
    /// Desired joint accelerations.
    pub ddq_d: [R; 7],
    /// Current contact level of each joint: 0 or 1.
    pub joint_contact: [R; 7],
    /// Current contact level of each Cartesian axis: 0 or 1.
    pub cartesian_contact: [R; 6],
    /// Collision level of each joint: 0 or 1. It stays set until the recovery.
    pub joint_collision: [R; 7],
    /// Collision level of each Cartesian axis: 0 or 1. It stays set until the recovery.
    pub cartesian_collision: [R; 6],
    /// Estimated external joint torques, low-passed.
    pub tau_ext_hat_filtered: [R; 7],
    /// Estimated external wrench on the stiffness frame, in the base frame.
    pub O_F_ext_hat_K: [R; 6],
    /// Estimated external wrench on the stiffness frame, in the stiffness frame.
    pub K_F_ext_hat_K: [R; 6],
    /// Desired twist of the end effector in the base frame.
    pub O_dP_EE_d: [R; 6],
    /// Acceleration of the base, gravity included.
    pub O_ddP_O: [R; 3],
    /// Last commanded elbow.
    pub elbow_c: [R; 2],
    /// Velocity of the commanded elbow.
    pub delbow_c: [R; 2],
    /// Acceleration of the commanded elbow.
    pub ddelbow_c: [R; 2],
    /// Last commanded pose of the end effector in the base frame.
    pub O_T_EE_c: [R; 16],
    /// Last commanded twist of the end effector in the base frame.
    pub O_dP_EE_c: [R; 6],
    /// Last commanded acceleration of the end effector in the base frame.
    pub O_ddP_EE_c: [R; 6],
    /// Motor positions.
    pub theta: [R; 7],
    /// Motor velocities.
    pub dtheta: [R; 7],
    /// The accelerometers, or `()` if the version has no accelerometers.
    pub accelerometers: A,
    /// Active motion generator, with its number in states.
    pub motion_generator_mode: u8,
    /// Active controller, with its number in states.
    pub controller_mode: u8,
    /// Errors that currently block the robot, one flag each.
    pub errors: [u8; 41],
    /// Errors that ended the last motion, one flag each.
    pub reflex_reason: [u8; 41],
    /// The overall mode of the robot.
    pub robot_mode: u8,
    /// Share of the last 100 commands that arrived in time.
    pub control_command_success_rate: R,
}

/// The block of accelerometers in a state of protocol 10.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct Accelerometers {
    /// Upper accelerometer of joints 1 to 6.
    pub top: [[F32; 3]; 6],
    /// Lower accelerometer of joints 1 to 6.
    pub bottom: [[F32; 3]; 6],
}

assert_layout!(RobotState<F32, Accelerometers>, size: 1377, {
    message_id: 0, O_T_EE: 8, O_T_EE_d: 72, F_T_EE: 136, EE_T_K: 200, F_T_NE: 264, NE_T_EE: 328,
    m_ee: 392, I_ee: 396, F_x_Cee: 432, m_load: 444, I_load: 448, F_x_Cload: 484, elbow: 496,
    elbow_d: 504, tau_J: 512, tau_J_d: 540, dtau_J: 568, q: 596, q_d: 624, dq: 652, dq_d: 680,
    ddq_d: 708, joint_contact: 736, cartesian_contact: 764, joint_collision: 788,
    cartesian_collision: 816, tau_ext_hat_filtered: 840, O_F_ext_hat_K: 868, K_F_ext_hat_K: 892,
    O_dP_EE_d: 916, O_ddP_O: 940, elbow_c: 952, delbow_c: 960, ddelbow_c: 968, O_T_EE_c: 976,
    O_dP_EE_c: 1040, O_ddP_EE_c: 1064, theta: 1088, dtheta: 1116, accelerometers.top: 1144,
    accelerometers.bottom: 1216, motion_generator_mode: 1288, controller_mode: 1289, errors:
    1290, reflex_reason: 1331, robot_mode: 1372, control_command_success_rate: 1373,
});
assert_layout!(RobotState<F64, ()>, size: 2373, {
    message_id: 0, O_T_EE: 8, O_T_EE_d: 136, F_T_EE: 264, EE_T_K: 392, F_T_NE: 520, NE_T_EE:
    648, m_ee: 776, I_ee: 784, F_x_Cee: 856, m_load: 880, I_load: 888, F_x_Cload: 960, elbow:
    984, elbow_d: 1000, tau_J: 1016, tau_J_d: 1072, dtau_J: 1128, q: 1184, q_d: 1240, dq: 1296,
    dq_d: 1352, ddq_d: 1408, joint_contact: 1464, cartesian_contact: 1520, joint_collision:
    1568, cartesian_collision: 1624, tau_ext_hat_filtered: 1672, O_F_ext_hat_K: 1728,
    K_F_ext_hat_K: 1776, O_dP_EE_d: 1824, O_ddP_O: 1872, elbow_c: 1896, delbow_c: 1912,
    ddelbow_c: 1928, O_T_EE_c: 1944, O_dP_EE_c: 2072, O_ddP_EE_c: 2120, theta: 2168, dtheta:
    2224, motion_generator_mode: 2280, controller_mode: 2281, errors: 2282, reflex_reason: 2323,
    robot_mode: 2364, control_command_success_rate: 2365,
});

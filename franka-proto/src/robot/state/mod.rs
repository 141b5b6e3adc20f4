//! The robot's state of one millisecond, independent of the version.
#![allow(non_snake_case)]

mod codec;
mod text;
mod total_load;

pub(crate) use codec::{AccelerometerBlock, GeneratorModes, StateCodec};
pub use text::StateText;
pub use total_load::TotalLoad;

use crate::protocol::{DecodeError, EncodeError};
use crate::robot::Errors;
use crate::robot::{ControllerMode, MotionGeneratorMode, RobotMode};
use crate::version::Version;
use crate::wire;

/// All values of one datagram of the robot. The field names are the vendor's.
///
/// Frames are named as by the vendor: O is the base, F the flange, NE the nominal end effector, EE
/// the end effector, and K the stiffness frame. `X_T_Y` is the pose of Y in X as a 4x4 matrix,
/// column-major (index `4 * column + row`). Inertia matrices are 3x3, column-major.
///
/// [`Default`] has identities for poses, [`ControllerMode::Other`], and zero everywhere else.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RobotState {
    /// The robot's clock in milliseconds. It advances by one with each cycle.
    pub message_id: u64,
    /// Measured pose of the end effector in the base frame; column-major, `[m]`.
    pub O_T_EE: [f64; 16],
    /// Last desired pose of the motion generation, in the base frame; column-major, `[m]`.
    pub O_T_EE_d: [f64; 16],
    /// Pose of the end effector in the flange frame: `F_T_NE * NE_T_EE`; column-major, `[m]`.
    pub F_T_EE: [f64; 16],
    /// Pose of the stiffness frame in the end-effector frame; column-major, `[m]`.
    pub EE_T_K: [f64; 16],
    /// Pose of the nominal end effector in the flange frame; column-major, `[m]`.
    pub F_T_NE: [f64; 16],
    /// Pose of the end effector in the nominal end-effector frame; column-major, `[m]`.
    pub NE_T_EE: [f64; 16],
    /// Mass of the end effector; `[kg]`.
    pub m_ee: f64,
    /// Inertia of the end effector about its centre of mass; column-major, `[kg m^2]`.
    pub I_ee: [f64; 9],
    /// Centre of mass of the end effector in the flange frame; `[m]`.
    pub F_x_Cee: [f64; 3],
    /// Mass of the load; `[kg]`.
    pub m_load: f64,
    /// Inertia of the load about its centre of mass; column-major, `[kg m^2]`.
    pub I_load: [f64; 9],
    /// Centre of mass of the load in the flange frame; `[m]`.
    pub F_x_Cload: [f64; 3],
    /// Measured elbow; angle of joint 3 `[rad]` and sign of joint 4.
    pub elbow: [f64; 2],
    /// Desired elbow; angle of joint 3 `[rad]` and sign of joint 4.
    pub elbow_d: [f64; 2],
    /// Measured link-side joint torques, gravity included; `[N m]`.
    pub tau_J: [f64; 7],
    /// Desired joint torques, gravity excluded; `[N m]`.
    pub tau_J_d: [f64; 7],
    /// Derivatives of the measured joint torques; `[N m/s]`.
    pub dtau_J: [f64; 7],
    /// Measured joint positions; `[rad]`.
    pub q: [f64; 7],
    /// Desired joint positions; `[rad]`.
    pub q_d: [f64; 7],
    /// Measured joint velocities; `[rad/s]`.
    pub dq: [f64; 7],
    /// Desired joint velocities; `[rad/s]`.
    pub dq_d: [f64; 7],
    /// Desired joint accelerations; `[rad/s^2]`.
    pub ddq_d: [f64; 7],
    /// Current contact level of each joint: 0 or 1.
    pub joint_contact: [f64; 7],
    /// Current contact level of each Cartesian axis: 0 or 1.
    pub cartesian_contact: [f64; 6],
    /// Collision level of each joint: 0 or 1. It stays set until the recovery.
    pub joint_collision: [f64; 7],
    /// Collision level of each Cartesian axis: 0 or 1. It stays set until the recovery.
    pub cartesian_collision: [f64; 6],
    /// Estimated external joint torques, low-passed; `[N m]`.
    pub tau_ext_hat_filtered: [f64; 7],
    /// Estimated external wrench in the base frame; force then torque about the origin of the base,
    /// positive when the robot pushes the environment, `[N, N m]`. The values are zero near a
    /// singularity. [`wrench_at_stiffness_frame`](Self::wrench_at_stiffness_frame) returns the
    /// torque about the origin of the stiffness frame.
    pub O_F_ext_hat_K: [f64; 6],
    /// Estimated external wrench on the stiffness frame, in the stiffness frame; force then torque,
    /// positive when the robot pushes the environment, `[N, N m]`. The values are zero near a
    /// singularity.
    pub K_F_ext_hat_K: [f64; 6],
    /// Desired twist of the end effector in the base frame; linear then angular, `[m/s,
    /// rad/s]`.
    pub O_dP_EE_d: [f64; 6],
    /// Acceleration of the base, gravity included; `[m/s^2]`.
    pub O_ddP_O: [f64; 3],
    /// Last commanded elbow; angle of joint 3 `[rad]` and sign of joint 4. The values are zero
    /// while the client commands joint motions; see [`commanded_elbow`](Self::commanded_elbow).
    pub elbow_c: [f64; 2],
    /// Velocity of the commanded elbow: velocity of joint 3 `[rad/s]`, then 0.
    pub delbow_c: [f64; 2],
    /// Acceleration of the commanded elbow: acceleration of joint 3 `[rad/s^2]`, then 0.
    pub ddelbow_c: [f64; 2],
    /// Last commanded pose of the end effector in the base frame; column-major, `[m]`. The values
    /// are zero while the client commands joint motions; see
    /// [`commanded_pose`](Self::commanded_pose).
    pub O_T_EE_c: [f64; 16],
    /// Last commanded twist of the end effector in the base frame; linear then angular, `[m/s,
    /// rad/s]`.
    pub O_dP_EE_c: [f64; 6],
    /// Last commanded acceleration of the end effector in the base frame; `[m/s^2, rad/s^2]`.
    pub O_ddP_EE_c: [f64; 6],
    /// Motor positions; `[rad]`.
    pub theta: [f64; 7],
    /// Motor velocities; `[rad/s]`.
    pub dtheta: [f64; 7],
    /// Upper accelerometer of joints 1 to 6, in the frame of its board `[m/s^2]`; zero in protocol
    /// 5.
    pub accelerometer_top: [[f32; 3]; 6],
    /// Lower accelerometer of joints 1 to 6, in the frame of its board `[m/s^2]`; zero in protocol
    /// 5.
    pub accelerometer_bottom: [[f32; 3]; 6],
    /// Active motion generator.
    pub motion_generator_mode: MotionGeneratorMode,
    /// Active controller.
    pub controller_mode: ControllerMode,
    /// Errors that currently block the robot (libfranka's `current_errors`).
    pub errors: Errors,
    /// Errors that ended the last motion (libfranka's `last_motion_errors`).
    pub reflex_reason: Errors,
    /// The overall mode of the robot.
    pub robot_mode: RobotMode,
    /// Share of the last 100 commands that arrived in time, 0 to 1. It is 0 while no control runs.
    pub control_command_success_rate: f64,
}

impl RobotState {
    /// Length in bytes of the longest datagram of any version. A buffer of this size is always
    /// sufficient.
    pub const MAX_SIZE: usize = size_of::<wire::RobotState<wire::F64, ()>>();

    /// Decodes a datagram of the robot. Additional bytes are ignored, as if the kernel had
    /// truncated the datagram.
    ///
    /// # Errors
    /// Returns [`DecodeError::DatagramSize`] if there are fewer bytes than the version's state has.
    #[inline]
    pub fn decode(version: Version, bytes: &[u8]) -> Result<Self, DecodeError> {
        (version.table().state_codec.decode)(bytes)
    }

    /// Writes the datagram for a client into `buffer` and returns its length in bytes.
    ///
    /// Numbers are rounded to the precision of the version. Protocol 5 has no accelerometers, so
    /// they are omitted.
    ///
    /// # Errors
    /// Returns `EncodeError::Buffer` if `buffer` is too short ([`RobotState::MAX_SIZE`] is always
    /// sufficient). Returns `EncodeError::Unsupported` if the version lacks the motion generator
    /// mode. After an error, `buffer` is unchanged.
    pub fn encode(&self, version: Version, buffer: &mut [u8]) -> Result<usize, EncodeError> {
        (version.table().state_codec.encode)(self, buffer)
    }

    /// Returns the last commanded pose of the end effector, column-major `[m]`. This is `O_T_EE_c`
    /// or else `O_T_EE_d`, if it is a rigid transformation, and otherwise `O_T_EE`.
    ///
    /// Robots leave `O_T_EE_c` at zero while the client commands joint motions (recorded on a
    /// Franka Research 3), and a zero matrix is not a pose. If a matrix contains a number that is
    /// not finite, it is returned unchanged, so the caller can detect the invalid state.
    #[must_use]
    pub fn commanded_pose(&self) -> &[f64; 16] {
        let poses = [&self.O_T_EE_c, &self.O_T_EE_d];
        let broken = |pose: &[f64; 16]| pose.iter().any(|x| !x.is_finite());
        let found = poses
            .into_iter()
            .find(|pose| is_rigid(pose) || broken(pose));
        found.unwrap_or(&self.O_T_EE)
    }

    /// Returns the last commanded elbow: `elbow_c` if it is set, otherwise `elbow_d` if it is set,
    /// otherwise `elbow`. Robots leave `elbow_c` at zero whenever `O_T_EE_c` is zero.
    #[must_use]
    pub fn commanded_elbow(&self) -> [f64; 2] {
        let elbows = [self.elbow_c, self.elbow_d];
        let filled = elbows.into_iter().find(|elbow| *elbow != [0.0, 0.0]);
        filled.unwrap_or(self.elbow)
    }

    /// Returns true if the client must send motion commands.
    #[must_use]
    pub fn generator_running(&self) -> bool {
        self.motion_generator_mode.is_running()
    }

    /// Returns true if the client must send torques.
    #[must_use]
    pub fn controller_running(&self) -> bool {
        self.controller_mode.is_running()
    }

    /// Returns true if a motion of the client runs: [`generator_running`](Self::generator_running)
    /// or [`controller_running`](Self::controller_running). A motion has ended when the value
    /// becomes false, regardless of [`RobotState::robot_mode`] (libfranka 0.21).
    #[must_use]
    pub fn motion_running(&self) -> bool {
        self.generator_running() || self.controller_running()
    }

    /// Returns the estimated external wrench in base axes, with the torque about the origin of the
    /// stiffness frame, `[N, N m]`. Values are positive when the robot pushes the environment.
    ///
    /// [`O_F_ext_hat_K`](Self::O_F_ext_hat_K) contains the torque about the origin of the base, to
    /// which a force of 10 N at a distance of half a metre contributes 5 N m.
    #[must_use]
    pub fn wrench_at_stiffness_frame(&self) -> [f64; 6] {
        let [x, y, z, ..] = self.O_F_ext_hat_K;
        let [.., a, b, c] = self.K_F_ext_hat_K;
        let [a, b, c] = rotate(&self.O_T_EE, rotate(&self.EE_T_K, [a, b, c]));
        [x, y, z, a, b, c]
    }

    /// Returns the end effector and the load as one body. The result is bit-identical to
    /// libfranka's result for a state of this version.
    ///
    /// As in libfranka, the masses are added with the precision of the version's numbers.
    /// Everything else is computed as `f64`.
    #[must_use]
    pub fn total_load(&self, version: Version) -> TotalLoad {
        let m_total = (version.table().state_codec.add)(self.m_ee, self.m_load);
        TotalLoad::of(self, m_total)
    }
}

/// Rotates a vector by the rotation of a column-major pose.
fn rotate(pose: &[f64; 16], [x, y, z]: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|i| pose[i] * x + pose[4 + i] * y + pose[8 + i] * z)
}

/// Returns true if a column-major matrix is a rigid transformation, within the rounding of the
/// vendor's constants. `franka_model::transform` accepts every such matrix.
fn is_rigid(pose: &[f64; 16]) -> bool {
    let [x, y, z] = [0, 4, 8].map(|i| [pose[i], pose[i + 1], pose[i + 2]]);
    if (pose[3], pose[7], pose[11], pose[15]) != (0.0, 0.0, 0.0, 1.0) {
        return false;
    }
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let off = [
        dot(x, x) - 1.0,
        dot(y, y) - 1.0,
        dot(z, z) - 1.0,
        dot(x, y),
        dot(y, z),
        dot(z, x),
    ];
    // Without branches: several places read the commanded pose in each cycle.
    let near = |near, off: &f64| near & (off.abs() <= DISTORTION_MAX);
    let right_handed = dot(cross(x, y), z) > 0.0;
    right_handed & off.iter().fold(true, near)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    core::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

/// Largest deviation of a product of two axes from the product of exact rotation axes. The vendor's
/// 0.7071 for `sqrt(1/2)` causes 2e-5.
const DISTORTION_MAX: f64 = 1e-3;

impl Default for RobotState {
    fn default() -> Self {
        Self {
            message_id: 0,
            O_T_EE: IDENTITY,
            O_T_EE_d: IDENTITY,
            F_T_EE: IDENTITY,
            EE_T_K: IDENTITY,
            F_T_NE: IDENTITY,
            NE_T_EE: IDENTITY,
            m_ee: 0.0,
            I_ee: [0.0; 9],
            F_x_Cee: [0.0; 3],
            m_load: 0.0,
            I_load: [0.0; 9],
            F_x_Cload: [0.0; 3],
            elbow: [0.0; 2],
            elbow_d: [0.0; 2],
            tau_J: [0.0; 7],
            tau_J_d: [0.0; 7],
            dtau_J: [0.0; 7],
            q: [0.0; 7],
            q_d: [0.0; 7],
            dq: [0.0; 7],
            dq_d: [0.0; 7],
            ddq_d: [0.0; 7],
            joint_contact: [0.0; 7],
            cartesian_contact: [0.0; 6],
            joint_collision: [0.0; 7],
            cartesian_collision: [0.0; 6],
            tau_ext_hat_filtered: [0.0; 7],
            O_F_ext_hat_K: [0.0; 6],
            K_F_ext_hat_K: [0.0; 6],
            O_dP_EE_d: [0.0; 6],
            O_ddP_O: [0.0; 3],
            elbow_c: [0.0; 2],
            delbow_c: [0.0; 2],
            ddelbow_c: [0.0; 2],
            O_T_EE_c: IDENTITY,
            O_dP_EE_c: [0.0; 6],
            O_ddP_EE_c: [0.0; 6],
            theta: [0.0; 7],
            dtheta: [0.0; 7],
            accelerometer_top: [[0.0; 3]; 6],
            accelerometer_bottom: [[0.0; 3]; 6],
            motion_generator_mode: MotionGeneratorMode::Idle,
            controller_mode: ControllerMode::Other,
            errors: Errors::NONE,
            reflex_reason: Errors::NONE,
            robot_mode: RobotMode::Other,
            control_command_success_rate: 0.0,
        }
    }
}

/// The identity as a column-major 4x4 matrix.
const IDENTITY: [f64; 16] = [
    1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
];

#[cfg(test)]
mod tests {
    use super::*;

    fn moved_by(metres: f64) -> [f64; 16] {
        let mut pose = IDENTITY;
        pose[12] = metres;
        pose
    }

    #[test]
    fn the_commanded_pose_is_the_first_that_is_one() {
        let mut sheared = moved_by(0.1);
        sheared[4] = 0.1;
        let mut mirrored = moved_by(0.1);
        mirrored[10] = -1.0;
        let mut empty = [0.0; 16];
        empty[15] = 1.0; // not empty, and still not a pose
        for none in [sheared, mirrored, empty, [0.0; 16]] {
            let mut state = RobotState {
                O_T_EE_c: none,
                O_T_EE_d: moved_by(0.2),
                O_T_EE: moved_by(0.3),
                ..RobotState::default()
            };
            assert_eq!(state.commanded_pose(), &moved_by(0.2), "{none:?}");
            state.O_T_EE_d = none;
            assert_eq!(state.commanded_pose(), &moved_by(0.3), "{none:?}");
        }
        let infinite = RobotState {
            O_T_EE_c: moved_by(f64::INFINITY),
            O_T_EE_d: moved_by(0.2),
            ..RobotState::default()
        };
        assert_eq!(infinite.commanded_pose(), &moved_by(f64::INFINITY));
        let mut rounded = moved_by(0.1);
        // The block is a rotation by thirty degrees, rounded to four digits.
        (rounded[0], rounded[1], rounded[4], rounded[5]) = (0.8660, -0.5, 0.5, 0.8660);
        let state = RobotState {
            O_T_EE_c: rounded,
            ..RobotState::default()
        };
        assert_eq!(state.commanded_pose(), &rounded);
    }
}

//! Requests that set parameters. The robot keeps a parameter until the next request. All replies
//! are only a status.
#![allow(non_snake_case)]

use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

use crate::wire::F64;

/// `SetCollisionBehavior::Request`: thresholds of contact (lower) and collision (upper).
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct SetCollisionBehavior {
    /// Contact threshold of the joint torques while accelerating `[N m]`.
    pub lower_torque_thresholds_acceleration: [F64; 7],
    /// Collision threshold of the joint torques while accelerating `[N m]`.
    pub upper_torque_thresholds_acceleration: [F64; 7],
    /// Contact threshold of the joint torques at constant velocity `[N m]`.
    pub lower_torque_thresholds_nominal: [F64; 7],
    /// Collision threshold of the joint torques at constant velocity `[N m]`.
    pub upper_torque_thresholds_nominal: [F64; 7],
    /// Contact threshold of the wrench while accelerating `[N, N m]`.
    pub lower_force_thresholds_acceleration: [F64; 6],
    /// Collision threshold of the wrench while accelerating `[N, N m]`.
    pub upper_force_thresholds_acceleration: [F64; 6],
    /// Contact threshold of the wrench at constant velocity `[N, N m]`.
    pub lower_force_thresholds_nominal: [F64; 6],
    /// Collision threshold of the wrench at constant velocity `[N, N m]`.
    pub upper_force_thresholds_nominal: [F64; 6],
}

/// Payload of `SetJointImpedance::Request`.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct SetJointImpedance {
    /// Joint stiffnesses `[N m/rad]`.
    pub K_theta: [F64; 7],
}

/// Payload of `SetCartesianImpedance::Request`.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct SetCartesianImpedance {
    /// Stiffnesses in the stiffness frame `[N/m, N m/rad]`.
    pub K_x: [F64; 6],
}

/// Payload of `SetGuidingMode::Request`.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct SetGuidingMode {
    /// Non-zero for each free axis: x, y, z, roll, pitch, yaw.
    pub guiding_mode: [u8; 6],
    /// Non-zero if the elbow is free.
    pub nullspace: u8,
}

/// Payload of `SetEEToK::Request` and `SetNEToEE::Request`: a pose.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct SetFrame {
    /// `EE_T_K` or `NE_T_EE`, column-major `[m]`.
    pub transform: [F64; 16],
}

/// Payload of `SetLoad::Request`.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct SetLoad {
    /// Mass `[kg]`.
    pub m_load: F64,
    /// Centre of mass in the flange frame `[m]`.
    pub F_x_Cload: [F64; 3],
    /// Inertia about the centre of mass, column-major `[kg m^2]`.
    pub I_load: [F64; 9],
}

/// `SetFilters::Request`, protocol 5 only: cutoff frequencies.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct SetFilters {
    /// Cutoff for commanded joint positions `[Hz]`.
    pub joint_position_filter_frequency: F64,
    /// Cutoff for commanded joint velocities `[Hz]`.
    pub joint_velocity_filter_frequency: F64,
    /// Cutoff for commanded poses `[Hz]`.
    pub cartesian_position_filter_frequency: F64,
    /// Cutoff for commanded twists `[Hz]`.
    pub cartesian_velocity_filter_frequency: F64,
    /// Cutoff for the controller `[Hz]`.
    pub controller_filter_frequency: F64,
}

assert_layout!(SetCollisionBehavior, size: 416, {
    lower_torque_thresholds_acceleration: 0, upper_torque_thresholds_acceleration: 56,
    lower_torque_thresholds_nominal: 112, upper_torque_thresholds_nominal: 168,
    lower_force_thresholds_acceleration: 224, upper_force_thresholds_acceleration: 272,
    lower_force_thresholds_nominal: 320, upper_force_thresholds_nominal: 368,
});
assert_layout!(SetJointImpedance, size: 56, { K_theta: 0 });
assert_layout!(SetCartesianImpedance, size: 48, { K_x: 0 });
assert_layout!(SetGuidingMode, size: 7, { guiding_mode: 0, nullspace: 6 });
assert_layout!(SetFrame, size: 128, { transform: 0 });
assert_layout!(SetLoad, size: 104, { m_load: 0, F_x_Cload: 8, I_load: 32 });
assert_layout!(SetFilters, size: 40, {
    joint_position_filter_frequency: 0, joint_velocity_filter_frequency: 8,
    cartesian_position_filter_frequency: 16, cartesian_velocity_filter_frequency: 24,
    controller_filter_frequency: 32,
});

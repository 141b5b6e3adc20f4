//! The request that starts a motion. The replies to `Move` and `StopMove` are only a status.

use zerocopy::byteorder::little_endian::U32;
use zerocopy::{FromBytes, Immutable, IntoBytes, KnownLayout, Unaligned};

use crate::wire::F64;

/// `Move::Deviation`: largest allowed deviation of the robot from its commanded pose.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct Deviation {
    /// Deviation of the position `[m]`.
    pub translation: F64,
    /// Deviation of the orientation `[rad]`.
    pub rotation: F64,
    /// Deviation of the elbow `[rad]`.
    pub elbow: F64,
}

/// The fields of a `Move` that only protocol 10 has, for a motion in which the robot plans between
/// sparse joint targets.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct AsynchronousMotion {
    /// Non-zero for an asynchronous motion.
    pub use_async_motion_generator: u8,
    /// Largest joint velocities of the robot's plan `[rad/s]`; zero if the motion is not
    /// asynchronous.
    pub maximum_velocity: [F64; 7],
}

/// `Move::Request`. `A` is [`AsynchronousMotion`] in protocol 10 and `()` in protocol 5.
#[derive(Clone, Copy, Debug, FromBytes, IntoBytes, Immutable, KnownLayout, Unaligned)]
#[repr(C)]
pub struct MoveRequest<A> {
    /// Controller, with its number in requests.
    pub controller_mode: U32,
    /// Motion generator, with its number in requests.
    pub motion_generator_mode: U32,
    /// Allowed deviation during the motion.
    pub maximum_path_deviation: Deviation,
    /// Allowed deviation at the goal.
    pub maximum_goal_pose_deviation: Deviation,
    /// Fields of an asynchronous motion, or `()` if the version has no such motion.
    pub asynchronous: A,
}

assert_layout!(Deviation, size: 24, { translation: 0, rotation: 8, elbow: 16 });
assert_layout!(MoveRequest<AsynchronousMotion>, size: 113, {
    controller_mode: 0, motion_generator_mode: 4,
    maximum_path_deviation.translation: 8, maximum_path_deviation.rotation: 16,
    maximum_path_deviation.elbow: 24, maximum_goal_pose_deviation.translation: 32,
    maximum_goal_pose_deviation.rotation: 40, maximum_goal_pose_deviation.elbow: 48,
    asynchronous.use_async_motion_generator: 56, asynchronous.maximum_velocity: 57,
});
assert_layout!(MoveRequest<()>, size: 56, {
    controller_mode: 0, motion_generator_mode: 4,
    maximum_path_deviation.translation: 8, maximum_path_deviation.rotation: 16,
    maximum_path_deviation.elbow: 24, maximum_goal_pose_deviation.translation: 32,
    maximum_goal_pose_deviation.rotation: 40, maximum_goal_pose_deviation.elbow: 48,
});

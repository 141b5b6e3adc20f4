//! Limiters of the end effector's motion: twist and pose.

use franka_model::limits::MotionLimits;
use franka_model::rotation;
use nalgebra::Vector3;

use crate::shaping::check::{all_finite, is_homogeneous};
use crate::shaping::rotation::{Rigid, about, pose};
use crate::shaping::{CYCLE, InvalidCommand, lo};

/// Share of the rotational bounds that the limiter of poses uses (libfranka 0.21,
/// `kFactorCartesianRotationPoseInterface`).
pub const POSE_ROTATION_SHARE: f64 = 0.99;

/// Bounds on the norms of the end effector's linear and angular motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CartesianBounds {
    /// Bounds of the linear motion, `[m/s, m/s^2, m/s^3]`.
    pub translation: MotionLimits,
    /// Bounds of the angular motion, `[rad/s, rad/s^2, rad/s^3]`.
    pub rotation: MotionLimits,
}

/// Limits a twist in the base frame: linear velocity, `[m/s]`, then angular velocity, `[rad/s]`.
///
/// # Errors
/// Returns [`InvalidCommand::Twist`] if a component of `command` is not finite.
pub fn cartesian_velocity(
    bounds: &CartesianBounds,
    command: &[f64; 6],
    last_velocity: &[f64; 6],
    last_acceleration: &[f64; 6],
) -> Result<[f64; 6], InvalidCommand> {
    if !all_finite(command) {
        return Err(InvalidCommand::Twist);
    }
    let (v, w) = halves(command);
    let (last_v, last_w) = halves(last_velocity);
    let (last_dv, last_dw) = halves(last_acceleration);
    let v = limit_vector(&bounds.translation, v, last_v, last_dv);
    let w = limit_vector(&bounds.rotation, w, last_w, last_dw);
    Ok([v.x, v.y, v.z, w.x, w.y, w.z])
}

/// Limits a column-major pose in the base frame. The bounds apply to the twist from `last_pose` to
/// it.
///
/// The rotation block of each pose is replaced by the nearest rotation. The rotational bounds are
/// multiplied by [`POSE_ROTATION_SHARE`]. `last_pose` is not checked.
///
/// # Errors
/// Returns [`InvalidCommand::Pose`] if an element of `command` is not finite, otherwise
/// [`InvalidCommand::LimiterTransformation`] if `command` is not a homogeneous transformation.
pub fn cartesian_pose(
    bounds: &CartesianBounds,
    command: &[f64; 16],
    last_pose: &[f64; 16],
    last_velocity: &[f64; 6],
    last_acceleration: &[f64; 6],
) -> Result<[f64; 16], InvalidCommand> {
    limit_rigid(
        bounds,
        command,
        &Rigid::nearest(command),
        &Rigid::nearest(last_pose),
        last_velocity,
        last_acceleration,
    )
}

/// Does the same as [`cartesian_pose`], for poses that [`Rigid::nearest`] returned.
pub(crate) fn limit_rigid(
    bounds: &CartesianBounds,
    command: &[f64; 16],
    rigid_command: &Rigid,
    last: &Rigid,
    last_velocity: &[f64; 6],
    last_acceleration: &[f64; 6],
) -> Result<[f64; 16], InvalidCommand> {
    if !all_finite(command) {
        return Err(InvalidCommand::Pose);
    }
    if !is_homogeneous(command) {
        return Err(InvalidCommand::LimiterTransformation);
    }
    let (last_v, last_w) = halves(last_velocity);
    let (last_dv, last_dw) = halves(last_acceleration);

    let v = (rigid_command.translation - last.translation) / CYCLE;
    let v = limit_vector(&bounds.translation, v, last_v, last_dv);

    let w = rotation::error(&rigid_command.orientation, &last.orientation) / CYCLE;
    let share = MotionLimits {
        velocity: POSE_ROTATION_SHARE * bounds.rotation.velocity,
        acceleration: POSE_ROTATION_SHARE * bounds.rotation.acceleration,
        jerk: POSE_ROTATION_SHARE * bounds.rotation.jerk,
    };
    let w = limit_vector(&share, w, last_w, last_dw);
    let speed = w.norm();
    let rotation = if speed > f64::EPSILON {
        about(&(w / speed), CYCLE * speed) * last.rotation
    } else {
        last.rotation
    };
    let translation = last.translation + v * CYCLE;
    Ok(pose(&rotation, &translation, [0.0, 0.0, 0.0, 1.0]))
}

/// Returns the linear and the angular part of a twist.
fn halves(twist: &[f64; 6]) -> (Vector3<f64>, Vector3<f64>) {
    let [x, y, z, rx, ry, rz] = *twist;
    (Vector3::new(x, y, z), Vector3::new(rx, ry, rz))
}

/// Limits a velocity of three components, and the norms of its derivatives.
///
/// The acceleration keeps its direction. Its limit decreases with the distance to the velocity
/// bound along that direction, at the rate that the jerk allows. If the last velocity is so far
/// outside the bound that no acceleration in this direction leads back, the distance is NaN and
/// does not limit the acceleration.
///
/// The computation scales the vectors, whereas libfranka multiplies unit vectors by lengths.
/// Scaling takes half the time, and the results differ by rounding.
#[inline(always)]
fn limit_vector(
    most: &MotionLimits,
    command: Vector3<f64>,
    last_velocity: Vector3<f64>,
    last_acceleration: Vector3<f64>,
) -> Vector3<f64> {
    let change = (command - last_velocity) / CYCLE - last_acceleration;
    let size = change.norm();
    // These comparisons exclude NaN as well as zero.
    let acceleration = if size > f64::EPSILON * CYCLE {
        last_acceleration + change * lo(1.0, most.jerk * CYCLE / size)
    } else {
        last_acceleration
    };
    let size = acceleration.norm();
    if size > f64::EPSILON {
        let along = acceleration.dot(&last_velocity) / size;
        let square = along * along - last_velocity.norm_squared() + most.velocity * most.velocity;
        let distance = square.sqrt() - along;
        let share = most.jerk / most.acceleration;
        let safe = lo(share * distance, most.acceleration);
        last_velocity + acceleration * (lo(1.0, safe / size) * CYCLE)
    } else {
        last_velocity
    }
}

//! Limiters of scalars: torques, joints, the elbow.

use franka_model::limits::MotionLimits;

use crate::shaping::check::all_finite;
use crate::shaping::{CYCLE, InvalidCommand, hi, lo};

/// Bounds on the motion of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisBounds {
    /// Greatest velocity, `[rad/s]` or `[m/s]`; negative if the axis must turn back.
    pub upper_velocity: f64,
    /// Least velocity, in the same unit; positive if the axis must turn back.
    pub lower_velocity: f64,
    /// Bound of the acceleration in both directions, `[rad/s^2]` or `[m/s^2]`.
    pub acceleration: f64,
    /// Bound of the jerk in both directions, `[rad/s^3]` or `[m/s^3]`.
    pub jerk: f64,
}

impl AxisBounds {
    /// Returns bounds that are the same in both directions.
    pub const fn symmetric(limits: &MotionLimits) -> Self {
        Self {
            upper_velocity: limits.velocity,
            lower_velocity: -limits.velocity,
            acceleration: limits.acceleration,
            jerk: limits.jerk,
        }
    }
}

/// Bounds on the motion of the seven joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointBounds {
    /// Greatest velocities, `[rad/s]`.
    pub upper_velocity: [f64; 7],
    /// Least velocities, `[rad/s]`.
    pub lower_velocity: [f64; 7],
    /// Bounds of the accelerations in both directions, `[rad/s^2]`.
    pub acceleration: [f64; 7],
    /// Bounds of the jerks in both directions, `[rad/s^3]`.
    pub jerk: [f64; 7],
}

impl JointBounds {
    /// Returns the bounds of joint `i`, counted from 0.
    fn joint(&self, i: usize) -> AxisBounds {
        AxisBounds {
            upper_velocity: self.upper_velocity[i],
            lower_velocity: self.lower_velocity[i],
            acceleration: self.acceleration[i],
            jerk: self.jerk[i],
        }
    }
}

/// Limits the rate of torques, `[N m]`, to `max_rate`, `[N m/s]`. The function also limits any
/// other seven numbers to their greatest derivative.
///
/// # Errors
/// Returns [`InvalidCommand::NotFinite`] if a torque of `command` is not finite.
pub fn torques(
    command: &[f64; 7],
    last: &[f64; 7],
    max_rate: &[f64; 7],
) -> Result<[f64; 7], InvalidCommand> {
    if !all_finite(command) {
        return Err(InvalidCommand::NotFinite);
    }
    Ok(core::array::from_fn(|i| {
        limit_rate(command[i], last[i], max_rate[i]).0
    }))
}

/// Returns `command`, limited to the values that `max_rate` allows one cycle after `last`, and true
/// if the limit changed it.
pub(crate) fn limit_rate(command: f64, last: f64, max_rate: f64) -> (f64, bool) {
    let rate = (command - last) / CYCLE;
    let limited = hi(lo(rate, max_rate), -max_rate);
    (last + limited * CYCLE, limited != rate)
}

/// Returns a torque rate, `[N m/s]`, that stays below `max_rate` even if only the `f32` echo of the
/// last torque is known.
///
/// A robot of protocol 10 sends its last torque as an `f32`, but judges the rate against the `f64`
/// that it received. The rate must therefore be lower by half a step of the `f32` per cycle. At 80
/// N m this is 5e-3 N m/s, which exceeds libfranka's margin. The limiter of libfranka does not
/// consider the rounding.
pub fn within_echo(max_rate: f64, last: f64) -> f64 {
    let echo_error = f64::from(f32::EPSILON) * last.abs() / 2.0;
    hi(max_rate - echo_error / CYCLE, 0.0)
}

/// Limits a velocity.
///
/// # Errors
/// Returns [`InvalidCommand::Velocity`] if `command` is not finite.
pub fn velocity(
    bounds: &AxisBounds,
    command: f64,
    last_velocity: f64,
    last_acceleration: f64,
) -> Result<f64, InvalidCommand> {
    if !command.is_finite() {
        return Err(InvalidCommand::Velocity);
    }
    Ok(limit_velocity(
        bounds,
        command,
        last_velocity,
        last_acceleration,
    ))
}

/// Limits a position. The bounds apply to the velocity from `last_position` to it.
///
/// # Errors
/// Returns [`InvalidCommand::Position`] if `command` is not finite.
pub fn position(
    bounds: &AxisBounds,
    command: f64,
    last_position: f64,
    last_velocity: f64,
    last_acceleration: f64,
) -> Result<f64, InvalidCommand> {
    if !command.is_finite() {
        return Err(InvalidCommand::Position);
    }
    Ok(limit_position(
        bounds,
        command,
        last_position,
        last_velocity,
        last_acceleration,
    ))
}

/// Limits each joint velocity independently, `[rad/s]`.
///
/// # Errors
/// Returns [`InvalidCommand::JointVelocities`] if a velocity of `command` is not finite.
pub fn joint_velocities(
    bounds: &JointBounds,
    command: &[f64; 7],
    last_velocity: &[f64; 7],
    last_acceleration: &[f64; 7],
) -> Result<[f64; 7], InvalidCommand> {
    if !all_finite(command) {
        return Err(InvalidCommand::JointVelocities);
    }
    Ok(core::array::from_fn(|i| {
        limit_velocity(
            &bounds.joint(i),
            command[i],
            last_velocity[i],
            last_acceleration[i],
        )
    }))
}

/// Limits each joint position independently, `[rad]`.
///
/// # Errors
/// Returns [`InvalidCommand::JointPositions`] if a position of `command` is not finite.
pub fn joint_positions(
    bounds: &JointBounds,
    command: &[f64; 7],
    last_position: &[f64; 7],
    last_velocity: &[f64; 7],
    last_acceleration: &[f64; 7],
) -> Result<[f64; 7], InvalidCommand> {
    if !all_finite(command) {
        return Err(InvalidCommand::JointPositions);
    }
    Ok(core::array::from_fn(|i| {
        limit_position(
            &bounds.joint(i),
            command[i],
            last_position[i],
            last_velocity[i],
            last_acceleration[i],
        )
    }))
}

/// Limits a velocity. The jerk bounds the acceleration first. Then the acceleration is reduced so
/// that the velocity stays below its upper bound, and finally so that it stays above its lower
/// bound. Near a bound the acceleration decreases in proportion to the distance, at the rate that
/// the jerk allows.
fn limit_velocity(
    bounds: &AxisBounds,
    command: f64,
    last_velocity: f64,
    last_acceleration: f64,
) -> f64 {
    let AxisBounds {
        upper_velocity,
        lower_velocity,
        acceleration: most,
        jerk: most_jerk,
    } = *bounds;
    let jerk = ((command - last_velocity) / CYCLE - last_acceleration) / CYCLE;
    let acceleration = last_acceleration + hi(lo(jerk, most_jerk), -most_jerk) * CYCLE;
    let upper = lo((most_jerk / most) * (upper_velocity - last_velocity), most);
    let lower = hi((most_jerk / most) * (lower_velocity - last_velocity), -most);
    last_velocity + hi(lo(acceleration, upper), lower) * CYCLE
}

fn limit_position(
    bounds: &AxisBounds,
    command: f64,
    last_position: f64,
    last_velocity: f64,
    last_acceleration: f64,
) -> f64 {
    let velocity = (command - last_position) / CYCLE;
    last_position + limit_velocity(bounds, velocity, last_velocity, last_acceleration) * CYCLE
}

//! The backstop: a limiter between the reference and the robot's own controller.

use franka_proto::Version;

use crate::shaping::Bounds;

/// Share of the robot's acceleration and jerk limits that the backstop permits. The limiter
/// compares with the robot's echo of the setpoint, which a Franka Research 3 rounds to `f32`. This
/// rounding changes the acceleration computed from two positions by up to 0.25 rad/s^2.
pub(crate) const BACKSTOP: f64 = 0.95;

pub(crate) fn bounds(version: Version) -> Bounds {
    let bounds = match version {
        Version::V5 => Bounds::fer(),
        Version::V10 => Bounds::fr3(),
    };
    Bounds {
        joint_acceleration: bounds.joint_acceleration.map(|most| most * BACKSTOP),
        joint_jerk: bounds.joint_jerk.map(|most| most * BACKSTOP),
        ..bounds
    }
}

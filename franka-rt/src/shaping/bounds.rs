//! The bounds of the limiters of libfranka, for both robots.

use franka_model::limits::{CLIENT_MARGIN, CartesianLimits, JointLimits, MotionLimits};
use franka_model::{JointVector, RobotKind};

use crate::shaping::CYCLE;
use crate::shaping::limiter::{AxisBounds, CartesianBounds, JointBounds};

/// Bounds that the limiters apply to a robot's commands.
///
/// Every bound is the nominal limit, which the robot checks, minus [`CLIENT_MARGIN`]. On the FER
/// the bounds of the velocities are lower still, by the change that the greatest acceleration
/// causes during three lost commands. Source: libfranka 0.21 and 0.9, `rate_limiting.h`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Bound of the torque rate of each joint, `[N m/s]`.
    pub torque_rate: [f64; 7],
    /// Bounds of the velocity of each joint.
    pub joint_velocity: VelocityBounds,
    /// Bound of the acceleration of each joint, `[rad/s^2]`.
    pub joint_acceleration: [f64; 7],
    /// Bound of the jerk of each joint, `[rad/s^3]`.
    pub joint_jerk: [f64; 7],
    /// Bounds on the norms of the end effector's linear and angular motion.
    pub cartesian: CartesianBounds,
    /// Bounds on the motion of the elbow, which is the angle of joint 3.
    pub elbow: AxisBounds,
}

/// Bounds of the velocity of each joint, `[rad/s]`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "one per control loop, which copies it once; a box would not be Copy"
)]
pub enum VelocityBounds {
    /// The bounds are the same at every position, in both directions.
    Everywhere([f64; 7]),
    /// The bounds are lower near the ends of the joints' ranges.
    Envelope {
        /// Limits of the joints, with their velocity envelope.
        joints: JointLimits,
        /// Reduction of the envelope on both sides, `[rad/s]`.
        margin: f64,
    },
}

impl VelocityBounds {
    /// Returns the least and the greatest velocities `(lower, upper)`, `[rad/s]`, at the positions
    /// `q`, `[rad]`.
    pub fn at(&self, q: &[f64; 7]) -> ([f64; 7], [f64; 7]) {
        match self {
            Self::Everywhere(upper) => (upper.map(|upper| -upper), *upper),
            Self::Envelope { joints, margin } => {
                let (lower, upper) = joints.velocity_envelope(&JointVector::from(*q), *margin);
                (lower.into(), upper.into())
            }
        }
    }
}

impl Bounds {
    /// Returns the bounds of the FR3. The bounds of the joint velocities depend on the joint
    /// positions. They leave no room for lost commands.
    pub fn fr3() -> Self {
        Self::new(RobotKind::Fr3, 0.0)
    }

    /// Returns the bounds of the FER. The bounds of the velocities leave room for three lost
    /// commands.
    pub fn fer() -> Self {
        Self::new(RobotKind::Fer, 3.0)
    }

    fn new(robot: RobotKind, lost_commands: f64) -> Self {
        let joints = JointLimits::of(robot);
        let cartesian = CartesianLimits::of(robot);
        let inside = |nominal: f64| nominal - CLIENT_MARGIN;
        let velocity = |nominal: f64, acceleration: f64| {
            inside(nominal) - lost_commands * CYCLE * acceleration
        };
        let motion = |nominal: &MotionLimits| {
            let acceleration = inside(nominal.acceleration);
            MotionLimits {
                velocity: velocity(nominal.velocity, acceleration),
                acceleration,
                jerk: inside(nominal.jerk),
            }
        };
        let joint_acceleration: [f64; 7] = joints.acceleration.map(inside).into();
        let joint_velocity = match joints.envelope {
            Some(_) => VelocityBounds::Envelope {
                joints: *joints,
                margin: CLIENT_MARGIN,
            },
            None => VelocityBounds::Everywhere(core::array::from_fn(|i| {
                velocity(joints.velocity[i], joint_acceleration[i])
            })),
        };
        Self {
            torque_rate: joints.torque_rate.map(inside).into(),
            joint_velocity,
            joint_acceleration,
            joint_jerk: joints.jerk.map(inside).into(),
            cartesian: CartesianBounds {
                translation: motion(&cartesian.translation),
                rotation: motion(&cartesian.rotation),
            },
            elbow: AxisBounds::symmetric(&motion(&cartesian.elbow)),
        }
    }

    /// Returns the same bounds with the velocity envelope of `joints`, for example from a robot's
    /// description. A client of the FR3 uses nothing else from the description.
    #[must_use]
    pub fn with_envelope_of(mut self, joints: &JointLimits) -> Self {
        self.joint_velocity = VelocityBounds::Envelope {
            joints: *joints,
            margin: CLIENT_MARGIN,
        };
        self
    }

    /// Returns the bounds of the joints at the positions `q`, `[rad]`.
    pub fn joints_at(&self, q: &[f64; 7]) -> JointBounds {
        let (lower_velocity, upper_velocity) = self.joint_velocity.at(q);
        JointBounds {
            upper_velocity,
            lower_velocity,
            acceleration: self.joint_acceleration,
            jerk: self.joint_jerk,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_of_the_fer_are_the_doubles_of_the_vendor() {
        let bounds = Bounds::fer();
        let (lower, upper) = bounds.joint_velocity.at(&[0.0; 7]);
        assert_eq!(
            upper,
            [
                2.129003, 2.151503, 2.144003, 2.136503, 2.564003, 2.549003, 2.549003
            ]
        );
        assert_eq!(lower, upper.map(|x| -x));
        assert_eq!(bounds.cartesian.translation.velocity, 1.9600030000000002);
        assert_eq!(bounds.elbow.lower_velocity, -2.144003);
    }

    #[test]
    fn bounds_of_the_fr3_are_the_doubles_of_the_vendor() {
        let bounds = Bounds::fr3();
        assert_eq!(bounds.joint_acceleration, [9.999; 7]);
        assert_eq!(bounds.cartesian.rotation.velocity, 2.499);
        assert_eq!(bounds.elbow.upper_velocity, 1.499);
        let at_the_end = JointLimits::of(RobotKind::Fr3).hard_upper.into();
        assert_eq!(bounds.joints_at(&at_the_end).upper_velocity, [-0.001; 7]);
    }
}

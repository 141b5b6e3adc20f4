//! Limits of joints, end effector and elbow. The files of the two robots contain the numbers and
//! their sources.
//!
//! The robot checks commands against these values. A client stays [`CLIENT_MARGIN`] below them
//! (libfranka 0.21, `rate_limiting.h`, `kLimitEps`).

use crate::JointVector;
use crate::scalar::sqrt;

/// Margin that libfranka keeps from every limit. The number is the same in every unit (libfranka
/// 0.21, `rate_limiting.h`).
pub const CLIENT_MARGIN: f64 = 1e-3;

/// Limits of the seven joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimits {
    /// Smallest commanded position, `[rad]`, slightly inside [`hard_lower`](Self::hard_lower).
    pub lower: JointVector,
    /// Largest commanded position, `[rad]`, slightly inside [`hard_upper`](Self::hard_upper).
    pub upper: JointVector,
    /// Lower end of the velocity envelope, `[rad]`.
    pub hard_lower: JointVector,
    /// Upper end of the velocity envelope, `[rad]`.
    pub hard_upper: JointVector,
    /// Largest speed at any position, `[rad/s]`. Near the position limits,
    /// [`velocity_envelope`](Self::velocity_envelope) returns the speed limit.
    pub velocity: JointVector,
    /// Speed limit near the position limits; `None` if the speed limit is the same at all
    /// positions.
    pub envelope: Option<BrakingEnvelope>,
    /// Largest acceleration of a commanded motion, `[rad/s²]`.
    pub acceleration: JointVector,
    /// Largest jerk of a commanded motion, `[rad/s³]`.
    pub jerk: JointVector,
    /// Largest torque, `[N·m]`.
    pub torque: JointVector,
    /// Largest rate of a commanded torque, `[N·m/s]`.
    pub torque_rate: JointVector,
}

/// Speed limit near a position limit: the largest speed from which a joint can still stop before
/// the position limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrakingEnvelope {
    /// Deceleration of the parabola `speed²/2 = deceleration · distance`, `[rad/s²]`.
    pub deceleration: JointVector,
    /// Speed that is subtracted from the parabola, `[rad/s]`.
    pub offset: JointVector,
}

impl BrakingEnvelope {
    /// Returns the speed of joint `i`, `[rad/s]`, at `distance` `[rad]` from its position limit.
    pub fn speed(&self, i: usize, distance: f64) -> f64 {
        let parabola = sqrt((2.0 * self.deceleration[i] * distance).max(0.0));
        (parabola - self.offset[i]).max(0.0)
    }
}

impl JointLimits {
    /// Returns the velocities allowed at the positions `q`: `(lower, upper)`, `[rad/s]`.
    ///
    /// With a [`BrakingEnvelope`], the speed towards a position limit is bounded so that the joint
    /// stops before the hard limit. Without an envelope, the bound is [`velocity`](Self::velocity)
    /// everywhere, even beyond the limits. `margin` `[rad/s]` reduces both speed limits: the robot
    /// uses 0, and libfranka uses [`CLIENT_MARGIN`]. At and beyond a position limit with an
    /// envelope, the bound towards the limit is `-margin`, which allows only motion away from the
    /// limit.
    ///
    /// The formula and the order of operations are libfranka 0.21's, so the results are identical
    /// to the last digit.
    pub fn velocity_envelope(&self, q: &JointVector, margin: f64) -> (JointVector, JointVector) {
        let speed = |i: usize, distance: f64| {
            let nominal = self.velocity[i];
            let braking = self.envelope.as_ref();
            braking.map_or(nominal, |envelope| envelope.speed(i, distance).min(nominal)) - margin
        };
        (
            JointVector::from_fn(|i, _| -speed(i, q[i] - self.hard_lower[i])),
            JointVector::from_fn(|i, _| speed(i, self.hard_upper[i] - q[i])),
        )
    }

    /// Returns true if every position is within `lower` and `upper`. Returns false if a position is
    /// NaN.
    pub fn contains(&self, q: &JointVector) -> bool {
        (0..7).all(|i| self.lower[i] <= q[i] && q[i] <= self.upper[i])
    }

    /// Returns the index (0 to 6) of the first joint whose position is NaN or outside the range
    /// from `hard_lower` to `hard_upper`.
    pub fn outside_hard(&self, q: &JointVector) -> Option<usize> {
        (0..7).find(|&i| !(self.hard_lower[i]..=self.hard_upper[i]).contains(&q[i]))
    }
}

/// Bounds on a motion along one coordinate, or on the norm of a vector of coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionLimits {
    /// Velocity, `[m/s]` or `[rad/s]`.
    pub velocity: f64,
    /// Acceleration, `[m/s²]` or `[rad/s²]`.
    pub acceleration: f64,
    /// Jerk, `[m/s³]` or `[rad/s³]`.
    pub jerk: f64,
}

/// Limits of Cartesian motion commands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CartesianLimits {
    /// Limits of the end effector's position: bounds on the norm.
    pub translation: MotionLimits,
    /// Limits of the end effector's orientation: bounds on the norm.
    pub rotation: MotionLimits,
    /// Limits of the elbow angle (joint 3).
    pub elbow: MotionLimits,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{READY, RobotKind};

    #[test]
    fn the_envelope_is_the_nominal_speed_far_from_the_limits() {
        let limits = JointLimits::of(RobotKind::Fr3);
        let (lower, upper) = limits.velocity_envelope(&READY, 0.0);
        for i in [0, 2, 4, 6] {
            assert_eq!(
                (lower[i], upper[i]),
                (-limits.velocity[i], limits.velocity[i])
            );
        }
    }

    #[test]
    fn at_a_limit_the_envelope_asks_for_the_margin_inwards() {
        let limits = JointLimits::of(RobotKind::Fr3);
        for beyond in [0.0, 0.1] {
            let q = limits.hard_upper.add_scalar(beyond);
            let (_, upper) = limits.velocity_envelope(&q, CLIENT_MARGIN);
            assert_eq!(upper, JointVector::from_element(-CLIENT_MARGIN));
            let q = limits.hard_lower.add_scalar(-beyond);
            let (lower, _) = limits.velocity_envelope(&q, CLIENT_MARGIN);
            assert_eq!(lower, JointVector::from_element(CLIENT_MARGIN));
        }
    }

    #[test]
    fn one_value_of_the_vendors_library_is_met_exactly() {
        // Expected values from libfranka 0.21.3 with its FR3 description; joint 3 is near its upper
        // limit.
        let mut q = READY;
        q[2] = 2.8408030722477107;
        let limits = JointLimits::of(RobotKind::Fr3);
        let (_, upper) = limits.velocity_envelope(&q, CLIENT_MARGIN);
        assert_eq!(upper[2], 0.47714341718107406);
    }

    #[test]
    fn without_an_envelope_the_speed_is_the_same_everywhere() {
        let limits = JointLimits::of(RobotKind::Fer);
        for q in [READY, limits.upper, limits.lower, limits.upper * 2.0] {
            let (lower, upper) = limits.velocity_envelope(&q, CLIENT_MARGIN);
            assert_eq!(upper, limits.velocity.add_scalar(-CLIENT_MARGIN));
            assert_eq!(lower, -upper);
        }
    }

    #[test]
    fn the_fer_takes_the_ready_pose_and_what_the_fr3_does_not() {
        let (fer, fr3) = (
            JointLimits::of(RobotKind::Fer),
            JointLimits::of(RobotKind::Fr3),
        );
        assert!(fer.contains(&READY));
        let mut q = READY;
        q[5] = 0.1;
        assert!(fer.contains(&q) && !fr3.contains(&q));
    }

    #[test]
    fn margins_of_system_5_9_are_those_of_the_systems_before() {
        let (before, now) = (
            JointLimits::of(RobotKind::Fr3),
            JointLimits::fr3_system_5_9(),
        );
        let margins = |limits: &JointLimits| {
            let lower = limits.lower - limits.hard_lower;
            (lower, limits.hard_upper - limits.upper)
        };
        let (before, now) = (margins(before), margins(now));
        assert!((before.0 - now.0).amax() < 1e-12 && (before.1 - now.1).amax() < 1e-12);
    }

    #[test]
    fn positions_to_command_are_inside_the_hard_limits() {
        let limits = JointLimits::of(RobotKind::Fr3);
        assert!((limits.upper - limits.hard_upper).max() < 0.0);
        assert!((limits.lower - limits.hard_lower).min() > 0.0);
        assert!(limits.contains(&READY));
        assert!(!limits.contains(&limits.hard_upper));
        assert!(!limits.contains(&JointVector::from_element(f64::NAN)));
    }
}

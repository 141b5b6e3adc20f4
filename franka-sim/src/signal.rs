//! Commanded quantities with their first two derivatives, advanced once per millisecond.
//!
//! Derivatives are backward differences of the commanded values, started from the previously
//! published state (FCI documentation, control parameters). In a cycle whose command is lost, the
//! signal continues with the last acceleration.

use franka_model::{CYCLE, JointVector, Twist, rotation, transform};
use nalgebra::{Isometry3, Vector3};

use crate::config::Extrapolation;
use crate::kind::Precision;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct JointSignal {
    /// Joint positions, `[rad]`.
    pub(crate) q: JointVector,
    /// Joint velocities, `[rad/s]`.
    pub(crate) dq: JointVector,
    /// Joint accelerations, `[rad/s²]`.
    pub(crate) ddq: JointVector,
}

impl JointSignal {
    pub(crate) fn resting(q: JointVector) -> Self {
        Self {
            q,
            dq: JointVector::zeros(),
            ddq: JointVector::zeros(),
        }
    }

    /// Returns the signal one cycle later at the position `q`, and the jerk that this requires,
    /// `[rad/s³]`.
    pub(crate) fn to_position(self, q: &JointVector) -> (Self, JointVector) {
        let (mut next, jerk) = self.to_velocity(&((q - self.q) / CYCLE));
        next.q = *q;
        (next, jerk)
    }

    /// Returns the signal one cycle later at the velocity `dq`, and the jerk that this requires,
    /// `[rad/s³]`.
    pub(crate) fn to_velocity(self, dq: &JointVector) -> (Self, JointVector) {
        let ddq = (dq - self.dq) / CYCLE;
        let next = Self {
            q: self.q + dq * CYCLE,
            dq: *dq,
            ddq,
        };
        (next, (ddq - self.ddq) / CYCLE)
    }

    /// Returns the signal one cycle later with the acceleration unchanged.
    pub(crate) fn extrapolated(self) -> Self {
        let dq = self.dq + self.ddq * CYCLE;
        Self {
            q: self.q + dq * CYCLE,
            dq,
            ddq: self.ddq,
        }
    }

    /// Returns the signal as a client reads it from a state of this precision.
    pub(crate) fn published(self, precision: Precision) -> Self {
        let read = |value| precision.round(value);
        Self {
            q: self.q.map(read),
            dq: self.dq.map(read),
            ddq: self.ddq.map(read),
        }
    }
}

/// A pose with twist and twist acceleration, both in base axes at the frame's origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CartesianSignal {
    /// Pose in the base frame, `[m]`.
    pub(crate) pose: Isometry3<f64>,
    /// Twist, `[m/s, rad/s]`.
    pub(crate) twist: Twist,
    /// Derivative of the twist, `[m/s², rad/s²]`.
    pub(crate) acceleration: Twist,
}

impl CartesianSignal {
    pub(crate) fn resting(pose: Isometry3<f64>) -> Self {
        Self {
            pose,
            twist: Twist::zeros(),
            acceleration: Twist::zeros(),
        }
    }

    /// Returns the signal one cycle later at `pose`, and the jerk that this requires, `[m/s³,
    /// rad/s³]`.
    pub(crate) fn to_pose(self, pose: &Isometry3<f64>) -> (Self, Twist) {
        let shift = (pose.translation.vector - self.pose.translation.vector) / CYCLE;
        let turn = rotation::error(&pose.rotation, &self.pose.rotation) / CYCLE;
        let (mut next, jerk) = self.to_twist(&stack(&shift, &turn));
        next.pose = *pose;
        (next, jerk)
    }

    /// Returns the signal one cycle later with `twist`, and the jerk that this requires, `[m/s³,
    /// rad/s³]`.
    pub(crate) fn to_twist(self, twist: &Twist) -> (Self, Twist) {
        let acceleration = (twist - self.twist) / CYCLE;
        let next = Self {
            pose: moved(&self.pose, twist),
            twist: *twist,
            acceleration,
        };
        (next, (acceleration - self.acceleration) / CYCLE)
    }

    /// Returns the signal one cycle later with the acceleration unchanged. The angular acceleration
    /// is constant in the axes that `orientation` selects.
    pub(crate) fn extrapolated(self, orientation: Extrapolation) -> Self {
        let (linear, angular) = halves(&self.twist);
        let (acceleration, turning) = halves(&self.acceleration);
        let (angular, turning) = match orientation {
            Extrapolation::BaseAxes => (angular + turning * CYCLE, turning),
            Extrapolation::BodyAxes => {
                // The axes turn about the velocity vector, so the velocity is the same in both
                // frames.
                let turning = rotation::exp(&(angular * CYCLE)) * turning;
                (angular + turning * CYCLE, turning)
            }
            Extrapolation::Held => (Vector3::zeros(), Vector3::zeros()),
        };
        let twist = stack(&(linear + acceleration * CYCLE), &angular);
        Self {
            pose: moved(&self.pose, &twist),
            twist,
            acceleration: stack(&acceleration, &turning),
        }
    }

    /// Returns the signal as a client reads it from a state of this precision.
    pub(crate) fn published(self, precision: Precision) -> Self {
        let read = |value| precision.round(value);
        let rounded = transform::array(&self.pose).map(read);
        Self {
            // Single precision changes a rotation matrix by 1e-7, far too little for this
            // conversion to fail.
            pose: transform::isometry_from_array(&rounded).unwrap_or(self.pose),
            twist: self.twist.map(read),
            acceleration: self.acceleration.map(read),
        }
    }
}

/// The elbow: the angle of joint 3.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ElbowSignal {
    /// Angle of joint 3, `[rad]`.
    pub(crate) angle: f64,
    /// Velocity, `[rad/s]`.
    pub(crate) velocity: f64,
    /// Acceleration, `[rad/s²]`.
    pub(crate) acceleration: f64,
    /// True if the client commands the elbow; otherwise the robot chooses it.
    pub(crate) commanded: bool,
}

impl ElbowSignal {
    /// Returns the signal at rest at `angle`, `[rad]`.
    pub(crate) fn resting(angle: f64) -> Self {
        Self {
            angle,
            ..Self::default()
        }
    }

    /// Returns the signal one cycle later at `angle`, and the jerk that this requires, `[rad/s³]`.
    pub(crate) fn to_angle(self, angle: f64) -> (Self, f64) {
        let velocity = (angle - self.angle) / CYCLE;
        let acceleration = (velocity - self.velocity) / CYCLE;
        let next = Self {
            angle,
            velocity,
            acceleration,
            commanded: true,
        };
        (next, (acceleration - self.acceleration) / CYCLE)
    }

    /// Returns the signal one cycle later with the acceleration unchanged.
    pub(crate) fn extrapolated(self) -> Self {
        let velocity = self.velocity + self.acceleration * CYCLE;
        Self {
            angle: self.angle + velocity * CYCLE,
            velocity,
            ..self
        }
    }

    /// Returns the signal as a client reads it from a state of this precision.
    pub(crate) fn published(self, precision: Precision) -> Self {
        let read = |value| precision.round(value);
        Self {
            angle: read(self.angle),
            velocity: read(self.velocity),
            acceleration: read(self.acceleration),
            ..self
        }
    }
}

/// Returns the `[linear; angular]` vector of the two halves.
pub(crate) fn stack(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Twist {
    Twist::new(
        linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
    )
}

/// Returns the two halves of a `[linear; angular]` vector.
pub(crate) fn halves(twist: &Twist) -> (Vector3<f64>, Vector3<f64>) {
    (
        Vector3::new(twist[0], twist[1], twist[2]),
        Vector3::new(twist[3], twist[4], twist[5]),
    )
}

fn moved(pose: &Isometry3<f64>, twist: &Twist) -> Isometry3<f64> {
    let (linear, angular) = halves(twist);
    let mut rotation = rotation::exp(&(angular * CYCLE)) * pose.rotation;
    // Without this call, the length of the quaternion would drift after thousands of products.
    rotation.renormalize_fast();
    Isometry3::from_parts((pose.translation.vector + linear * CYCLE).into(), rotation)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_cycle_continues_a_parabola() {
        let start = JointSignal {
            q: JointVector::repeat(0.1),
            dq: JointVector::repeat(0.5),
            ddq: JointVector::repeat(2.0),
        };
        let next = start.extrapolated();
        // A command that continues with the same acceleration differs by rounding only.
        let (again, jerk) = start.to_position(&next.q);
        assert!((again.ddq - next.ddq).amax() < 1e-8);
        assert!(jerk.amax() < 1e-5);
    }

    #[test]
    fn poses_and_twists_describe_the_same_motion() {
        let start = CartesianSignal::resting(Isometry3::new(
            Vector3::new(0.3, 0.1, 0.5),
            Vector3::new(3.0, 0.2, -0.1),
        ));
        let twist = Twist::new(0.1, -0.2, 0.3, 0.5, -0.4, 0.2);
        let (by_twist, _) = start.to_twist(&twist);
        let (by_pose, _) = start.to_pose(&by_twist.pose);
        assert!((by_pose.twist - twist).amax() < 1e-9);
        assert!((by_pose.acceleration - by_twist.acceleration).amax() < 1e-6);
    }

    #[test]
    fn an_orientation_goes_on_as_it_is_told_to() {
        let start = CartesianSignal {
            twist: Twist::new(0.1, 0.0, 0.0, 0.0, 0.0, 1.0),
            acceleration: Twist::new(1.0, 0.0, 0.0, 2.0, 0.0, 0.0),
            ..CartesianSignal::resting(Isometry3::identity())
        };
        let angular = |signal: CartesianSignal| halves(&signal.twist).1;
        let base = start.extrapolated(Extrapolation::BaseAxes);
        assert_eq!(angular(base), Vector3::new(2e-3, 0.0, 1.0));
        // The body has turned by a thousandth of a radian, and the acceleration with it.
        let body = start.extrapolated(Extrapolation::BodyAxes);
        assert!((angular(body) - Vector3::new(2e-3, 2e-6, 1.0)).amax() < 1e-8);
        let held = start.extrapolated(Extrapolation::Held);
        assert_eq!(held.pose.rotation, start.pose.rotation);
        for signal in [base, body, held] {
            assert!((signal.twist[0] - 0.101).abs() < 1e-12);
        }
    }

    #[test]
    fn published_signal_has_the_precision_of_the_state() {
        let signal = JointSignal::resting(JointVector::repeat(0.1)).published(Precision::Single);
        assert_eq!(signal.q[0], f64::from(0.1_f32));
        let signal = JointSignal::resting(JointVector::repeat(0.1));
        assert_eq!(signal.published(Precision::Double), signal);
        let pose = Isometry3::new(Vector3::new(0.3, 0.1, 0.5), Vector3::new(3.0, 0.2, -0.1));
        let published = CartesianSignal::resting(pose).published(Precision::Single);
        assert_eq!(published.pose.translation.vector.x, f64::from(0.3_f32));
        assert!(rotation::error(&published.pose.rotation, &pose.rotation).norm() < 1e-6);
    }
}

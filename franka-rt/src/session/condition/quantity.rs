//! Numbers that a condition can compare.

use franka_model::{JointVector, Twist};

use crate::session::condition::{Bound, Condition, Node, Observed, Offset};
use crate::session::running::Measured;

/// An axis of the base frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// Forward.
    X,
    /// To the left.
    Y,
    /// Upward.
    Z,
}

/// A measured or estimated number that a condition can compare.
///
/// Forces and torques are the robot's estimates. They are positive if the arm exerts them on its
/// surroundings. If the arm presses on a table, the force along z is negative. All axes are axes of
/// the base frame.
///
/// ```
/// use franka_rt::session::condition::{Axis, Quantity};
///
/// let low = Quantity::Position(Axis::Z).below(0.15);
/// let slow = Quantity::Speed.below(0.01);
/// let at_the_door = low & slow;
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Quantity {
    /// Force along an axis, `O_F_ext_hat_K`, `[N]`.
    Force(Axis),
    /// Norm of the force, `[N]`.
    ForceNorm,
    /// Torque about an axis through the origin of the stiffness frame, `[N m]`: the torque of
    /// `K_F_ext_hat_K`. The torque of `O_F_ext_hat_K` is different: it is about the origin of the
    /// base frame.
    Torque(Axis),
    /// Norm of the torque, `[N m]`.
    TorqueNorm,
    /// External torque of a joint, 1 to 7, `tau_ext_hat_filtered`, `[N m]`.
    JointTorque(u8),
    /// The largest magnitude of the external joint torques, `[N m]`.
    LargestJointTorque,
    /// Position of the end effector along an axis, from the measured joints, `[m]`.
    Position(Axis),
    /// Velocity of the end effector along an axis, from the measured joint velocities, `[m/s]`.
    Velocity(Axis),
    /// Norm of the end effector's linear velocity, `[m/s]`.
    Speed,
    /// Angular velocity of the end effector about an axis, `[rad/s]`.
    AngularVelocity(Axis),
    /// Norm of the end effector's angular velocity, `[rad/s]`.
    AngularSpeed,
    /// Measured position of a joint, 1 to 7, `[rad]`.
    JointPosition(u8),
    /// Measured velocity of a joint, 1 to 7, `[rad/s]`.
    JointVelocity(u8),
}

impl Quantity {
    /// True while the quantity is at or above `value`.
    pub fn above(self, value: f64) -> Condition {
        Node::compare(self, Bound::Above, value).into()
    }

    /// True while the quantity is at or below `value`.
    pub fn below(self, value: f64) -> Condition {
        Node::compare(self, Bound::Below, value).into()
    }

    /// True while the magnitude of the quantity is at or above `value`, which must be above zero.
    pub fn beyond(self, value: f64) -> Condition {
        Node::compare(self, Bound::Beyond, value).into()
    }

    /// True if the quantity is one of the robot's estimates. Only estimates accept a tare.
    pub(super) fn is_estimate(self) -> bool {
        matches!(
            self,
            Self::Force(_)
                | Self::ForceNorm
                | Self::Torque(_)
                | Self::TorqueNorm
                | Self::JointTorque(_)
                | Self::LargestJointTorque
        )
    }

    pub(super) fn joint(self) -> Option<u8> {
        match self {
            Self::JointTorque(joint) | Self::JointPosition(joint) | Self::JointVelocity(joint) => {
                Some(joint)
            }
            _ => None,
        }
    }

    /// Returns the value of the quantity in a sample. The value is not finite if the sample's
    /// number is not finite, or if the arm has no such joint.
    pub(super) fn of(self, sample: &Sample) -> f64 {
        let along = |first: usize, axis: Axis| sample.0[first + axis as usize];
        let joint = |first: usize, joint: u8| match joint {
            1..=7 => sample.0[first + usize::from(joint) - 1],
            _ => f64::NAN,
        };
        let norm = |first: usize| {
            let [x, y, z] = core::array::from_fn(|i| sample.0[first + i]);
            (x * x + y * y + z * z).sqrt()
        };
        match self {
            Self::Force(axis) => along(FORCE, axis),
            Self::ForceNorm => norm(FORCE),
            Self::Torque(axis) => along(TORQUE, axis),
            Self::TorqueNorm => norm(TORQUE),
            Self::JointTorque(number) => joint(JOINT_TORQUE, number),
            Self::LargestJointTorque => {
                let torques = sample.0[JOINT_TORQUE..POSITION].iter();
                torques.fold(0.0, |most, torque| match torque.abs() {
                    torque if torque > most || torque.is_nan() => torque,
                    _ => most,
                })
            }
            Self::Position(axis) => along(POSITION, axis),
            Self::Velocity(axis) => along(VELOCITY, axis),
            Self::Speed => norm(VELOCITY),
            Self::AngularVelocity(axis) => along(ANGULAR_VELOCITY, axis),
            Self::AngularSpeed => norm(ANGULAR_VELOCITY),
            Self::JointPosition(number) => joint(JOINT_POSITION, number),
            Self::JointVelocity(number) => joint(JOINT_VELOCITY, number),
        }
    }
}

/// Numbers of one state from which every quantity is computed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample([f64; LENGTH]);

/// Start index of each part of a sample.
const FORCE: usize = 0;
const TORQUE: usize = 3;
const JOINT_TORQUE: usize = 6;
const POSITION: usize = 13;
const VELOCITY: usize = 16;
const ANGULAR_VELOCITY: usize = 19;
const JOINT_POSITION: usize = 22;
const JOINT_VELOCITY: usize = 29;
const LENGTH: usize = 36;

impl Sample {
    pub(super) fn of(state: &Observed, arm: &Measured) -> Self {
        let twist: Twist = arm.jacobian * JointVector::from(state.dq);
        let mut sample = [0.0; LENGTH];
        let mut put = |first: usize, numbers: &[f64]| {
            sample[first..first + numbers.len()].copy_from_slice(numbers);
        };
        put(FORCE, &state.wrench);
        put(JOINT_TORQUE, &state.joint_torques);
        put(POSITION, arm.pose.translation.vector.as_slice());
        put(VELOCITY, twist.as_slice());
        put(JOINT_POSITION, arm.q.as_slice());
        put(JOINT_VELOCITY, &state.dq);
        Self(sample)
    }

    /// Returns the change relative to a tare. The wrench is not finite if the robot has no
    /// estimate.
    pub(super) fn tared(&self, tare: &Offset) -> Self {
        let mut sample = *self;
        for (number, offset) in sample.0.iter_mut().zip(tare) {
            *number -= offset;
        }
        if self.0[..JOINT_TORQUE].iter().all(|number| *number == 0.0) {
            sample.0[..JOINT_TORQUE].fill(f64::NAN);
        }
        sample
    }

    pub(super) fn since(&self, before: &Self) -> Self {
        Self(core::array::from_fn(|i| self.0[i] - before.0[i]))
    }

    /// Replaces numbers that are not finite with the numbers of `newer`.
    pub(super) fn complete_from(&mut self, newer: &Self) {
        for (number, newer) in self.0.iter_mut().zip(&newer.0) {
            if !number.is_finite() {
                *number = *newer;
            }
        }
    }
}

//! Distances between setpoints, and the thresholds above which they matter.

use franka_model::{JointVector, Twist};
use franka_proto::RobotState;
use nalgebra::Vector3;

use crate::control::{
    CartesianPose, CartesianVelocities, JointPositions, JointVelocities, MotionCommand,
};
use crate::shaping::CYCLE;

/// Greatest differences between the robot's setpoint and the sent setpoint with which the two count
/// as the same. They are above the rounding of the robot's echo, and below the change in any
/// relevant cycle of a motion.
mod echo {
    /// Difference of joint positions, `[rad]`.
    pub(super) const JOINTS: f64 = 2e-6;

    /// Difference of joint velocities, `[rad/s]`. If a difference is ignored, it returns as a jerk
    /// of 100 rad/s^3.
    pub(super) const JOINT_VELOCITIES: f64 = 1e-4;

    /// Difference of poses and elbows, `[m, rad]`. No backstop limits the joints that a pose moves.
    /// If a difference is ignored, it returns as a jerk of these joints, of at most a fifth of the
    /// gentlest joint's limit.
    pub(super) const POSE: f64 = 3e-7;

    /// Difference of twists, `[m/s, rad/s]`. The difference at the joints is about ten times as
    /// large.
    pub(super) const TWIST: f64 = 1e-5;
}

/// Distances between the position that the robot has integrated and the reference, above which the
/// reference moves to the robot's place. Velocities remove smaller distances.
pub(super) mod is_off {
    /// Distance of joint positions, `[rad]`.
    pub(crate) const JOINTS: f64 = 2e-5;

    /// Distance of poses, `[m, rad]`.
    pub(crate) const POSE: f64 = 3e-6;
}

/// Greatest change of a pose and an elbow by the limiter with which they count as unchanged,
/// `[m, rad]`. The change at the joints is about ten times as large, a jerk of 100 rad/s^3.
const SAME: f64 = 1e-8;

/// True if the robot's setpoint differs from `sent`. The position that the robot integrates from
/// velocities is not compared.
pub(super) fn differs(sent: &MotionCommand, state: &RobotState) -> bool {
    let far = |a: &[f64], b: &[f64]| {
        a.iter()
            .zip(b)
            .fold(0.0, |most, (a, b)| f64::max(most, (a - b).abs()))
    };
    match sent {
        MotionCommand::JointPositions(JointPositions(q)) => far(q, &state.q_d) > echo::JOINTS,
        MotionCommand::JointVelocities(JointVelocities(dq)) => {
            far(dq, &state.dq_d) > echo::JOINT_VELOCITIES
        }
        MotionCommand::CartesianPose(pose) => {
            let robots = CartesianPose {
                O_T_EE: *state.commanded_pose(),
                elbow: Some(state.commanded_elbow()),
            };
            apart(&(*pose).into(), &robots.into()).amax() > echo::POSE
        }
        MotionCommand::CartesianVelocities(CartesianVelocities { O_dP_EE, elbow }) => {
            let robots = state.commanded_elbow();
            let [angle, _] = elbow.unwrap_or(robots);
            far(O_dP_EE, &state.O_dP_EE_c) > echo::TWIST || (angle - robots[0]).abs() > echo::POSE
        }
    }
}

/// True if the limiter has not changed `asked`, except for rounding.
pub(super) fn unchanged(shaped: &MotionCommand, asked: &MotionCommand) -> bool {
    let most = match asked {
        MotionCommand::JointPositions(_) => echo::JOINTS,
        MotionCommand::JointVelocities(_) => echo::JOINT_VELOCITIES * CYCLE,
        MotionCommand::CartesianPose(_) | MotionCommand::CartesianVelocities(_) => SAME,
    };
    apart(shaped, asked).amax() <= most
}

/// Returns the distance between two setpoints of the same kind. For joints it contains their
/// distance, `[rad]`. For poses it contains the distances of translation, rotation elements and
/// elbow, `[m, rad]`.
pub(super) fn apart(a: &MotionCommand, b: &MotionCommand) -> Vector3<f64> {
    let squares = |a: &[f64], b: &[f64]| -> f64 {
        let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let elbows = |a: &Option<[f64; 2]>, b: &Option<[f64; 2]>| {
        let [a, b] = [a, b].map(|elbow| elbow.map_or(0.0, |[angle, _]| angle));
        (a - b).abs()
    };
    match (a, b) {
        (
            MotionCommand::JointPositions(JointPositions(a)),
            MotionCommand::JointPositions(JointPositions(b)),
        ) => Vector3::new(squares(a, b), 0.0, 0.0),
        (
            MotionCommand::JointVelocities(JointVelocities(a)),
            MotionCommand::JointVelocities(JointVelocities(b)),
        ) => Vector3::new(squares(a, b) * CYCLE, 0.0, 0.0),
        (MotionCommand::CartesianPose(a), MotionCommand::CartesianPose(b)) => Vector3::new(
            squares(&a.O_T_EE[12..15], &b.O_T_EE[12..15]),
            squares(&a.O_T_EE[..11], &b.O_T_EE[..11]),
            elbows(&a.elbow, &b.elbow),
        ),
        (MotionCommand::CartesianVelocities(a), MotionCommand::CartesianVelocities(b)) => {
            Vector3::new(
                squares(&a.O_dP_EE[..3], &b.O_dP_EE[..3]) * CYCLE,
                squares(&a.O_dP_EE[3..], &b.O_dP_EE[3..]) * CYCLE,
                elbows(&a.elbow, &b.elbow),
            )
        }
        _ => Vector3::repeat(f64::INFINITY),
    }
}

/// Returns the part of a joint drift that must be removed, `[rad]`. Zero if rounding explains the
/// drift.
pub(super) fn joint_drift(drift: &JointVector) -> JointVector {
    drift.map(|x| x - x.clamp(-echo::JOINTS, echo::JOINTS))
}

/// Returns the part of a pose drift that must be removed, in base axes, `[m, rad]`.
pub(super) fn pose_drift(drift: &Twist) -> Twist {
    drift.map(|x| x - x.clamp(-echo::POSE, echo::POSE))
}

//! How far setpoints are apart, and from when on that matters.

use franka_model::{JointVector, Twist};
use franka_proto::RobotState;
use nalgebra::Vector3;

use crate::control::{
    CartesianPose, CartesianVelocities, JointPositions, JointVelocities, MotionCommand,
};
use crate::shaping::CYCLE;

/// How far the robot's setpoint may be from the one that it was sent for the two to count as the
/// same: more than its echo is rounded by, and less than any cycle of a motion that matters.
mod echo {
    /// `[rad]`
    pub(super) const JOINTS: f64 = 2e-6;

    /// `[rad/s]`: what is overlooked here comes back as a jerk of 100 rad/s^3.
    pub(super) const JOINT_VELOCITIES: f64 = 1e-4;

    /// Of a pose and an elbow, `[m, rad]`. No backstop limits the joints behind a pose: what is
    /// overlooked here comes back in them as a jerk, at most a fifth of what the gentlest joint may
    /// have.
    pub(super) const POSE: f64 = 3e-7;

    /// Of a twist, `[m/s, rad/s]`: the joints behind it feel some ten times as much.
    pub(super) const TWIST: f64 = 1e-5;
}

/// How far what the robot integrates may be from the reference before that is put where the robot
/// is; less is made up for.
pub(super) mod is_off {
    /// `[rad]`
    pub(crate) const JOINTS: f64 = 2e-5;

    /// `[m, rad]`
    pub(crate) const POSE: f64 = 3e-6;
}

/// How little the limiter may change a pose and an elbow, `[m, rad]`, for them to count as
/// unchanged: the joints behind them feel some ten times as much, a jerk of 100 rad/s^3.
const SAME: f64 = 1e-8;

/// True if the robot has another setpoint than `sent`. Where velocities have led is not compared.
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

/// True if the limiter has left `asked` as it was, but for rounding.
pub(super) fn unchanged(shaped: &MotionCommand, asked: &MotionCommand) -> bool {
    let most = match asked {
        MotionCommand::JointPositions(_) => echo::JOINTS,
        MotionCommand::JointVelocities(_) => echo::JOINT_VELOCITIES * CYCLE,
        MotionCommand::CartesianPose(_) | MotionCommand::CartesianVelocities(_) => SAME,
    };
    apart(shaped, asked).amax() <= most
}

/// How far two setpoints of the same kind lead apart: in the joints, `[rad]`; or in translation,
/// in the elements of their rotation, in the elbow, `[m, rad]`.
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

/// What is to be made up for of a drift of the joints, `[rad]`: nothing of what rounding explains.
pub(super) fn joint_drift(drift: &JointVector) -> JointVector {
    drift.map(|x| x - x.clamp(-echo::JOINTS, echo::JOINTS))
}

/// The same of a drift of the pose, base axes, `[m, rad]`.
pub(super) fn pose_drift(drift: &Twist) -> Twist {
    drift.map(|x| x - x.clamp(-echo::POSE, echo::POSE))
}

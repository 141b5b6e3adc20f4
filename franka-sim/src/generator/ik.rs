//! Joint positions for a commanded pose, near the positions of the previous cycle.

use franka_model::differential_ik::{DifferentialIk, JointBox};
use franka_model::{Frame, JointVector, Twist};
use nalgebra::{Isometry3, Matrix3, Matrix4, Vector3};

use super::ArmModel;
use crate::signal::stack;

/// Returns joint positions near `from` that bring the end effector to `target`, with joint 3 at
/// `elbow` if an elbow is given.
///
/// This function uses Newton's method with differential inverse kinematics. A millisecond of motion
/// requires two or three iterations to reach [`CLOSE`]. Without an elbow, each iteration changes
/// the joints as little as possible. Near a singularity, or for a target out of reach, the returned
/// joints do not reach the target. The caller must check the result.
pub(super) fn solve(
    arm: &ArmModel<'_>,
    target: &Isometry3<f64>,
    elbow: Option<f64>,
    from: &JointVector,
) -> JointVector {
    let ik = DifferentialIk::smooth();
    let goal = target.to_homogeneous();
    let mut q = *from;
    let mut active = Default::default();
    for _ in 0..STEPS_MAX {
        let pose = arm.model.pose(Frame::EndEffector, &q, arm.frames);
        let error = difference(&goal, &pose);
        let elbow_error = elbow.map_or(0.0, |angle| angle - q[2]);
        if error.amax() < CLOSE && elbow_error.abs() < CLOSE {
            break;
        }
        let jacobian = arm.model.zero_jacobian(Frame::EndEffector, &q, arm.frames);
        let bounds = step_bounds(elbow.map(|_| elbow_error));
        let solution = ik.solve(&jacobian, &error, &JointVector::zeros(), &bounds, active);
        active = solution.active;
        q += solution.velocity;
    }
    q
}

/// Bounds of one iteration. If the elbow is commanded, joint 3 must reach the elbow angle.
fn step_bounds(elbow: Option<f64>) -> JointBox {
    let mut upper = JointVector::repeat(STEP_MAX);
    let mut lower = -upper;
    if let Some(error) = elbow {
        lower[2] = error.clamp(-STEP_MAX, STEP_MAX);
        upper[2] = lower[2];
    }
    JointBox::new(&lower, &upper)
}

/// Displacement and rotation vector from `pose` to `goal`, in base axes. The rotation blocks may be
/// inexact, like the vendor's rounded constants.
fn difference(goal: &Matrix4<f64>, pose: &Matrix4<f64>) -> Twist {
    let block = |m: &Matrix4<f64>| -> Matrix3<f64> { m.fixed_view::<3, 3>(0, 0).into_owned() };
    let turn = block(goal) * block(pose).transpose();
    let twice_sine = Vector3::new(
        turn.m32 - turn.m23,
        turn.m13 - turn.m31,
        turn.m21 - turn.m12,
    );
    let sine = twice_sine.norm() / 2.0;
    let cosine = (turn.trace() - 1.0) / 2.0;
    let scale = if sine > 1e-12 {
        sine.atan2(cosine) / sine
    } else {
        1.0
    };
    let shift = Vector3::new(
        goal.m14 - pose.m14,
        goal.m24 - pose.m24,
        goal.m34 - pose.m34,
    );
    stack(&shift, &(twice_sine * (scale / 2.0)))
}

/// Pose error at which the joints are accurate enough, `[m, rad]`. It is a thousandth of the
/// permitted third difference of the joints at 1 kHz.
const CLOSE: f64 = 1e-12;

/// Largest number of iterations. Only targets that no smooth motion can reach need more.
const STEPS_MAX: usize = 8;

/// Largest change of a joint in one iteration, `[rad]`: a hundred times the bound for a cycle.
const STEP_MAX: f64 = 0.5;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::kind::Description;
    use franka_model::{EndEffector, Model, READY, RobotKind, transform};

    fn arm<'a>(frames: &'a EndEffector, config: &'a Config) -> ArmModel<'a> {
        ArmModel::new(
            Description::of(RobotKind::Fr3),
            Model::fr3(),
            frames,
            config,
        )
    }

    #[test]
    fn reaches_the_pose_and_moves_no_more_than_needed() {
        let frames = EndEffector::default();
        let config = Config::default();
        let arm = arm(&frames, &config);
        let mut target = arm.pose(&READY);
        target.translation.vector.x += 1e-3;
        let q = solve(&arm, &target, None, &READY);
        let error = arm.pose(&q).translation.vector - target.translation.vector;
        assert!(error.norm() < 1e-12, "{error}");
        assert!((q - READY).amax() < 5e-3);
    }

    #[test]
    fn keeps_the_pose_while_the_elbow_moves() {
        let frames = EndEffector::default();
        let config = Config::default();
        let arm = arm(&frames, &config);
        let target = arm.pose(&READY);
        let q = solve(&arm, &target, Some(0.01), &READY);
        assert!((q[2] - 0.01).abs() < 1e-12);
        let off = transform::matrix(&arm.pose(&q)) - transform::matrix(&target);
        assert!(off.amax() < 1e-10, "{off}");
    }

    #[test]
    fn works_with_the_vendors_rounded_hand_frame() {
        let mut frames = EndEffector::default();
        #[allow(clippy::approx_constant)] // the vendor ships four digits
        let (r, m) = (0.7071, &mut frames.f_t_ee);
        (m.m11, m.m12, m.m21, m.m22, m.m34) = (r, r, -r, r, 0.1034);
        let config = Config::default();
        let arm = arm(&frames, &config);
        // The target is the current pose, so the joints must not creep.
        let q = solve(&arm, &arm.pose(&READY), None, &READY);
        assert!((q - READY).amax() < 1e-12);
    }

    #[test]
    fn a_target_out_of_reach_ends_in_bounded_steps() {
        let frames = EndEffector::default();
        let config = Config::default();
        let arm = arm(&frames, &config);
        let mut target = arm.pose(&READY);
        target.translation.vector.z += 10.0;
        let q = solve(&arm, &target, None, &READY);
        assert!(q.iter().all(|x| x.is_finite()));
    }
}

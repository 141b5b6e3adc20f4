//! Poses of the arm and of its reference.

use franka_model::collision::Shape;
use franka_model::{EndEffector, Frame, JointVector, Model, Twist, transform};
use franka_rt::session::Target;
use nalgebra::{Isometry3, Vector3};
use rand::Rng;

use super::Lockstep;

impl Lockstep {
    /// Pose of the end effector at the true joint positions, according to the robot's model. It has
    /// no noise and no rounding by the protocol.
    pub fn arm_pose(&self) -> Isometry3<f64> {
        self.pose_at(self.robot.q())
    }

    /// Pose of the end effector at the reference of the driver's last command.
    pub fn reference_pose(&self) -> Isometry3<f64> {
        self.pose_at(&self.client.record.q_ref.into())
    }

    /// Pose of the end effector at these joint positions, `[rad]`.
    pub fn pose_at(&self, q: &JointVector) -> Isometry3<f64> {
        let rigid =
            |column_major| transform::isometry_from_array(column_major).expect("a rigid frame");
        let ee = EndEffector {
            f_t_ee: transform::matrix(&rigid(&self.robot.state().F_T_EE)),
            ..EndEffector::default()
        };
        let pose = self.robot.model().pose(Frame::EndEffector, q, &ee);
        transform::isometry(&pose).expect("a rigid end effector")
    }
}

/// Pose of the end effector at `q`, with the lengths in the vendor's description of both robots.
pub fn pose_of(q: &JointVector, ee: &EndEffector) -> Isometry3<f64> {
    let pose = Model::fr3().pose(Frame::EndEffector, q, ee);
    transform::isometry(&pose).expect("a rigid end effector")
}

/// Force on the flange that corresponds to these joint torques, in base axes, `[N]`. It is the
/// force of the smallest wrench that explains the torques.
///
/// # Panics
/// Panics at a singularity.
pub fn force_of(q: &JointVector, torques: &JointVector) -> Vector3<f64> {
    let flange = EndEffector::default();
    let (_, jacobian) = Model::fr3().pose_and_jacobian(Frame::EndEffector, q, &flange);
    let square = jacobian * jacobian.transpose();
    let wrench = square.try_inverse().expect("no singularity") * jacobian * torques;
    wrench.fixed_rows::<3>(0).into_owned()
}

/// Smallest distance between links that are three or more apart in the chain, `[m]`. The Hand
/// counts as link 8. The robot's self-collision avoidance checks this distance.
pub fn self_distance(q: &JointVector) -> f64 {
    let arm = Shape::vendor().with_hand().at(q);
    let apart = arm
        .distances()
        .filter(|((inner, outer), _)| outer.number() - inner.number() >= 3);
    apart
        .map(|(_, distance)| distance)
        .fold(f64::INFINITY, f64::min)
}

/// Adds a random velocity, which sometimes exceeds every limit, to a pose or joint target. Returns
/// other targets unchanged.
pub fn set_in_motion(target: Target, random: &mut impl Rng) -> Target {
    let mut number = |most: f64| most * random.random_range(-1.0..1.0_f64).powi(3);
    match target {
        Target::Joints(q) => (q, core::array::from_fn(|_| number(2.0))).into(),
        Target::Pose(pose) => {
            let twist = Twist::from_fn(|i, _| number(if i < 3 { 0.6 } else { 1.0 }));
            (pose, twist).into()
        }
        other => other,
    }
}

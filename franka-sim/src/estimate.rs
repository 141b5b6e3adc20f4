//! The external forces that the robot estimates, with contact and collision.

use franka_model::{Frame, Jacobian, JointVector, Wrench};
use franka_proto::{CollisionBehavior, Errors, RobotError};
use nalgebra::{Cholesky, Matrix6};

use crate::config::ForceAxes;
use crate::generator::ArmModel;
use crate::signal::{halves, stack};

/// Estimated external torques, the corresponding wrench, and the thresholds that they exceed.
///
/// Positive values act from the robot on its environment, as in the state (libfranka 0.21,
/// `robot_state.h`). If a hand pushes the arm upwards, the force along z is negative.
#[derive(Debug, Clone)]
pub(crate) struct Estimate {
    /// Estimated external torques, `tau_ext_hat_filtered`, `[N·m]`.
    pub(crate) torque: JointVector,
    /// `O_F_ext_hat_K`, with the torque about the origin of the base, `[N, N·m]`.
    pub(crate) wrench_base: Wrench,
    /// The same wrench with its torque about the origin of the stiffness frame.
    wrench_at_stiffness: Wrench,
    /// Wrench in the axes of the stiffness frame, `K_F_ext_hat_K`, `[N, N·m]`.
    pub(crate) wrench_stiffness: Wrench,
    pub(crate) joint_contact: [bool; 7],
    pub(crate) cartesian_contact: [bool; 6],
    /// These flags stay set until [`Estimate::clear`].
    pub(crate) joint_collision: [bool; 7],
    pub(crate) cartesian_collision: [bool; 6],
}

impl Estimate {
    /// An estimate without any contact.
    pub(crate) fn new() -> Self {
        Self {
            torque: JointVector::zeros(),
            wrench_base: Wrench::zeros(),
            wrench_at_stiffness: Wrench::zeros(),
            wrench_stiffness: Wrench::zeros(),
            joint_contact: [false; 7],
            cartesian_contact: [false; 6],
            joint_collision: [false; 7],
            cartesian_collision: [false; 6],
        }
    }

    /// Updates the estimate from the external joint torques of the observer, `[N·m]`, at the joint
    /// positions `q`.
    pub(crate) fn update(&mut self, external: &JointVector, q: &JointVector, arm: &ArmModel<'_>) {
        self.torque = -external;
        let jacobian = arm.model.body_jacobian(Frame::Stiffness, q, arm.frames);
        let singular = arm.config.unpublished.wrench_singular;
        self.wrench_stiffness = wrench(&jacobian, &self.torque, singular);
        let pose = arm.model.pose(Frame::Stiffness, q, arm.frames);
        let rotation = pose.fixed_view::<3, 3>(0, 0);
        let (force, torque) = halves(&self.wrench_stiffness);
        let (force, torque) = (rotation * force, rotation * torque);
        let origin = pose.fixed_view::<3, 1>(0, 3).into_owned();
        self.wrench_at_stiffness = stack(&force, &torque);
        self.wrench_base = stack(&force, &(torque + origin.cross(&force)));
    }

    /// Compares the estimate with the thresholds. `axes` are the axes of the forces, and
    /// `accelerating` selects the set of thresholds. Returns the errors that stop the robot.
    ///
    /// A collision is latched only if `moving` is true, because an arm at rest need not stop.
    pub(crate) fn compare(
        &mut self,
        thresholds: &CollisionBehavior,
        axes: ForceAxes,
        accelerating: bool,
        moving: bool,
    ) -> Errors {
        let t = thresholds;
        let (torque, force) = if accelerating {
            (
                (
                    &t.lower_torque_thresholds_acceleration,
                    &t.upper_torque_thresholds_acceleration,
                ),
                (
                    &t.lower_force_thresholds_acceleration,
                    &t.upper_force_thresholds_acceleration,
                ),
            )
        } else {
            (
                (
                    &t.lower_torque_thresholds_nominal,
                    &t.upper_torque_thresholds_nominal,
                ),
                (
                    &t.lower_force_thresholds_nominal,
                    &t.upper_force_thresholds_nominal,
                ),
            )
        };
        let torque_now = self.torque.into();
        let force_now = match axes {
            ForceAxes::Base => self.wrench_at_stiffness.into(),
            ForceAxes::Stiffness => self.wrench_stiffness.into(),
        };
        self.joint_contact = reached(&torque_now, torque.0);
        self.cartesian_contact = reached(&force_now, force.0);
        let mut reflexes = Errors::NONE;
        if moving {
            let joint = reached(&torque_now, torque.1);
            let cartesian = reached(&force_now, force.1);
            latch(&mut self.joint_collision, &joint);
            latch(&mut self.cartesian_collision, &cartesian);
            if joint.contains(&true) {
                reflexes.insert(RobotError::JointReflex);
            }
            if cartesian.contains(&true) {
                reflexes.insert(RobotError::CartesianReflex);
            }
        }
        reflexes
    }

    pub(crate) fn clear(&mut self) {
        self.joint_collision = [false; 7];
        self.cartesian_collision = [false; 6];
    }
}

/// Returns a flag for each value that is at or beyond its threshold.
fn reached<const N: usize>(values: &[f64; N], thresholds: &[f64; N]) -> [bool; N] {
    core::array::from_fn(|i| values[i].abs() >= thresholds[i])
}

fn latch<const N: usize>(flags: &mut [bool; N], set: &[bool; N]) {
    for (flag, set) in flags.iter_mut().zip(set) {
        *flag |= set;
    }
}

/// Wrench that corresponds to `torque`, by least squares: `(J Jᵀ)⁻¹ J τ`. Zero if the smallest
/// singular value of `J` is at most `singular`.
fn wrench(jacobian: &Jacobian, torque: &JointVector, singular: f64) -> Wrench {
    let gram = jacobian * jacobian.transpose();
    // This matrix is positive definite if and only if all singular values are greater than
    // `singular`.
    let excess = gram - Matrix6::from_diagonal_element(singular * singular);
    match (Cholesky::new(excess), Cholesky::new(gram)) {
        (Some(_), Some(factor)) => factor.solve(&(jacobian * torque)),
        _ => Wrench::zeros(),
    }
}

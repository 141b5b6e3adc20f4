//! The external forces that the robot estimates, and contact and collision.

use franka_model::{Frame, Jacobian, JointVector, Wrench};
use franka_proto::{CollisionBehavior, Errors, RobotError};
use nalgebra::Cholesky;

use crate::config::ForceAxes;
use crate::generator::ArmModel;
use crate::signal::{halves, stack};

/// The external torques observed, the wrench that they mean, and what exceeded its thresholds.
///
/// Positive is what the robot does to its environment, as in the state (libfranka 0.21,
/// `robot_state.h`): an arm that a hand pushes upwards shows a negative force along z.
#[derive(Debug, Clone)]
pub(crate) struct Estimate {
    /// `tau_ext_hat_filtered`, `[N·m]`.
    pub(crate) torque: JointVector,
    /// `O_F_ext_hat_K`, `[N, N·m]`.
    pub(crate) wrench_base: Wrench,
    /// `K_F_ext_hat_K`, `[N, N·m]`.
    pub(crate) wrench_stiffness: Wrench,
    pub(crate) joint_contact: [bool; 7],
    pub(crate) cartesian_contact: [bool; 6],
    /// Stay until [`Estimate::clear`].
    pub(crate) joint_collision: [bool; 7],
    pub(crate) cartesian_collision: [bool; 6],
}

impl Estimate {
    /// An estimate of no contact.
    pub(crate) fn new() -> Self {
        Self {
            torque: JointVector::zeros(),
            wrench_base: Wrench::zeros(),
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
        self.wrench_stiffness = wrench(&jacobian, &self.torque);
        let pose = arm.model.pose(Frame::Stiffness, q, arm.frames);
        let rotation = pose.fixed_view::<3, 3>(0, 0);
        let (force, torque) = halves(&self.wrench_stiffness);
        self.wrench_base = stack(&(rotation * force), &(rotation * torque));
    }

    /// Compares with the thresholds, forces along `axes`; `accelerating` selects which set. Returns
    /// the errors to stop for.
    ///
    /// A collision is latched only if `moving`: an arm that holds still has nothing to stop.
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
            ForceAxes::Base => self.wrench_base.into(),
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

    /// Clears the collisions.
    pub(crate) fn clear(&mut self) {
        self.joint_collision = [false; 7];
        self.cartesian_collision = [false; 6];
    }
}

/// Which values are at or beyond their thresholds.
fn reached<const N: usize>(values: &[f64; N], thresholds: &[f64; N]) -> [bool; N] {
    core::array::from_fn(|i| values[i].abs() >= thresholds[i])
}

fn latch<const N: usize>(flags: &mut [bool; N], set: &[bool; N]) {
    for (flag, set) in flags.iter_mut().zip(set) {
        *flag |= set;
    }
}

/// The wrench that `torque` means, by least squares: `(J Jᵀ + λ² 1)⁻¹ J τ`.
///
/// Damped, so that it fades instead of growing near a singularity.
fn wrench(jacobian: &Jacobian, torque: &JointVector) -> Wrench {
    let mut gram = jacobian * jacobian.transpose();
    for i in 0..6 {
        gram[(i, i)] += WRENCH_DAMPING * WRENCH_DAMPING;
    }
    match Cholesky::new(gram) {
        Some(factor) => factor.solve(&(jacobian * torque)),
        None => Wrench::zeros(),
    }
}

/// Against the smallest singular value of the Jacobian, 0.14 to 0.23 in ordinary poses.
const WRENCH_DAMPING: f64 = 0.01;

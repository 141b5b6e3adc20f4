//! The frames of the model's poses and Jacobians, and the frames that the user defines.

use nalgebra::Matrix4;

/// A frame that moves with the arm, in the vendor's order (libfranka 0.21, `model.h`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Frame {
    /// Frame of link 1, after the rotation of joint 1; z is the joint's axis. The same rule applies
    /// to the other six joint frames.
    Joint1,
    /// Frame of link 2.
    Joint2,
    /// Frame of link 3.
    Joint3,
    /// Frame of link 4.
    Joint4,
    /// Frame of link 5.
    Joint5,
    /// Frame of link 6.
    Joint6,
    /// Frame of link 7.
    Joint7,
    /// Centre of the flange surface, 0.107 m along the last axis, oriented like link 7.
    Flange,
    /// The end effector, at [`EndEffector::f_t_ee`] from the flange.
    EndEffector,
    /// The stiffness frame, at [`EndEffector::ee_t_k`] from the end effector.
    Stiffness,
}

impl Frame {
    /// All ten frames, from base to tip.
    pub const ALL: [Self; 10] = [
        Self::Joint1,
        Self::Joint2,
        Self::Joint3,
        Self::Joint4,
        Self::Joint5,
        Self::Joint6,
        Self::Joint7,
        Self::Flange,
        Self::EndEffector,
        Self::Stiffness,
    ];

    /// Returns the number of joints that move this frame; the remaining columns of its Jacobians
    /// are zero.
    pub const fn joints(self) -> usize {
        let index = self as usize;
        if index < 7 { index + 1 } else { 7 }
    }
}

/// The frames on the flange that the user defines: end effector and stiffness frame.
///
/// The model uses both poses unchanged, even if the rotation block is not exactly orthonormal (the
/// vendor supplies 0.7071 for sqrt(1/2)). The model assumes that the last row is `0 0 0 1`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndEffector {
    /// Pose of the end effector in the flange frame, `F_T_EE`.
    pub f_t_ee: Matrix4<f64>,
    /// Pose of the stiffness frame in the end-effector frame, `EE_T_K`.
    pub ee_t_k: Matrix4<f64>,
}

impl Default for EndEffector {
    /// Returns both frames at the flange.
    fn default() -> Self {
        Self {
            f_t_ee: Matrix4::identity(),
            ee_t_k: Matrix4::identity(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joint_frames_are_moved_by_the_joints_up_to_theirs() {
        let joints = Frame::ALL.map(Frame::joints);
        assert_eq!(joints, [1, 2, 3, 4, 5, 6, 7, 7, 7, 7]);
    }
}

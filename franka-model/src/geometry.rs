//! Lengths and joint frames.
//!
//! The values are the joint origins of the vendor's URDF (libfranka 0.21, `test/fr3.urdf`;
//! `franka_description` 1.0.1, `kinematics.yaml` of both robots). Two lengths of real arms differ
//! from the URDF; see [`Lengths`].

use core::f64::consts::FRAC_PI_2;

use nalgebra::Vector3;

/// Base to shoulder, where the first three axes meet, along the axis of joint 1, `[m]`.
pub const SHOULDER: f64 = 0.333;
/// Shoulder to elbow, along the axis of joint 3, `[m]`.
pub const UPPER_ARM: f64 = 0.316;
/// Offset of the axis of joint 4 from the axes of joints 3 and 5, `[m]`.
pub const ELBOW: f64 = 0.0825;
/// Elbow to wrist, along the axis of joint 5, `[m]`.
pub const FOREARM: f64 = 0.384;
/// Offset of the last axis from the wrist, where axes 5 and 6 meet, `[m]`.
pub const WRIST: f64 = 0.088;
/// Frame of link 7 to flange, along the axis of joint 7, `[m]`.
pub const FLANGE: f64 = 0.107;

/// The two lengths that differ between robots.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lengths {
    /// Shoulder to elbow, along the axis of joint 3, `[m]`.
    pub upper_arm: f64,
    /// Elbow to wrist, along the axis of joint 5, `[m]`.
    pub forearm: f64,
}

impl Lengths {
    /// Lengths of the vendor's description, for both robots.
    pub const DESCRIBED: Self = Self {
        upper_arm: UPPER_ARM,
        forearm: FOREARM,
    };

    /// Lengths derived from the poses of two recorded Franka Research 3. Each length is 0.2 mm
    /// longer than described.
    ///
    /// Source: states of 2023 (`dlo_parameter_id`) and 2026 (`franka_ros2_teleop_data_collection`,
    /// `O_T_EE` compared with `q` in 949 states, median deviation 0.001 µm).
    pub const RECORDED_FR3: Self = Self {
        upper_arm: 0.3162,
        forearm: 0.3842,
    };

    /// All known sets of lengths.
    pub const KNOWN: [Self; 2] = [Self::DESCRIBED, Self::RECORDED_FR3];

    /// Returns the origins of the joints. The first origin is in the base frame.
    pub const fn joint_origins(&self) -> [JointOrigin; 7] {
        const fn origin(x: f64, y: f64, z: f64, roll: f64) -> JointOrigin {
            JointOrigin {
                translation: Vector3::new(x, y, z),
                roll,
            }
        }
        [
            origin(0.0, 0.0, SHOULDER, 0.0),
            origin(0.0, 0.0, 0.0, -FRAC_PI_2),
            origin(0.0, -self.upper_arm, 0.0, FRAC_PI_2),
            origin(ELBOW, 0.0, 0.0, FRAC_PI_2),
            origin(-ELBOW, self.forearm, 0.0, -FRAC_PI_2),
            origin(0.0, 0.0, 0.0, FRAC_PI_2),
            origin(WRIST, 0.0, 0.0, FRAC_PI_2),
        ]
    }

    /// Returns the angle of joint 4 at which this arm is stretched, `[rad]`. For
    /// [`DESCRIBED`](Self::DESCRIBED) it equals the [vendor's angle](crate::elbow::FLIP_ANGLE),
    /// except for rounding.
    pub fn flip_angle(&self) -> f64 {
        let (upper, fore) = (self.upper_arm, self.forearm);
        crate::scalar::atan2(-ELBOW * (upper + fore), upper * fore - ELBOW * ELBOW)
    }
}

/// Pose of a joint's frame in the frame of the previous link, at joint position zero. The pose is a
/// translation, followed by a roll about x. The joint turns about the z axis of the resulting
/// frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointOrigin {
    /// Translation, `[m]`, in the axes of the previous link.
    pub translation: Vector3<f64>,
    /// Roll about x, `[rad]`: 0 or a quarter turn. Pitch and yaw are zero.
    pub roll: f64,
}

/// The origins of joints 1 to 7 with the lengths [`Lengths::DESCRIBED`].
pub const JOINT_ORIGINS: [JointOrigin; 7] = Lengths::DESCRIBED.joint_origins();

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::{EndEffector, Frame, Model};
    use nalgebra::{Isometry3, UnitQuaternion, Vector3};

    #[test]
    fn the_frames_of_the_model_are_the_origins_one_after_the_other() {
        let mut random = Random::new(71);
        for lengths in Lengths::KNOWN.repeat(50) {
            let model = &Model::fr3().clone().with_lengths(lengths);
            let q = random.posture(model);
            let mut link = Isometry3::identity();
            for (i, origin) in lengths.joint_origins().iter().enumerate() {
                let roll = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), origin.roll);
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), q[i]);
                link *= Isometry3::from_parts(origin.translation.into(), roll * turn);
                let pose = model.pose(Frame::ALL[i], &q, &EndEffector::default());
                assert!((pose - link.to_homogeneous()).amax() < 1e-14);
            }
            link *= Isometry3::translation(0.0, 0.0, FLANGE);
            let pose = model.pose(Frame::Flange, &q, &EndEffector::default());
            assert!((pose - link.to_homogeneous()).amax() < 1e-14);
        }
    }
}

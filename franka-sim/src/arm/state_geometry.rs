//! Geometry that the robot uses to compute its poses.

use franka_model::geometry::Lengths;
use franka_model::{Model, RobotKind};
use nalgebra::{Isometry3, Vector3};

use crate::noise::Random;

/// Kinematics of the robot's controllers. The robot computes `O_T_EE`, all other poses in its
/// states, and its inverse kinematics with this geometry. The served description contains the
/// lengths, but not the deviations. A client's model may differ from this geometry. The real links
/// may also differ, by their [`kinematic_error`](super::Body::kinematic_error).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StateGeometry {
    /// Upper arm and forearm.
    pub lengths: Lengths,
    /// Pose of each joint's frame, relative to the joint's frame on an arm with these lengths and
    /// no deviations.
    pub deviations: [Isometry3<f64>; 7],
}

impl StateGeometry {
    /// Geometry of the vendor's description. Franka Emika Robots and [ideal](super::Arm::ideal)
    /// arms have this geometry.
    pub const DESCRIBED: Self = Self::with(Lengths::DESCRIBED);

    /// Geometry of the Franka Research 3 whose states were recorded, [`Lengths::RECORDED_FR3`]. All
    /// Franka Research 3 arms in the built-in [families](super::Family) have this geometry.
    pub const RECORDED_FR3: Self = Self::with(Lengths::RECORDED_FR3);

    /// Random joint frames, drawn from `seed`. The total deviation from the described frames (root
    /// of the sum of squares) is 1 mm and 3 mrad, with equal shares of all joints. No client knows
    /// these deviations.
    pub fn random(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut along = |size: f64| {
            let direction = Vector3::from_fn(|_, _| random.normal());
            direction.normalize() * (size / 7.0_f64.sqrt())
        };
        Self {
            deviations: std::array::from_fn(|_| Isometry3::new(along(1e-3), along(3e-3))),
            ..Self::DESCRIBED
        }
    }

    const fn with(lengths: Lengths) -> Self {
        const NONE: Isometry3<f64> = Isometry3 {
            rotation: nalgebra::Unit::new_unchecked(nalgebra::Quaternion::new(1.0, 0.0, 0.0, 0.0)),
            translation: nalgebra::Translation {
                vector: Vector3::new(0.0, 0.0, 0.0),
            },
        };
        Self {
            lengths,
            deviations: [NONE; 7],
        }
    }

    /// The controllers' model of a robot with this geometry.
    pub fn model(&self, kind: RobotKind) -> Model {
        Model::physically_consistent(kind)
            .clone()
            .with_lengths(self.lengths)
            .with_deviations(&self.deviations)
    }
}

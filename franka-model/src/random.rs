//! Seeded random numbers for tests, so that a failure can be repeated.

use nalgebra::{Matrix3, Vector3};
use rand::{Rng, SeedableRng, rngs::SmallRng};

use crate::{JointVector, Load, Model};

pub(crate) struct Random(SmallRng);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(SmallRng::seed_from_u64(seed))
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.0.random()
    }

    pub(crate) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    pub(crate) fn vector3(&mut self, bound: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.uniform(-bound, bound))
    }

    pub(crate) fn joints(&mut self, bound: f64) -> JointVector {
        JointVector::from_fn(|_, _| self.uniform(-bound, bound))
    }

    /// Returns positions within the limits.
    pub(crate) fn posture(&mut self, model: &Model) -> JointVector {
        let limits = model.joint_limits();
        JointVector::from_fn(|i, _| self.uniform(limits.lower[i], limits.upper[i]))
    }

    /// Returns a physical load: a box of uniform density away from the flange.
    pub(crate) fn load(&mut self) -> Load {
        let mass = self.uniform(0.1, 3.0);
        let side = self.vector3(0.2);
        let squares = side.component_mul(&side);
        Load {
            mass,
            com: self.vector3(0.1),
            inertia: Matrix3::from_diagonal(
                &(Vector3::new(
                    squares.y + squares.z,
                    squares.x + squares.z,
                    squares.x + squares.y,
                ) * (mass / 12.0)),
            ),
        }
    }
}

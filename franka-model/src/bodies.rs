//! The moving bodies in base axes, and rigid composites of them.

use nalgebra::Vector3;

use crate::chain::Chain;
use crate::inertia::{RigidBody, Symmetric3, cross};

/// Returns bodies 1 to 7 in base axes, with centres of mass relative to the shoulder.
///
/// `links` are in link axes; the last link includes the load.
#[inline(always)]
pub(crate) fn placed(chain: &Chain, links: &[RigidBody; 7]) -> [RigidBody; 7] {
    core::array::from_fn(|i| RigidBody {
        mass: links[i].mass,
        com: com(chain, links, i),
        inertia: links[i].inertia.rotated(&chain.rotation[i]),
    })
}

/// Returns the centre of mass of body `i` in base axes, relative to the shoulder.
#[inline(always)]
pub(crate) fn com(chain: &Chain, links: &[RigidBody; 7], i: usize) -> Vector3<f64> {
    let (r, c) = (&chain.rotation[i], &links[i].com);
    chain.origin[i]
        + Vector3::new(
            r.m11 * c.x + r.m12 * c.y + r.m13 * c.z,
            r.m21 * c.x + r.m22 * c.y + r.m23 * c.z,
            r.m31 * c.x + r.m32 * c.y + r.m33 * c.z,
        )
}

/// Several bodies combined into one rigid body, described about the shoulder.
pub(crate) struct Composite {
    pub(crate) mass: f64,
    pub(crate) first_moment: Vector3<f64>,
    /// Inertia about the shoulder.
    pub(crate) inertia: Symmetric3,
}

impl Composite {
    pub(crate) const EMPTY: Self = Self {
        mass: 0.0,
        first_moment: Vector3::new(0.0, 0.0, 0.0),
        inertia: Symmetric3::ZERO,
    };

    #[inline(always)]
    pub(crate) fn add(&mut self, body: &RigidBody) {
        self.mass += body.mass;
        self.first_moment += body.com * body.mass;
        self.inertia += body.inertia + Symmetric3::of_point(body.mass, &body.com);
    }

    /// Returns the linear momentum of the composite, and its angular momentum about the shoulder,
    /// if it turns about an axis at unit rate.
    #[inline(always)]
    pub(crate) fn momentum(
        &self,
        axis: &Vector3<f64>,
        moment: &Vector3<f64>,
    ) -> (Vector3<f64>, Vector3<f64>) {
        (
            moment * self.mass + cross(axis, &self.first_moment),
            self.inertia.times(axis) + cross(&self.first_moment, moment),
        )
    }
}

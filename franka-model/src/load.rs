//! Payloads on the flange.

use nalgebra::{Matrix3, Vector3};

use crate::geometry::FLANGE;
use crate::inertia::{RigidBody, Symmetric3};

/// A rigid payload on the flange: a tool, a held object, or both combined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Load {
    /// Mass, `[kg]`. The dynamics ignore a load without positive mass.
    pub mass: f64,
    /// Centre of mass in the flange frame, `[m]`.
    pub com: Vector3<f64>,
    /// Inertia about the centre of mass, in flange axes, `[kg·m²]`; the model uses only the
    /// symmetric part.
    pub inertia: Matrix3<f64>,
}

impl Load {
    /// No load.
    pub const NONE: Self = Self {
        mass: 0.0,
        com: Vector3::new(0.0, 0.0, 0.0),
        inertia: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };

    /// Returns both loads as one rigid body. The result is identical to the last bit to the
    /// vendor's totals (`m_total`, `F_x_Ctotal`, `I_total` of libfranka 0.21). The inertia of a
    /// load without mass counts as zero. If the total has no mass, its centre of mass is zero.
    pub fn combine(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        let com = if mass > 0.0 {
            (self.com * self.mass + other.com * other.mass) / mass
        } else {
            Vector3::zeros()
        };
        let inertia = if mass == 0.0 {
            Matrix3::zeros()
        } else {
            self.inertia_about_flange() + other.inertia_about_flange() + skew_squared(mass, &com)
        };
        Self { mass, com, inertia }
    }

    /// Returns the load as a body in the frame of link 7.
    pub(crate) fn on_link_7(&self) -> Option<RigidBody> {
        (self.mass > 0.0).then(|| RigidBody {
            mass: self.mass,
            com: self.com + Vector3::new(0.0, 0.0, FLANGE),
            inertia: Symmetric3::of(&self.inertia),
        })
    }

    fn inertia_about_flange(&self) -> Matrix3<f64> {
        if self.mass == 0.0 {
            Matrix3::zeros()
        } else {
            self.inertia - skew_squared(self.mass, &self.com)
        }
    }
}

impl Default for Load {
    fn default() -> Self {
        Self::NONE
    }
}

/// `mass * S(r)^2` with the skew matrix `S`: minus the inertia of a point mass at `r` about the
/// origin. The first factor is multiplied by the mass, as in the vendor's code, because the order
/// affects the last bit.
fn skew_squared(mass: f64, r: &Vector3<f64>) -> Matrix3<f64> {
    let skew = r.cross_matrix();
    skew * mass * skew
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hand() -> Load {
        Load {
            mass: 0.73,
            com: Vector3::new(-0.01, 0.0, 0.03),
            inertia: Matrix3::from_diagonal(&Vector3::new(0.001, 0.0025, 0.0017)),
        }
    }

    #[test]
    fn combining_follows_the_vendors_totals() {
        let held = Load {
            mass: 0.5,
            com: Vector3::new(0.01, 0.02, 0.03),
            inertia: Matrix3::from_diagonal(&Vector3::new(0.001, 0.002, 0.003)),
        };
        let total = hand().combine(&held);
        // The expected totals come from the vendor's state conversion (libfranka 0.20.4).
        let com = Vector3::new(-0.0018699186991869919, 0.008130081300813009, 0.03);
        let inertia = [
            0.00211869918699187,
            -0.00011869918699186993,
            0.00461869918699187,
            0.00493739837398374,
        ];
        assert_eq!(total.mass, 1.23);
        assert!((total.com - com).amax() < 1e-17);
        let i = &total.inertia;
        for (value, expected) in [i.m11, i.m12, i.m22, i.m33].iter().zip(inertia) {
            assert!((value - expected).abs() < 1e-17);
        }
        assert!(i.m13.abs() < 1e-17 && i.m23.abs() < 1e-17);
    }

    #[test]
    fn a_load_without_mass_adds_nothing() {
        let ghost = Load {
            mass: 0.0,
            ..hand()
        };
        let total = hand().combine(&ghost);
        assert!((total.com - hand().com).amax() < 1e-17);
        assert!((total.inertia - hand().inertia).amax() < 1e-17);
        assert_eq!(ghost.combine(&ghost), Load::NONE);
        assert!(ghost.on_link_7().is_none());
    }
}

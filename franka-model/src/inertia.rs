//! Symmetric 3×3 matrices and rigid bodies.

use core::ops::{Add, AddAssign};

use nalgebra::{Matrix3, Vector3};

/// A symmetric 3×3 matrix, stored as six numbers. Field `xy` is the element in row x and column y.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)] // the fields are the places in the matrix
pub struct Symmetric3 {
    pub xx: f64,
    pub xy: f64,
    pub xz: f64,
    pub yy: f64,
    pub yz: f64,
    pub zz: f64,
}

impl Symmetric3 {
    pub(crate) const ZERO: Self = Self {
        xx: 0.0,
        xy: 0.0,
        xz: 0.0,
        yy: 0.0,
        yz: 0.0,
        zz: 0.0,
    };

    /// Returns the symmetric part of `m`.
    pub(crate) fn of(m: &Matrix3<f64>) -> Self {
        Self {
            xx: m.m11,
            xy: 0.5 * (m.m12 + m.m21),
            xz: 0.5 * (m.m13 + m.m31),
            yy: m.m22,
            yz: 0.5 * (m.m23 + m.m32),
            zz: m.m33,
        }
    }

    /// Returns all nine numbers.
    pub fn matrix(&self) -> Matrix3<f64> {
        Matrix3::new(
            self.xx, self.xy, self.xz, //
            self.xy, self.yy, self.yz, //
            self.xz, self.yz, self.zz,
        )
    }

    /// Returns the inertia of a point mass at `r` about the origin: `mass (|r|² 1 − r rᵀ)`.
    #[inline(always)]
    pub(crate) fn of_point(mass: f64, r: &Vector3<f64>) -> Self {
        let (mx, my, mz) = (mass * r.x, mass * r.y, mass * r.z);
        let (xx, yy, zz) = (mx * r.x, my * r.y, mz * r.z);
        Self {
            xx: yy + zz,
            xy: -mx * r.y,
            xz: -mx * r.z,
            yy: xx + zz,
            yz: -my * r.z,
            zz: xx + yy,
        }
    }

    /// Returns `R self Rᵀ`: the same tensor in the axes that `R` maps to.
    #[inline(always)]
    pub(crate) fn rotated(&self, r: &Matrix3<f64>) -> Self {
        let half = |i: usize| {
            let row = Vector3::new(r[(i, 0)], r[(i, 1)], r[(i, 2)]);
            (self.times(&row), row)
        };
        let ((a, x), (b, y), (c, z)) = (half(0), half(1), half(2));
        Self {
            xx: dot(&a, &x),
            xy: dot(&a, &y),
            xz: dot(&a, &z),
            yy: dot(&b, &y),
            yz: dot(&b, &z),
            zz: dot(&c, &z),
        }
    }

    #[inline(always)]
    pub(crate) fn times(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.xx * v.x + self.xy * v.y + self.xz * v.z,
            self.xy * v.x + self.yy * v.y + self.yz * v.z,
            self.xz * v.x + self.yz * v.y + self.zz * v.z,
        )
    }
}

impl Add for Symmetric3 {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            xx: self.xx + other.xx,
            xy: self.xy + other.xy,
            xz: self.xz + other.xz,
            yy: self.yy + other.yy,
            yz: self.yz + other.yz,
            zz: self.zz + other.zz,
        }
    }
}

impl AddAssign for Symmetric3 {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// A rigid body: mass `[kg]`, centre of mass `[m]` and inertia about the centre of mass `[kg·m²]`,
/// in one set of axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidBody {
    /// Mass, `[kg]`.
    pub mass: f64,
    /// Centre of mass, `[m]`.
    pub com: Vector3<f64>,
    /// Inertia about the centre of mass, `[kg·m²]`.
    pub inertia: Symmetric3,
}

impl RigidBody {
    /// Creates a body from numbers in the order of a URDF. The order of `inertia` is xx, xy, xz,
    /// yy, yz, zz.
    pub(crate) const fn new(mass: f64, com: [f64; 3], inertia: [f64; 6]) -> Self {
        let [x, y, z] = com;
        let [xx, xy, xz, yy, yz, zz] = inertia;
        Self {
            mass,
            com: Vector3::new(x, y, z),
            inertia: Symmetric3 {
                xx,
                xy,
                xz,
                yy,
                yz,
                zz,
            },
        }
    }

    /// Returns a body of the same shape with `factor` times the density.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let Symmetric3 {
            xx,
            xy,
            xz,
            yy,
            yz,
            zz,
        } = self.inertia;
        let inertia = [xx, xy, xz, yy, yz, zz].map(|moment| moment * factor);
        Self::new(self.mass * factor, self.com.into(), inertia)
    }

    /// Returns both bodies as one body, or `self` if the total mass is not positive.
    #[inline]
    pub(crate) fn joined(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        if mass <= 0.0 {
            return *self;
        }
        let com = (self.com * self.mass + other.com * other.mass) / mass;
        Self {
            mass,
            com,
            inertia: self.inertia
                + Symmetric3::of_point(self.mass, &(self.com - com))
                + other.inertia
                + Symmetric3::of_point(other.mass, &(other.com - com)),
        }
    }
}

#[inline(always)]
pub(crate) fn dot(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

#[inline(always)]
pub(crate) fn cross(a: &Vector3<f64>, b: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(
        a.y * b.z - a.z * b.y,
        a.z * b.x - a.x * b.z,
        a.x * b.y - a.y * b.x,
    )
}

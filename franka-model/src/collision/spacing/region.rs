//! A region, prepared for many capsules at many postures.

use nalgebra::{Matrix3, Vector3};

use super::mounted::{Location, Mounted};
use crate::collision::Obstacle;
use crate::collision::obstacle::Axis;
use crate::geometry::SHOULDER;
use crate::inertia::dot;
use crate::scalar::sqrt;

/// A region to avoid, relative to the shoulder and in base axes.
#[derive(Debug, Clone, Copy)]
pub(super) enum Region {
    Plane {
        normal: Vector3<f64>,
        offset: f64,
    },
    Box {
        /// Rotation from base axes to the axes of the box.
        turn: Matrix3<f64>,
        centre: Vector3<f64>,
        half: Vector3<f64>,
    },
}

impl Region {
    /// A region infinitely far from every point.
    pub(super) const NONE: Self = Self::Plane {
        normal: Vector3::new(0.0, 0.0, 0.0),
        offset: f64::NEG_INFINITY,
    };

    pub(super) fn of(obstacle: &Obstacle) -> Self {
        let shoulder = Vector3::new(0.0, 0.0, SHOULDER);
        match obstacle {
            Obstacle::Plane { normal, offset } => Self::Plane {
                normal: normal.into_inner(),
                offset: offset - normal.dot(&shoulder),
            },
            Obstacle::Box { pose, half } => Self::Box {
                turn: pose.rotation.inverse().to_rotation_matrix().into_inner(),
                centre: pose.translation.vector - shoulder,
                half: *half,
            },
        }
    }

    /// Returns the distance of a capsule, `[m]`, or `None` if the distance is certainly not below
    /// `limit`.
    #[inline(always)]
    pub(super) fn distance_below(
        &self,
        location: &Location,
        capsule: &Mounted,
        limit: f64,
    ) -> Option<f64> {
        match self {
            Self::Plane { normal, offset } => Some(from_plane(normal, *offset, location, capsule)),
            Self::Box { turn, centre, half } => {
                let middle = turn * (location.middle - centre);
                let near = limit + capsule.radius;
                let ball = near + capsule.reach;
                if ball > 0.0 && beyond(&(middle.abs() - half)) >= ball * ball {
                    return None;
                }
                let along = turn * location.half;
                if near > 0.0 && beyond(&(middle.abs() - along.abs() - half)) >= near * near {
                    return None;
                }
                let axis = Axis {
                    start: middle - along,
                    along: along * 2.0,
                    half: *half,
                };
                Some(axis.distance() - capsule.radius)
            }
        }
    }

    /// Returns a lower bound on the distance of a capsule, `[m]`. The bound is −∞ if a box around
    /// the capsule's axis meets the region.
    #[inline(always)]
    pub(super) fn distance_at_least(&self, location: &Location, capsule: &Mounted) -> f64 {
        match self {
            Self::Plane { normal, offset } => from_plane(normal, *offset, location, capsule),
            Self::Box { turn, centre, half } => {
                let middle = turn * (location.middle - centre);
                let along = turn * location.half;
                let beyond = beyond(&(middle.abs() - along.abs() - half));
                if beyond > 0.0 {
                    sqrt(beyond) - capsule.radius
                } else {
                    f64::NEG_INFINITY
                }
            }
        }
    }
}

/// Returns the distance of a capsule to a plane, measured at the nearer end.
#[inline(always)]
fn from_plane(normal: &Vector3<f64>, offset: f64, location: &Location, capsule: &Mounted) -> f64 {
    dot(normal, &location.middle) - dot(normal, &location.half).abs() - offset - capsule.radius
}

/// Returns the square of the distance between two boxes with parallel axes. `gaps` are the gaps
/// along the axes, which are negative where the boxes overlap.
#[inline(always)]
fn beyond(gaps: &Vector3<f64>) -> f64 {
    let gaps = gaps.map(|x| if x > 0.0 { x } else { 0.0 });
    dot(&gaps, &gaps)
}

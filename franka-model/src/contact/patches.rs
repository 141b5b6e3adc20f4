//! The surface of a capsule as patches of about the same size.

use core::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Vector3;

use crate::collision::Capsule;
use crate::inertia::{cross, dot};
use crate::scalar::{sin_cos, sqrt};

#[derive(Debug, Clone, Copy)]
pub(super) struct Patch {
    /// Middle of the patch, in the frame in which the capsule's ends are given.
    pub(super) point: Vector3<f64>,
    /// Outward unit normal.
    pub(super) normal: Vector3<f64>,
    /// Area, `[m²]`.
    pub(super) area: f64,
}

/// Calls `each` with patches that cover the capsule, each about `spacing` metres wide: bands around
/// the axis, from pole to pole, cut into equal pieces.
pub(super) fn visit(capsule: &Capsule, spacing: f64, mut each: impl FnMut(Patch)) {
    let along = capsule.end - capsule.start;
    let length = sqrt(dot(&along, &along));
    let axis = if length > SHORT {
        along / length
    } else {
        Vector3::z()
    };
    let (first, second) = across(&axis);
    let radius = capsule.radius;
    let quarter = FRAC_PI_2 * radius;
    let whole = 2.0 * quarter + length;
    let bands = pieces(whole, spacing, BANDS_MAX);
    let width = whole / bands as f64;
    for band in 0..bands {
        // Position of the middle of the band along the capsule's profile.
        let way = (band as f64 + 0.5) * width;
        // Height above the start, radius of the band, and component of the normal along the axis.
        let (height, around, lean) = if way < quarter {
            let (sin, cos) = sin_cos(way / radius);
            (-radius * cos, radius * sin, -cos)
        } else if way <= quarter + length {
            (way - quarter, radius, 0.0)
        } else {
            let (sin, cos) = sin_cos((whole - way) / radius);
            (length + radius * cos, radius * sin, cos)
        };
        let circumference = TAU * around;
        let count = pieces(circumference, spacing, AROUND_MAX);
        let area = width * circumference / count as f64;
        for piece in 0..count {
            // Every second band is turned by half a piece.
            let turn = piece as f64 + 0.5 * (band % 2) as f64;
            let (sin, cos) = sin_cos(TAU * turn / count as f64);
            let outwards = first * cos + second * sin;
            let share = if radius > 0.0 { around / radius } else { 1.0 };
            each(Patch {
                point: capsule.start + axis * height + outwards * around,
                normal: axis * lean + outwards * share,
                area,
            });
        }
    }
}

/// Returns true if a point is inside a capsule whose radius is reduced by `skin`.
pub(super) fn contains(capsule: &Capsule, skin: f64, point: &Vector3<f64>) -> bool {
    let (along, way) = (capsule.end - capsule.start, point - capsule.start);
    let square = dot(&along, &along);
    let share = if square > 0.0 {
        (dot(&way, &along) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let off = way - along * share;
    let reach = (capsule.radius - skin).max(0.0);
    dot(&off, &off) < reach * reach
}

/// Returns the number of pieces of about `spacing` that fit a length.
fn pieces(length: f64, spacing: f64, most: usize) -> usize {
    // The cast saturates, also for NaN.
    ((length / spacing + 0.5) as usize).clamp(1, most)
}

/// Returns two directions perpendicular to an axis and to each other.
fn across(axis: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let mut other = Vector3::zeros();
    other[axis.iamin()] = 1.0;
    let first = cross(axis, &other);
    let first = first / sqrt(dot(&first, &first));
    (first, cross(axis, &first))
}

/// Length, `[m]`, below which a direction is rounding error.
const SHORT: f64 = 1e-9;

/// Largest number of bands of a capsule. Enough for a capsule of 2 m in bands of 2 cm; bounds the
/// work for larger tools.
const BANDS_MAX: usize = 100;

/// Largest number of pieces of a band, enough for a radius of 0.1 m.
const AROUND_MAX: usize = 32;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patches_lie_on_the_surface_and_add_up_to_it() {
        for (end, radius) in [([0.0, 0.0, 0.0], 0.05), ([0.1, -0.05, 0.2], 0.04)] {
            let capsule = Capsule::new([0.0; 3], end, radius);
            let length = capsule.end.norm();
            let (mut area, mut mean) = (0.0, Vector3::zeros());
            visit(&capsule, 0.005, |patch| {
                let below = patch.point - patch.normal * 1e-6;
                let above = patch.point + patch.normal * 1e-6;
                assert!(contains(&capsule, 0.0, &below) && !contains(&capsule, 0.0, &above));
                assert!((patch.normal.norm() - 1.0).abs() < 1e-12);
                area += patch.area;
                mean += patch.point * patch.area;
            });
            let expected = 2.0 * TAU * radius * radius + TAU * radius * length;
            // Approximate: each band counts as flat.
            assert!((area / expected - 1.0).abs() < 2e-3, "{area} {expected}");
            assert!((mean / area - capsule.end / 2.0).norm() < 1e-4);
        }
    }

    #[test]
    fn the_number_of_patches_is_bounded() {
        for radius in [0.0, 1e3, f64::MAX] {
            let mut count = 0;
            let huge = Capsule::new([0.0; 3], [1e6, 0.0, 0.0], radius);
            visit(&huge, 0.02, |_| count += 1);
            assert!(count <= BANDS_MAX * AROUND_MAX);
        }
    }
}

//! Planes and boxes, and their distances from capsules.

use nalgebra::{Isometry3, UnitVector3, Vector3};

use super::segment::{Nearest, Segment};
use crate::geometry::SHOULDER;
use crate::inertia::{cross, dot};
use crate::scalar::sqrt;

/// A region that the arm must avoid, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Obstacle {
    /// All points with `normal · p < offset`.
    Plane {
        /// Unit normal, pointing out of the region.
        normal: UnitVector3<f64>,
        /// Distance of the surface from the origin along the normal, `[m]`.
        offset: f64,
    },
    /// A box, in any orientation.
    Box {
        /// Pose of the centre of the box in the base frame.
        pose: Isometry3<f64>,
        /// Half of the box's side lengths, `[m]`, along the axes of `pose`. They must not be
        /// negative.
        half: Vector3<f64>,
    },
}

impl Obstacle {
    /// Returns the region below the height `z`, `[m]`.
    pub fn floor(z: f64) -> Self {
        Self::Plane {
            normal: Vector3::z_axis(),
            offset: z,
        }
    }

    /// Returns the nearest points of the obstacle and a capsule. The distance is exact. If both are
    /// apart, the distance is the smallest distance between any two points. If they overlap, the
    /// distance is minus the length of the shortest shift that separates them.
    #[inline(always)]
    pub(super) fn nearest(&self, segment: &Segment) -> Nearest {
        match self {
            Self::Plane { normal, offset } => nearest_to_plane(normal, *offset, segment),
            Self::Box { pose, half } => nearest_to_box(pose, half, segment),
        }
    }
}

#[inline(always)]
fn nearest_to_plane(normal: &UnitVector3<f64>, offset: f64, segment: &Segment) -> Nearest {
    // The segment is relative to the shoulder, so the offset must also be relative to the shoulder.
    let offset = offset - normal.z * SHOULDER;
    let rise = normal.dot(&segment.along);
    let t = if rise > 0.0 {
        0.0
    } else if rise < 0.0 {
        1.0
    } else {
        0.5
    };
    let point = segment.at(t);
    let height = normal.dot(&point) - offset;
    Nearest {
        distance: height - segment.radius,
        normal: normal.into_inner(),
        points: [point - normal.into_inner() * height, point],
    }
}

fn nearest_to_box(pose: &Isometry3<f64>, half: &Vector3<f64>, segment: &Segment) -> Nearest {
    let turn = pose.rotation.to_rotation_matrix();
    let turn = turn.matrix();
    let centre = pose.translation.vector - Vector3::new(0.0, 0.0, SHOULDER);
    let axis = Axis {
        start: turn.tr_mul(&(segment.start - centre)),
        along: turn.tr_mul(&segment.along),
        half: *half,
    };
    let t = axis.nearest_outside();
    let gap = axis.at(t) - axis.clamped(t);
    let length = sqrt(gap.norm_squared());
    let (t, normal, distance) = if length > TOUCHING {
        (t, gap / length, length)
    } else {
        axis.shortest_way_out()
    };
    Nearest {
        distance: distance - segment.radius,
        normal: turn * normal,
        points: [
            centre + turn * (axis.at(t) - normal * distance),
            segment.at(t),
        ],
    }
}

/// Gap, `[m]`, below which the axis counts as touching the box, because the direction of a smaller
/// gap is rounding error.
const TOUCHING: f64 = 1e-12;

/// The axis of a capsule in the axes of a box.
pub(super) struct Axis {
    pub(super) start: Vector3<f64>,
    pub(super) along: Vector3<f64>,
    /// Half of the box's side lengths.
    pub(super) half: Vector3<f64>,
}

impl Axis {
    /// Returns the distance to the box. If the axis meets the box, the distance is minus the length
    /// of the shortest shift out of it.
    pub(super) fn distance(&self) -> f64 {
        let t = self.one_nearest_outside();
        let gap = self.at(t) - self.clamped(t);
        let length = sqrt(dot(&gap, &gap));
        if length > TOUCHING {
            length
        } else {
            self.shortest_way_out().2
        }
    }

    /// Returns a parameter with the smallest distance to the box; see
    /// [`nearest_outside`](Self::nearest_outside). The function examines only bends at which the
    /// sign of the slope is not known yet.
    fn one_nearest_outside(&self) -> f64 {
        let mut low = (0.0, self.slope(0.0));
        if low.1 >= 0.0 {
            return 0.0;
        }
        let mut high = (1.0, self.slope(1.0));
        if high.1 <= 0.0 {
            return 1.0;
        }
        for i in 0..3 {
            for face in [self.half[i], -self.half[i]] {
                let t = (face - self.start[i]) / self.along[i];
                if t > low.0 && t < high.0 {
                    let slope = self.slope(t);
                    if slope <= 0.0 {
                        low = (t, slope);
                    } else {
                        high = (t, slope);
                    }
                }
            }
        }
        low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1))
    }

    fn at(&self, t: f64) -> Vector3<f64> {
        self.start + self.along * t
    }

    /// Returns the point of the box nearest to the point at `t`.
    fn clamped(&self, t: f64) -> Vector3<f64> {
        // Unlike `f64::clamp` this does not panic for a NaN side, and a NaN coordinate stays NaN.
        let clamp = |x: f64, half: f64| {
            if x > half || half.is_nan() {
                half
            } else if x < -half {
                -half
            } else {
                x
            }
        };
        self.at(t).zip_map(&self.half, clamp)
    }

    /// Returns half the derivative of the squared distance to the box, which is zero inside. The
    /// slope is piecewise linear and never decreases, because the distance to a convex body is
    /// convex.
    fn slope(&self, t: f64) -> f64 {
        (self.at(t) - self.clamped(t)).dot(&self.along)
    }

    /// Returns the parameter with the smallest distance to the box, or the middle of the interval
    /// if an interval has the smallest distance.
    ///
    /// The slope bends where a coordinate passes a face. Between two bends, the slope is linear.
    fn nearest_outside(&self) -> f64 {
        let bends = self.bends();
        let slopes = bends.map(|t| self.slope(t));
        // All roots are between the last bend with a negative slope and the first bend with a
        // positive slope.
        let below = slopes.iter().rposition(|&slope| slope < 0.0);
        let above = slopes.iter().position(|&slope| slope > 0.0);
        match (below, above) {
            (None, None) => 0.5,
            (None, Some(above)) => 0.5 * bends[above.saturating_sub(1)],
            (Some(below), None) => 0.5 * (bends[(below + 1).min(BENDS - 1)] + 1.0),
            (Some(below), Some(above)) if above == below + 1 => {
                let (low, high) = (slopes[below], slopes[above]);
                bends[below] + (bends[above] - bends[below]) * (low / (low - high))
            }
            (Some(below), Some(above)) => 0.5 * (bends[below + 1] + bends[above - 1]),
        }
    }

    /// Returns the two ends and the parameters at which a coordinate passes a face, in ascending
    /// order.
    fn bends(&self) -> [f64; BENDS] {
        let mut bends = [1.0; BENDS];
        bends[0] = 0.0;
        for i in 0..3 {
            for (k, face) in [self.half[i], -self.half[i]].into_iter().enumerate() {
                let t = (face - self.start[i]) / self.along[i];
                // The value is not finite if the axis is parallel to the face.
                if t > 0.0 && t < 1.0 {
                    bends[1 + 2 * i + k] = t;
                }
            }
        }
        bends.sort_unstable_by(f64::total_cmp);
        bends
    }

    /// Returns the shortest shift out of the box, for an axis that meets the box. The result is the
    /// parameter of the point that leaves the box last, the direction, and the negative length.
    ///
    /// The relative positions at which the segment and the box meet form a polytope: the box swept
    /// along the segment. Its faces are the faces of the box, and the faces that the segment sweeps
    /// from the box's edges. The shortest shift leads to the nearest face (Gottschalk, Lin and
    /// Manocha, OBBTree, 1996).
    fn shortest_way_out(&self) -> (f64, Vector3<f64>, f64) {
        let mut best = (0.0, Vector3::zeros(), f64::NEG_INFINITY);
        for i in 0..3 {
            let face = unit(i);
            for normal in [face, -face] {
                // `t` is the end of the axis that leaves last, or the middle if both ends leave
                // together.
                let t = 0.5 - 0.5 * sign(normal.dot(&self.along));
                self.consider(&mut best, t, normal);
            }
            let swept = cross(&self.along, &face);
            let square = swept.norm_squared();
            if square > PARALLEL * self.along.norm_squared() {
                for normal in [swept / sqrt(square), -swept / sqrt(square)] {
                    self.consider(&mut best, self.beside_edge(i, &normal), normal);
                }
            }
        }
        best
    }

    /// Replaces `best` if the shift along `normal` is shorter. The point at `t` leaves last with
    /// this shift.
    fn consider(&self, best: &mut (f64, Vector3<f64>, f64), t: f64, normal: Vector3<f64>) {
        let reach = normal.abs().dot(&self.half);
        // Uses the lower end, so the result is also correct if rounding turned the direction.
        let height = normal.dot(&self.start) + normal.dot(&self.along).min(0.0) - reach;
        if height > best.2 || height.is_nan() {
            *best = (t, normal, height);
        }
    }

    /// Returns the parameter at which the axis passes an edge of the box along coordinate `i`. This
    /// edge is outermost along `normal`, a direction perpendicular to axis and edge.
    fn beside_edge(&self, i: usize, normal: &Vector3<f64>) -> f64 {
        let edge = normal.zip_map(&self.half, |n, half| sign(n) * half);
        // In the projection along the edge, the edge is a point, and the axis passes it.
        let (mut gap, mut along) = (edge - self.start, self.along);
        (gap[i], along[i]) = (0.0, 0.0);
        // On the way out, the point is between the ends, except for rounding.
        (gap.dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
    }
}

fn unit(i: usize) -> Vector3<f64> {
    Vector3::from_fn(|row, _| if row == i { 1.0 } else { 0.0 })
}

fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// Square of the sine of the angle below which an axis counts as parallel to an edge. A parallel
/// axis sweeps no face from the edge.
const PARALLEL: f64 = 1e-24;

/// Number of bends: two ends, and two faces per coordinate.
const BENDS: usize = 8;

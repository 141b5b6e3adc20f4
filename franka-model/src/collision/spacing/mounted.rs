//! A capsule in the frame of its link, with all data that do not depend on the posture.

use nalgebra::Vector3;

use crate::chain::Chain;
use crate::collision::{Body, Capsule};
use crate::geometry::{ELBOW, FLANGE, Lengths, SHOULDER, WRIST};
use crate::inertia::dot;
use crate::scalar::sqrt;

/// A capsule on a link or on the flange.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mounted {
    /// Number of the link, counted from the base; 8 for a tool.
    pub(super) number: u8,
    /// Middle of the axis, `[m]`, in the frame of the capsule's link, or relative to the shoulder
    /// for the base.
    middle: Vector3<f64>,
    /// Vector from the middle to the end of the axis, `[m]`.
    half: Vector3<f64>,
    /// Length of `half`, `[m]`.
    pub(super) reach: f64,
    /// Radius, `[m]`.
    pub(super) radius: f64,
    /// Group of the capsule's distances to regions.
    pub(super) group: usize,
}

/// The location of a capsule: relative to the shoulder, in base axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Location {
    pub(super) middle: Vector3<f64>,
    pub(super) half: Vector3<f64>,
}

impl Location {
    pub(super) const NONE: Self = Self {
        middle: Vector3::new(0.0, 0.0, 0.0),
        half: Vector3::new(0.0, 0.0, 0.0),
    };
}

impl Mounted {
    pub(super) const NONE: Self = Self {
        number: 0,
        middle: Vector3::new(0.0, 0.0, 0.0),
        half: Vector3::new(0.0, 0.0, 0.0),
        reach: 0.0,
        radius: 0.0,
        group: 0,
    };

    pub(super) fn on_link(link: u8, capsule: &Capsule) -> Self {
        let origin = match link {
            0 => Vector3::new(0.0, 0.0, -SHOULDER),
            _ => Vector3::zeros(),
        };
        Self::on(link, origin, capsule)
    }

    pub(super) fn on_flange(capsule: &Capsule) -> Self {
        Self::on(TOOL, Vector3::new(0.0, 0.0, FLANGE), capsule)
    }

    fn on(number: u8, origin: Vector3<f64>, capsule: &Capsule) -> Self {
        let half = (capsule.end - capsule.start) * 0.5;
        Self {
            number,
            middle: origin + capsule.start + half,
            half,
            reach: sqrt(dot(&half, &half)),
            radius: capsule.radius,
            group: 0,
        }
    }

    pub(super) fn joints(&self) -> usize {
        match self.number {
            TOOL => Body::Tool.joints(),
            link => Body::Link(link).joints(),
        }
    }

    #[inline(always)]
    pub(super) fn at(&self, chain: &Chain) -> Location {
        match self.joints() {
            0 => Location {
                middle: self.middle,
                half: self.half,
            },
            joints => {
                let (turn, origin) = (&chain.rotation[joints - 1], &chain.origin[joints - 1]);
                Location {
                    middle: origin + turn * self.middle,
                    half: turn * self.half,
                }
            }
        }
    }

    /// Returns the largest motion of any point of the axis, `[m/rad]`, when joint number `joint`
    /// turns, over all postures.
    pub(super) fn lever(&self, lengths: &Lengths, joint: usize) -> f64 {
        let ends = [self.middle - self.half, self.middle + self.half];
        let levers = ends.map(|end| lever(lengths, self.joints(), &end, joint));
        levers[0].max(levers[1])
    }
}

/// Returns the greatest distance of `point`, in the frame of a link, from the axis of joint number
/// `joint`. This joint is the link's own joint or an earlier joint.
///
/// Turning a joint preserves the distances of a point from all points of that joint's axis.
/// Therefore the distance to an earlier axis is at most the distance to a later axis, plus the
/// distances between the reference points of the axes between them.
fn lever(lengths: &Lengths, link: usize, point: &Vector3<f64>, joint: usize) -> f64 {
    let (upper_arm, forearm) = (lengths.upper_arm, lengths.forearm);
    let aside = length(point.x, point.y);
    let (away, axis) = match (link, joint) {
        _ if link == joint => return aside,
        (3, _) => (length(aside, point.z + upper_arm), 3),
        // Each of these axes is at right angles to the previous axis, and to the line between the
        // two.
        (4, 3) => return length(ELBOW + aside, point.z),
        (4, _) => (length(length(upper_arm, ELBOW) + aside, point.z), 3),
        (5, _) => (length(ELBOW + aside, forearm + point.z), 4),
        (7, _) => (length(WRIST + aside, point.z), 6),
        _ => (length(aside, point.z), link),
    };
    away + (joint..axis).map(|joint| step(lengths, joint)).sum::<f64>()
}

/// Returns the distance from the reference point of the axis of joint number `joint` to the
/// reference point of the next axis. The reference point is the shoulder for axes 1 to 3, the elbow
/// for axis 4, and the wrist for axes 5 and 6.
fn step(lengths: &Lengths, joint: usize) -> f64 {
    match joint {
        3 => length(lengths.upper_arm, ELBOW),
        4 => length(lengths.forearm, ELBOW),
        _ => 0.0,
    }
}

fn length(a: f64, b: f64) -> f64 {
    sqrt(a * a + b * b)
}

/// The number of a tool on the flange: it comes after the last link.
const TOOL: u8 = 8;

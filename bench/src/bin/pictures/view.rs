//! The view of the arm from the side and slightly from above, without perspective.

use franka_model::JointVector;
use franka_model::RobotKind;
use franka_model::collision::Shape;
use nalgebra::Vector3;

/// Maps a point of the base frame, in metres, to a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    /// Position of the base's origin.
    pub origin: (f64, f64),
    /// Pixels per metre.
    pub scale: f64,
    /// Angle from the x axis of the base to the picture's plane, `[rad]`.
    pub azimuth: f64,
}

impl View {
    pub(crate) fn at(&self, point: &Vector3<f64>) -> (f64, f64) {
        let (sin, cos) = self.azimuth.sin_cos();
        let (up, level) = ELEVATION.sin_cos();
        // The base's x axis points right and towards the viewer, y right and away.
        let right = cos * point.x + sin * point.y;
        let depth = sin * point.x - cos * point.y;
        let height = level * point.z - up * depth;
        (
            self.origin.0 + self.scale * right,
            self.origin.1 - self.scale * height,
        )
    }

    /// Returns the capsules of the arm with its Hand.
    pub(crate) fn capsules(&self, q: &JointVector) -> Vec<Stroke> {
        let shape = Shape::covering(RobotKind::Fr3).with_hand();
        let placed = shape.at(q);
        let strokes = placed.capsules().map(|(_, capsule)| Stroke {
            from: self.at(&capsule.start),
            to: self.at(&capsule.end),
            width: 2.0 * capsule.radius * self.scale,
        });
        strokes.collect()
    }
}

/// A capsule as a line with round ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stroke {
    pub from: (f64, f64),
    pub to: (f64, f64),
    pub width: f64,
}

/// Elevation of the viewer, `[rad]`.
const ELEVATION: f64 = 0.3;

//! The distance between the arm and the straight line of its goal.

use nalgebra::{Isometry3, Vector3};

use super::RunningSession;
use crate::session::Target;
use crate::session::course::Course;
use crate::session::guard::deviation::beside;

/// The straight line of a goal to a pose, and the greatest distance of the arm from it so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    /// Start of the line in base axes, `[m]`.
    from: Vector3<f64>,
    /// Vector from the start to the target, `[m]`.
    way: Vector3<f64>,
    /// Greatest distance of the arm from the line so far, `[m]`.
    off: f64,
}

impl Line {
    fn new(from: &Isometry3<f64>, to: &Isometry3<f64>) -> Self {
        let from = from.translation.vector;
        Self {
            from,
            way: to.translation.vector - from,
            off: 0.0,
        }
    }

    /// Returns the greatest distance of the arm from the line so far, `[m]`.
    pub(super) fn deviation(&self) -> f64 {
        self.off
    }
}

impl RunningSession {
    /// Begins the line of a goal to a pose at the place of the arm. Other goals have no line.
    pub(super) fn begin_line(&mut self) {
        self.line = match self.goal.target {
            Target::Pose(there) if !self.goal.along_path => {
                Some(Line::new(&self.arm.object, &there))
            }
            _ => None,
        };
    }

    /// Updates the greatest distance with the measured position of one cycle. A chunk follows its
    /// own points, so it does not count.
    pub(super) fn watch_line(&mut self) {
        if matches!(self.route.course, Course::Chunk(_)) {
            self.line = None;
        }
        if let Some(line) = &mut self.line {
            let at = self.arm.object.translation.vector - line.from;
            line.off = line.off.max(beside(&at, &line.way));
        }
    }
}

//! Correction of poses to poses as the robot reports them.
//!
//! Goals move the hand to a pose in the robot's own report. The robot computes its poses with its
//! own geometry, so goals move a frame that is the hand moved by a correction. The correction is
//! computed when a goal begins, and once more when the reference has arrived.
//!
//! Under Cartesian setpoints the robot follows the setpoint in its own geometry, so the correction
//! belongs to the setpoint. It is computed when the reference is taken from the robot.

use nalgebra::Isometry3;

use super::{Drive, Measured, RunningSession};
use crate::session::Target;
use crate::session::course::Course;
use crate::session::geometry::{self, RESIDUAL_MAX};

/// Greatest error of the report when the reference has arrived, `[m]`, with rotations at 0.1 m. A
/// greater error is corrected by another move.
const REFINED: f64 = 1e-5;

impl Measured {
    /// Returns the pose of the hand as the robot reports it.
    pub(super) fn as_reported(&self) -> Isometry3<f64> {
        self.modelled * geometry::correction(&self.modelled, &self.reported)
    }
}

impl RunningSession {
    /// Renews the correction if it does not fit the newest state.
    pub(super) fn renew_correction(&mut self) {
        self.renew_correction_beyond(RESIDUAL_MAX);
    }

    /// Renews the correction if its error exceeds `most`, `[m]`. Returns true if so.
    fn renew_correction_beyond(&mut self, most: f64) -> bool {
        let commanded = match &self.drive {
            Drive::Torques(_) => false,
            Drive::Setpoints(stream) => stream.is_cartesian(),
        };
        let reported = self.arm.as_reported();
        if commanded || geometry::distance(&self.arm.pose, &reported) <= most {
            return false;
        }
        self.correct(geometry::correction(&self.arm.modelled, &self.arm.reported));
        self.leave_pose_course();
        true
    }

    /// Makes goals move the hand shifted by `correction`. The joint reference stays as it is, and
    /// the goal must be planned from there.
    pub(super) fn correct(&mut self, correction: Isometry3<f64>) {
        self.correction = (correction != Isometry3::identity()).then_some(correction);
        self.place_object();
    }

    /// Sets the frame that goals move.
    pub(super) fn place_object(&mut self) {
        let [correction, object] = [self.correction, self.grasp].map(Option::unwrap_or_default);
        self.arm.pose = self.arm.modelled * correction;
        self.arm.object = self.arm.pose * object;
        self.ee = geometry::corrected(&self.hand, &(correction * object));
    }

    /// Ends a course whose plan belongs to the previous frame.
    pub(super) fn leave_pose_course(&mut self) {
        if matches!(self.route.course, Course::Pose(..)) {
            self.route.course = Course::Rest;
        }
    }

    /// Moves on to a pose at which the reference has arrived, if the robot's report is wrong there,
    /// once for each target. Returns true if so.
    pub(super) fn refine(&mut self, heading: &Target) -> bool {
        if self.is_refined || !matches!(heading, Target::Pose(_)) || self.is_given_up() {
            return false;
        }
        self.is_refined = true;
        let end = self.route.chunk_end;
        let renewed = self.renew_correction_beyond(REFINED);
        if renewed {
            self.turn_to(*heading);
            self.route.chunk_end = end;
        }
        renewed
    }
}

/// Returns the pose of a frame that is `by` from the frame at `pose`, if the two differ.
#[inline]
pub(super) fn moved(pose: Isometry3<f64>, by: Option<&Isometry3<f64>>) -> Isometry3<f64> {
    by.map_or(pose, |by| pose * by)
}

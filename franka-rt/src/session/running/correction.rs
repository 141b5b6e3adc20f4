//! Correction of goal poses for the difference between the model and the robot's own report.
//!
//! Goals move the hand to a pose as the robot reports it. The robot computes its poses with its own
//! geometry. Therefore goals move a frame that is shifted from the hand by a correction. The
//! correction is computed when a goal begins, and again when the reference has arrived.
//!
//! Under Cartesian setpoints, the robot follows the setpoint in its own geometry, so the correction
//! belongs to the setpoint. It is computed when the reference is taken from the robot.

use nalgebra::Isometry3;

use super::{Drive, Measured, RunningSession};
use crate::session::Target;
use crate::session::course::Course;
use crate::session::geometry::{self, RESIDUAL_MAX};

/// Greatest accepted error of the report when the reference has arrived, `[m]`; rotations count
/// with a lever of 0.1 m. A greater error is corrected by another move.
const REFINED: f64 = 1e-5;

impl Measured {
    /// Returns the pose of the hand as the robot reports it.
    pub(super) fn as_reported(&self) -> Isometry3<f64> {
        self.modelled * geometry::correction(&self.modelled, &self.reported)
    }
}

impl RunningSession {
    /// Renews the correction if it does not match the newest state.
    pub(super) fn renew_correction(&mut self) {
        self.renew_correction_beyond(RESIDUAL_MAX);
    }

    /// Renews the correction if its error exceeds `most`, `[m]`. Returns true if it was renewed.
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

    /// Makes goals move the hand shifted by `correction`. The joint reference does not change, and
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

    /// Ends a course that was planned for the previous frame.
    pub(super) fn leave_pose_course(&mut self) {
        if matches!(self.route.course, Course::Pose(..)) {
            self.route.course = Course::Rest;
        }
    }

    /// If the robot's report is wrong at a pose where the reference has arrived, moves on to
    /// correct it, once for each target. Returns true if so.
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

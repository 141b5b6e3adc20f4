//! The leash: limits how far the reference may be ahead of the measured position. If something
//! holds the arm back, its spring is stretched only by that distance, so the arm does not leap when
//! it is released.

use franka_model::{JointVector, rotation};
use franka_otg::PlanError;
use nalgebra::{Isometry3, Translation3};

use crate::law::fade::{Blend, mix};
use crate::session::course::Course;
use crate::session::pose::PoseGenerator;
use crate::session::reference::Reference;
use crate::session::running::Measured;

/// Greatest distance that the reference may be ahead of the measured position. An obstacle that
/// holds the arm back meets springs that are stretched by this distance at most. If the leash is
/// shorter than the arm's normal lag, it slows the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leash {
    /// Translation of the end effector while the reference follows poses, `[m]`.
    pub translation: f64,
    /// Rotation of the end effector while the reference follows poses, `[rad]`.
    pub rotation: f64,
    /// Distance of each joint, `[rad]`.
    pub joints: f64,
}

impl Default for Leash {
    /// Returns 25 mm, 0.15 rad and 0.1 rad.
    fn default() -> Self {
        Self {
            translation: 0.025,
            rotation: 0.15,
            joints: 0.1,
        }
    }
}

impl Leash {
    /// The shortest accepted leash, with which arms with friction still reach their targets.
    pub const LEAST: Self = Self {
        translation: 5e-3,
        rotation: 0.03,
        joints: 0.03,
    };

    /// The longest accepted leash.
    pub const MOST: Self = Self {
        translation: 0.1,
        rotation: 0.6,
        joints: 0.4,
    };
}

/// A leash fades to its new length. If it became shorter at once, a reference that is far ahead
/// would jerk toward the arm.
impl Blend for Leash {
    fn blend(&self, other: &Self, share: f64) -> Self {
        Self {
            translation: mix(self.translation, other.translation, share),
            rotation: mix(self.rotation, other.rotation, share),
            joints: mix(self.joints, other.joints, share),
        }
    }
}

/// Greatest distance between the end effector of the joint reference and the pose that it follows,
/// `[m]`. It equals the tolerance of a goal. Values between half a millimetre and five make little
/// difference.
const TRANSLATION_TETHER: f64 = 1e-3;

/// Greatest angle between the end effector of the joint reference and the pose that it follows,
/// `[rad]`.
const ROTATION_TETHER: f64 = 5e-3;

/// Parts of the reference that the leash held back in a cycle.
#[derive(Debug)]
pub(crate) struct Held {
    /// Joint positions of the reference, which the leash may have moved.
    q: JointVector,
    /// Pose from which the reference continues, if the pose was too far ahead.
    pose: Option<Isometry3<f64>>,
}

/// Keeps the reference within the leash of the measured position. Returns the parts that were held
/// back, from which the course must continue. Returns `None` if the leash held nothing back.
pub(crate) fn hold(
    leash: &Leash,
    course: &Course,
    reference: &mut Reference,
    arm: &Measured,
) -> Option<Held> {
    let q = reference.q.zip_map(&arm.q, |reference, q| {
        reference.clamp(q - leash.joints, q + leash.joints)
    });
    let moved = q != reference.q;
    reference.q = q;
    let followed = match course {
        Course::Pose(generator, _) => Some(generator.pose()),
        Course::Chunk(chunk) => chunk.pose().map(|(state, _)| state.pose),
        Course::Rest | Course::Joints(_) | Course::Guide(_) => None,
    };
    let pose =
        followed.and_then(|pose| within(&pose, &arm.object, leash.translation, leash.rotation));
    (moved || pose.is_some()).then_some(Held { q, pose })
}

impl Held {
    /// Moves the course to where the leash has held the reference. The course keeps its velocity
    /// and plans from there, so the arm follows smoothly once it is free.
    ///
    /// # Errors
    /// Returns a [`PlanError`] only because of a defect; the course then continues as planned.
    pub(crate) fn move_course(self, course: &mut Course) -> Result<(), PlanError> {
        match (course, self.pose) {
            (Course::Joints(generator), _) => generator.set_positions(self.q.into()),
            (Course::Pose(generator, _), Some(pose)) => generator.reanchor(pose),
            (Course::Chunk(chunk), Some(pose)) => {
                chunk.reanchor(pose);
                Ok(())
            }
            _ => Ok(()),
        }
    }
}

/// Keeps a pose from running ahead of its joints while the joints' bounds slow them. `reached` is
/// the pose of the joint reference. Returns true if the pose was moved.
///
/// Without this, the pose would continue to its target, and the joints would follow it away from
/// the line, all at their bounds.
///
/// # Errors
/// Returns a [`PlanError`] only because of a defect; the pose then continues as planned.
pub(crate) fn tether(
    generator: &mut PoseGenerator,
    reached: &Isometry3<f64>,
) -> Result<bool, PlanError> {
    match tethered(&generator.pose(), reached) {
        Some(pose) => generator.hold_back(pose).map(|()| true),
        None => Ok(false),
    }
}

/// Returns the pose nearest to `pose` that does not run ahead of the joints at `reached`. Returns
/// `None` if `pose` itself does not.
pub(crate) fn tethered(pose: &Isometry3<f64>, reached: &Isometry3<f64>) -> Option<Isometry3<f64>> {
    within(pose, reached, TRANSLATION_TETHER, ROTATION_TETHER)
}

/// Returns the pose nearest to `pose` within a leash around `anchor`, with its length in metres and
/// radians. Returns `None` if `pose` is within the leash.
pub(crate) fn within(
    pose: &Isometry3<f64>,
    anchor: &Isometry3<f64>,
    translation: f64,
    angle: f64,
) -> Option<Isometry3<f64>> {
    let ahead = pose.translation.vector - anchor.translation.vector;
    let turned = rotation::error(&pose.rotation, &anchor.rotation);
    let (distance, turn) = (ahead.norm(), turned.norm());
    if distance <= translation && turn <= angle {
        return None;
    }
    // A leash may have infinite length.
    let share = |length: f64, most: f64| if length > most { most / length } else { 1.0 };
    let ahead = ahead * share(distance, translation);
    let turned = turned * share(turn, angle);
    Some(Isometry3::from_parts(
        Translation3::from(anchor.translation.vector + ahead),
        rotation::exp(&turned) * anchor.rotation,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};

    #[test]
    fn shortens_distance_and_angle_and_keeps_their_directions() {
        let measured = Isometry3::from_parts(
            Translation3::new(0.3, 0.1, 0.5),
            UnitQuaternion::from_euler_angles(3.0, 0.1, 0.2),
        );
        let leash = Leash::default();
        let way = Vector3::new(0.03, -0.04, 0.0);
        let turn = Vector3::new(0.0, 0.3, 0.0);
        let pose = Isometry3::from_parts(
            Translation3::from(measured.translation.vector + way),
            rotation::exp(&turn) * measured.rotation,
        );
        let held = within(&pose, &measured, leash.translation, leash.rotation)
            .expect("50 mm is longer than the leash");
        assert!((held.translation.vector - measured.translation.vector - way / 2.0).norm() < 1e-15);
        let turned = rotation::error(&held.rotation, &measured.rotation);
        assert!((turned - turn / 2.0).norm() < 1e-12);
        assert_eq!(
            within(&measured, &measured, leash.translation, leash.rotation),
            None
        );
    }
}
